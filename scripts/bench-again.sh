#!/bin/sh
# Runs the paper's benchmark several times with one build and compares every run with every other: how often two runs of one
# build get a verdict that they should not get, and what they could have told. Leave the machine alone meanwhile.
#
# usage: scripts/bench-again.sh [RUNS [DIR]]      7 runs into results/again; each takes as long as `isostudy bench`
# Exit 1 if fewer than 19 pairs of 20 are without a verdict on any total.
set -eu
cd "$(dirname "$0")/.."

runs=${1:-7}
dir=${2:-results/again}
[ "$runs" -ge 2 ] || { echo "bench-again: a build is compared with itself: at least 2 runs, not $runs" >&2; exit 2; }
scripts/fetch-bunny.sh >/dev/null
cargo build --release --locked --quiet --package isostudy --bin isostudy
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
        # Totals come first, then stages, under a heading of their own.
        totals=$(printf '%s\n' "$told" | awk '/^stage,/ { exit } /,(faster|slower),/ { n++ } END { print n + 0 }')
        all=$(printf '%s\n' "$told" | awk '/,(faster|slower),/ { n++ } END { print n + 0 }')
        pairs=$((pairs + 1))
        [ "$totals" -gt 0 ] || silent=$((silent + 1))
        echo "$a against $b: verdicts on $totals totals and $((all - totals)) stages; $(grep '^totals' "$dir/told")"
    done
done
rm -f "$dir/told"
echo "$silent of $pairs pairs without a verdict on any total"
[ $((20 * silent)) -ge $((19 * pairs)) ]
