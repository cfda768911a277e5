#!/bin/sh
# Times isostudy's extraction of given samples beside VTK's Flying Edges, one thread each, alternating in one run, and prints ratios
# (docs/performance.md). What is fetched stays under cache/.
#
# usage: scripts/flying-edges.sh [SAMPLES ROUNDS [sphere] [asteroid] [gyroid]]
set -eu
cd "$(dirname "$0")/.."

if [ ! -x cache/methods/bin/python ]; then
    python3 -m venv cache/methods
fi
cache/methods/bin/pip install --quiet --requirement scripts/methods/requirements.txt
cargo build --release --locked --quiet --package isostudy-extract --example given_samples
worker=$(cargo metadata --format-version 1 --no-deps | sed 's/.*"target_directory":"\([^"]*\)".*/\1/')/release/examples/given_samples
exec cache/methods/bin/python scripts/methods/beside_flying_edges.py "$worker" "$@"
