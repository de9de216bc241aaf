#!/usr/bin/env bash
# Installs Slurm and munge (Debian, Ubuntu; as root), without starting anything.
set -euo pipefail
export DEBIAN_FRONTEND=noninteractive
apt-get update -q >/dev/null
apt-get install -y -q --no-install-recommends slurm-wlm munge >/dev/null
