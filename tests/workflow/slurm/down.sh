#!/usr/bin/env bash
# Stops the daemons that up.sh started, by their pid files.
base=${SLURM_BASE:-${TMPDIR:-/tmp}/squealpipe-slurm}
for file in "$base"/pid/slurmd.pid "$base"/pid/slurmctld.pid "$base"/munge/munged.pid; do
  [ -s "$file" ] || continue
  pid=$(cat "$file")
  kill "$pid" 2>/dev/null
  for _ in $(seq 100); do kill -0 "$pid" 2>/dev/null || break; sleep 0.1; done
done
for link in slurm.conf cgroup.conf; do
  [ "$(readlink "/etc/slurm/$link")" = "$base/etc/$link" ] && rm "/etc/slurm/$link"
done
exit 0
