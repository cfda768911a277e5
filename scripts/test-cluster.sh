#!/bin/sh
# Runs a study on a one-node Slurm by Snakemake and cancels five of its tasks at random. It kills Snakemake once, stops Slurm's controller,
# and goes on. Then it compares every file with those of one run on this machine. Times are taken over from that run, since no two runs
# take the same.
#
# It takes Debian's packages slurm-wlm and munge, root, and Python with pip; where these cannot be had it says so and ends with 0.
#
# usage: scripts/test-cluster.sh [ISOSTUDY] [SEED]
set -eu
cd "$(dirname "$0")/.."
isostudy=$(realpath "${1:-target/release/isostudy}")
seed=${2:-1}

missing() {
    echo "test-cluster: not run: $1"
    exit 0
}

[ "$(id -u)" = 0 ] || missing "it starts Slurm, which takes root"
if ! command -v slurmctld >/dev/null; then
    { command -v apt-get && DEBIAN_FRONTEND=noninteractive apt-get install -y slurm-wlm munge; } >/dev/null 2>&1 ||
        missing "Debian's slurm-wlm and munge cannot be installed"
fi
programs=$(scripts/workflow/python.sh) || missing "Snakemake cannot be installed by pip"
exec python3 scripts/workflow/test_slurm.py "$isostudy" "$(dirname "$programs")" "$seed"
