#!/bin/sh
# Times isostudy's extraction beside VTK, scikit-image, PyMCubes (Python wheels) and fast-surface-nets, isosurface,
# transvoxel (Rust crates): sets up the programs that configs/peers.toml names, then runs that study's benchmark. What is fetched stays
# under cache/ and target/.
#
# usage: scripts/peers.sh [arguments of `isostudy bench`]
set -eu
cd "$(dirname "$0")/.."

if [ ! -x cache/methods/bin/python ]; then
    python3 -m venv cache/methods
fi
cache/methods/bin/pip install --quiet --requirement scripts/methods/requirements.txt
cargo build --release --quiet --manifest-path scripts/peers/Cargo.toml --target-dir target/peers
exec cargo run --release --locked --quiet --package isostudy --bin isostudy -- bench configs/peers.toml --allow-programs "$@"
