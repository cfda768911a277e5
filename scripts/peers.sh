#!/bin/sh
# Times isostudy's extraction beside manifold3d, VTK, scikit-image (Python wheels) and fast-surface-nets, isosurface (Rust crates)
# on the same fields and sizes, interleaved, and measures every mesh with isostudy's own `mesh`. What cannot be had or fails is
# skipped and named, on standard error and under the table. What is fetched stays under cache/ and target/.
#
# usage: scripts/peers.sh [--rounds N] [--cells N,N] [--out DIR]
# PEERS_PYTHON: a Python that has the wheels already; otherwise they are installed into cache/peers.
set -eu
cd "$(dirname "$0")/.."

python=${PEERS_PYTHON:-cache/peers/bin/python}
if [ ! -x "$python" ]; then
    if python3 -m venv cache/peers; then
        for wheel in numpy==2.4.6 manifold3d==3.5.4 vtk==9.7.2 scikit-image==0.26.0; do
            cache/peers/bin/pip install --quiet "$wheel" || echo "peers: SKIPPED: no wheel of $wheel" >&2
        done
    else
        echo "peers: SKIPPED: manifold3d, vtk and scikit-image: python3 -m venv does not work here" >&2
    fi
fi
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-target}/peers"
cargo build --release --quiet --manifest-path scripts/peers/Cargo.toml
# One core for all: a peer that would use more could not be told apart from a faster one.
exec "$CARGO_TARGET_DIR/release/peers" --python "$python" --worker scripts/peers/worker.py --date "$(date -u +%F)" "$@"
