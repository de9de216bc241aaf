#!/usr/bin/env bash
# A Slurm of one node on loopback, for tests: munge, slurmctld and slurmd, as root, without
# systemd, cgroups or accounting. Everything lies below SLURM_BASE; down.sh stops just these.
#   SLURM_BASE   folder for all of it      SLURM_CPUS   CPUs to pretend to, 4 by default
set -euo pipefail
base=${SLURM_BASE:-${TMPDIR:-/tmp}/squealpipe-slurm}
host=$(hostname -s)
cpus=${SLURM_CPUS:-4}
memory=$(($(awk '/MemTotal/{print $2}' /proc/meminfo) / 1024 * 8 / 10))
if [ -e /etc/slurm/slurm.conf ] && [ ! -L /etc/slurm/slurm.conf ]; then
  echo "/etc/slurm/slurm.conf belongs to another Slurm; it stays as it is" >&2
  exit 1
fi
mkdir -p "$base"/{etc,munge,log,state,spool,pid}
chmod 755 "$base"

# munge refuses folders that others can write to, and runs as its own user
[ -s "$base/munge/munge.key" ] ||
  dd if=/dev/urandom of="$base/munge/munge.key" bs=1024 count=1 status=none
chmod 400 "$base/munge/munge.key"
chown -R munge:munge "$base/munge"
chmod 755 "$base/munge"
setpriv --reuid=munge --regid=munge --clear-groups /usr/sbin/munged \
  --key-file="$base/munge/munge.key" --socket="$base/munge/munge.sock" \
  --pid-file="$base/munge/munged.pid" --log-file="$base/munge/munged.log" \
  --seed-file="$base/munge/munged.seed" --num-threads=2

cat >"$base/etc/slurm.conf" <<END
ClusterName=local
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=${SLURM_CONTROL_PORT:-16817}
SlurmdPort=${SLURM_NODE_PORT:-16818}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$base/munge/munge.sock
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
StateSaveLocation=$base/state
SlurmdSpoolDir=$base/spool
SlurmctldPidFile=$base/pid/slurmctld.pid
SlurmdPidFile=$base/pid/slurmd.pid
SlurmctldLogFile=$base/log/slurmctld.log
SlurmdLogFile=$base/log/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SlurmdParameters=config_overrides
DefMemPerCPU=500
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=2,bf_interval=2,sched_min_interval=0
MinJobAge=300
InactiveLimit=0
KillWait=5
JobAcctGatherType=jobacct_gather/linux
JobAcctGatherFrequency=1
AccountingStorageType=accounting_storage/none
NodeName=$host NodeAddr=127.0.0.1 CPUs=$cpus RealMemory=$memory State=UNKNOWN
PartitionName=main Nodes=$host Default=YES MaxTime=1-00:00:00 State=UP
END
printf 'CgroupAutomount=no\nConstrainCores=no\nConstrainRAMSpace=no\n' >"$base/etc/cgroup.conf"

# Jobs started by Snakemake lose SLURM_CONF before their nested srun: the default path must work.
mkdir -p /etc/slurm
ln -sfn "$base/etc/slurm.conf" /etc/slurm/slurm.conf
ln -sfn "$base/etc/cgroup.conf" /etc/slurm/cgroup.conf
export SLURM_CONF=$base/etc/slurm.conf
slurmctld
for _ in $(seq 100); do scontrol ping 2>/dev/null | grep -q UP && break; sleep 0.1; done
slurmd -N "$host" 2>/dev/null || slurmd
for _ in $(seq 100); do
  sinfo -h -o %t 2>/dev/null | grep -q idle && { sinfo; exit 0; }
  sleep 0.2
done
tail -n 20 "$base"/log/*.log >&2
exit 1
