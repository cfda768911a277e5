#!/bin/sh
# Runs the paper's benchmark several times with one build and compares every run with every other: how often two runs of one
# build get a verdict that they should not get, and what they could have told. Leave the machine alone meanwhile.
#
# usage: scripts/bench-again.sh [RUNS [DIR]]      7 runs into results/again; each takes as long as `isostudy bench`
set -eu
cd "$(dirname "$0")/.."

runs=${1:-7}
dir=${2:-results/again}
cargo build --release --locked --quiet --package cli --bin isostudy
isostudy="${CARGO_TARGET_DIR:-target}/release/isostudy"

for run in $(seq "$runs"); do
    "$isostudy" bench configs/paper.toml --out "$dir/$run" >/dev/null
done

pairs=0
silent=0
for a in $(seq "$runs"); do
    for b in $(seq $((a + 1)) "$runs"); do
        status=0
        told=$("$isostudy" bench compare "$dir/$a" "$dir/$b" --format csv 2>"$dir/told") || status=$?
        # Runs that cannot be compared are no evidence of anything.
        [ "$status" -le 1 ] || { cat "$dir/told" >&2; exit 2; }
        verdicts=$(printf '%s\n' "$told" | grep -c -E ',(faster|slower),' || true)
        pairs=$((pairs + 1))
        [ "$verdicts" -gt 0 ] || silent=$((silent + 1))
        echo "$a against $b: $verdicts verdicts, exit $status; $(grep '^totals' "$dir/told")"
    done
done
rm -f "$dir/told"
echo "$silent of $pairs pairs without a verdict on any total or stage"
