#!/usr/bin/env bash
# Builds isostudy and links it several times, its code in another order each time, for `isostudy bench ab`.
#
# usage: scripts/links.sh FOLDER [LINKS]       16 links if nothing is said; as many as there are pairs of processes are best
# Needs lld (`--shuffle-sections`), which Rust has of its own on x86-64 Linux. The links of one build differ in nothing but that order.
set -euo pipefail
mkdir -p "$1"
folder=$(realpath "$1")
cd "$(dirname "$0")/.."
LINKS=${2:-16}
export LINKS FOLDER=$folder
rm -f "$folder"/isostudy-*
# Another build id each time: cargo would link nothing that it has linked in the same way before.
cargo rustc --release --locked --quiet --package isostudy --bin isostudy -- \
    -C linker="$PWD/scripts/links/linker.sh" -C link-arg="-Wl,--build-id=0x$(date +%s%N | cut -c1-16)"
found=$(find "$folder" -name 'isostudy-*' | wc -l)
if [ "$found" -ne "$LINKS" ]; then
    echo "$found links were made, not $LINKS: the linker is not lld" >&2
    exit 1
fi
echo "$folder: $LINKS links"
