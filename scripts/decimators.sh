#!/bin/sh
# Prints our decimation beside meshopt's: time, error and faults at the same number of triangles. The meshes are marching cubes of a ball
# and of the cliffs of configs/terrain.toml. What is fetched stays under target/peers.
#
# usage: scripts/decimators.sh
set -eu
cd "$(dirname "$0")/.."

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
run="${ISOSTUDY:-cargo run --release --locked --quiet --package isostudy --bin isostudy --}"
$run extract --field 'sqrt(x^2 + y^2 + z^2) - 1' --bounds=-1.1,-1.1,-1.1,1.1,1.1,1.1 --spacing 0.04 --method mc -o "$folder/ball.ply"
$run extract configs/terrain.toml --out "$folder/terrain" --only cl_mc --allow-programs
cp "$folder/terrain/meshes/benchmark/cl_mc.ply" "$folder/cliffs.ply"
cargo build --release --quiet --manifest-path scripts/peers/Cargo.toml --target-dir target/peers --bin decimators
target/peers/release/decimators "$folder/ball.ply" "$folder/cliffs.ply"
