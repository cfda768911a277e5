#!/bin/sh
# Times `isostudy analyse` on simulated answers of many respondents to the paper's 27 questions, and tells the most memory it
# held (Linux). Needs the bunny (make bunny).
#   scripts/bench-analyse.sh [RESPONDENTS [THREADS]]
set -eu
cd "$(dirname "$0")/.."
respondents=${1:-100000}
export RAYON_NUM_THREADS="${2:-2}"
cargo build --release --locked --quiet --package isostudy --bin isostudy
cargo build --release --locked --quiet --package isostudy-inference --example simulate
target=$(cargo metadata --format-version 1 --no-deps --locked | sed -E 's/.*"target_directory":"([^"]*)".*/\1/')
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$target/release/examples/simulate" configs/paper.toml "$respondents" "$folder/answers.csv"
begin=$(date +%s%N)
"$target/release/isostudy" analyse configs/paper.toml --responses "$folder/answers.csv" --out "$folder/out" >/dev/null &
process=$!
most=0
while held=$(sed -n 's/^VmHWM:[[:space:]]*\([0-9]*\) kB/\1/p' "/proc/$process/status" 2>/dev/null) && [ -n "$held" ]; do
  most=$held
  sleep 0.05
done
wait "$process"
end=$(date +%s%N)
echo "$respondents respondents x 27 answers, $RAYON_NUM_THREADS threads: $(((end - begin) / 1000000)) ms, $((most / 1024)) MiB"
