#!/bin/sh
# How often `isostudy bench ab` finds a slowdown that is planted, and how often it finds one where there is none.
#
# usage: scripts/bench-ab-truth.sh [STUDY [RUNS [SECONDS [DIR]]]]
#        configs/paper.toml, 20 runs of 170 s each for no slowdown and for 3, 5, 10 and 20 %, into results/ab-truth
# Leave the machine alone meanwhile. Killed, it goes on where it was. With 20 runs of 170 s it takes 4 h 45 min.
# ISOSTUDY may name the program; ONLY a configuration. Prints a table for docs/benchmark.md.
set -eu
cd "$(dirname "$0")/.."

study=${1:-configs/paper.toml}
runs=${2:-20}
seconds=${3:-170}
dir=${4:-results/ab-truth}
case $study in configs/*) scripts/fetch-bunny.sh >/dev/null ;; esac
if [ -z "${ISOSTUDY:-}" ]; then
    cargo build --release --locked --quiet --package isostudy --bin isostudy
    ISOSTUDY="${CARGO_TARGET_DIR:-target}/release/isostudy"
fi
program=$(realpath "$ISOSTUDY")
mkdir -p "$dir"

echo "| planted | quantity | runs | slower told, all together | slower told, some configuration | faster told | would tell, all together | estimate, all together |"
echo "|---:|---|---:|---:|---:|---:|---:|---:|"
for percent in 0 3 5 10 20; do
    new="$dir/isostudy-$percent"
    # A wrapper: the old program must not see the variable.
    printf '#!/bin/sh\nISOSTUDY_PLANTED_SLOWDOWN=%s exec "%s" "$@"\n' \
        "$(awk "BEGIN { print $percent / 100 }")" "$program" >"$new.partial"
    chmod +x "$new.partial"
    mv "$new.partial" "$new"
    for run in $(seq "$runs"); do
        json="$dir/$percent-$run.json"
        [ -s "$json" ] && continue
        status=0
        "$program" bench ab "$program" "$new" "$study" ${ONLY:+--only "$ONLY"} --out "$dir/out-$percent-$run" \
            --seconds "$seconds" --relative 0 --format json >"$json.partial" 2>"$dir/told" || status=$?
        [ "$status" -le 1 ] || { cat "$dir/told" >&2; exit 2; }
        mv "$json.partial" "$json"
    done
    python3 - "$dir" "$percent" "$runs" <<'PYTHON'
import json, sys

folder, percent, runs = sys.argv[1], sys.argv[2], int(sys.argv[3])
found = [json.load(open(f"{folder}/{percent}-{run}.json")) for run in range(1, runs + 1)]
for quantity in ("time", "cpu-time", "instructions"):
    each = [[row for row in one["rows"] if row["quantity"] == quantity] for one in found]
    if not all(each):
        continue
    together = [rows[0] for rows in each]
    slower = sum(row["verdict"] == "slower" for row in together)
    some = sum(any(row["verdict"] == "slower" for row in rows[1:]) for rows in each)
    faster = sum(any(row["verdict"] == "faster" for row in rows) for rows in each)
    tell = sorted(100 * (row["smallest_detectable"] - 1) for row in together)
    ratio = sorted(100 * (row["ratio"] - 1) for row in together)
    told = f"{tell[0]:.1f} to {tell[-1]:.1f} % | {ratio[0]:+.1f} to {ratio[-1]:+.1f} %"
    print(f"| {percent} % | {quantity} | {runs} | {slower} | {some} | {faster} | {told} |")
PYTHON
done
rm -f "$dir/told"
