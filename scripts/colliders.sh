#!/bin/sh
# Prints what a collider costs: how long parry3d takes to build a triangle mesh of each method's terrain, with its smallest edge and worst
# angles. The meshes are those of configs/terrain.toml, at the benchmark's spacing. What is fetched stays under target/peers.
#
# usage: scripts/colliders.sh [ROUNDS]
set -eu
cd "$(dirname "$0")/.."

methods="si bi bw mc mc-clamp snapmc nets-manifold dc-in-cell"
only=""
files=""
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# The study and two methods more: the warp, and crossings that keep a tenth of an edge away from lattice points.
sed -e "s#\"\.\./#\"$PWD/#g" -e "s#\"cpu/#\"$PWD/configs/cpu/#" configs/terrain.toml >"$folder/study.toml"
cat >>"$folder/study.toml" <<'METHODS'

[[methods]]
id = "bw"
label = "body-centred tetrahedra (warped)"
recipe = { kind = "tetrahedra", arrangement = "body-centred", clustering = "warp" }

[[methods]]
id = "mc-clamp"
label = "marching cubes (edge_clamp 0.1)"
recipe = { kind = "cubes", edge_clamp = 0.1 }
METHODS
for object in hi cl ca bu; do
    for method in $methods; do
        only="$only${only:+,}${object}_$method"
        files="$files $folder/out/meshes/benchmark/${object}_$method.ply"
    done
done
cargo run --release --locked --quiet --package isostudy --bin isostudy -- \
    extract "$folder/study.toml" --allow-programs --only "$only" -o "$folder/out" >&2
cargo build --release --quiet --manifest-path scripts/peers/Cargo.toml --target-dir target/peers --bin colliders
# shellcheck disable=SC2086 # names without spaces
exec target/peers/release/colliders "${1:-31}" 0.02 $files
