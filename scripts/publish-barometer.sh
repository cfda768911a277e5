#!/usr/bin/env bash
# Keeps a recording of the barometer in results/published/barometer/DATE, and splices its tables into docs/barometer.md.
#
# usage: scripts/publish-barometer.sh [RECORDING [NAME]]      results/barometer and the day of the recording, if nothing is said
set -euo pipefail
cd "$(dirname "$0")/.."
FROM=${1:-results/barometer}
[ -f "$FROM/about.toml" ] || { echo "$FROM: is no recording; run make barometer" >&2; exit 2; }
NAME=${2:-$(sed -n 's/^date = "\(.*\)"$/\1/p' "$FROM/about.toml")}
[ -n "$NAME" ] || { echo "$FROM: the recording has no date; name it" >&2; exit 2; }
TO=results/published/barometer/$NAME
mkdir -p "$TO"
for file in about.toml measurements.csv engines.csv conformance.csv confirmed.csv speed-and-correctness.svg; do
    [ ! -f "$FROM/$file" ] || cp "$FROM/$file" "$TO/"
done
"${ISOSTUDY:-target/release/isostudy}" barometer report "$FROM" --into docs/barometer.md
echo "$TO, and the tables of docs/barometer.md"
