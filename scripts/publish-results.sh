#!/usr/bin/env bash
# Renews results/published from results/paper: tables, the first part of the report, six figures and those that it links, one turntable.
# Run `isostudy study configs/paper.toml` first. Needs Python with Pillow. An argument names another folder of results.
set -euo pipefail
cd "$(dirname "$0")/.."
FROM=${1:-results/paper}
TO=results/published
TABLES="contrasts fronts preference_groups preference_overall preference_margins tests claims comparison_summary benchmark quality topology accuracy prediction"
FIGURES="contrasts preference_overall prediction radius_ratio triangles pass_times"
TURNTABLE=as_si

[ -f "$FROM/manifest.json" ] || { echo "$FROM: has no manifest; run isostudy study configs/paper.toml" >&2; exit 2; }
python3 -c 'import PIL' || { echo "install Pillow first: pip install pillow" >&2; exit 2; }
find "$TO" -mindepth 1 -maxdepth 1 ! -name terrain ! -name barometer -exec rm -r {} +
mkdir -p "$TO/tables" "$TO/figures"
for name in $TABLES; do cp "$FROM/tables/$name.csv" "$TO/tables/"; done
for name in $FIGURES; do cp "$FROM/figures/$name.svg" "$TO/figures/"; done
# Up to the results one by one.
awk '/^## How much each is liked/ { exit } { print }' "$FROM/report.md" >"$TO/report.md"
# What that part links is published with it.
python3 scripts/published_links.py "$TO" | while read -r link; do
    mkdir -p "$(dirname "$TO/$link")"
    cp "$FROM/$link" "$TO/$link"
done
dead=$(python3 scripts/published_links.py "$TO")
[ -z "$dead" ] || { echo "$TO/report.md: links what is not there: $dead" >&2; exit 1; }
gif=$(awk -F, -v id="$TURNTABLE" '$3 == id && $2 == "" { print $1 }' "$FROM/key/stimuli.csv")
# At half its size and every other frame: the whole would be larger than all the rest.
python3 - "$FROM/$gif" "$TO/turntable_$TURNTABLE.gif" <<'PY'
import sys
from PIL import Image, ImageSequence
with Image.open(sys.argv[1]) as gif:
    delay = gif.info["duration"]
    frames = [frame.convert("RGB").reduce(2) for frame in list(ImageSequence.Iterator(gif))[::2]]
frames = [frame.quantize(128, dither=Image.Dither.NONE) for frame in frames]
frames[0].save(sys.argv[2], save_all=True, append_images=frames[1:], duration=2 * delay, loop=0, optimize=True)
PY
python3 - "$FROM/manifest.json" "$(git rev-parse HEAD)" "$(git show -s --format=%cs HEAD)" >"$TO/made.txt" <<'PY'
import json, sys
manifest, commit, date = json.load(open(sys.argv[1])), sys.argv[2], sys.argv[3]
machine = manifest["machine"]
print(f"study: {manifest['study']}, seed {manifest['seed']}, isostudy {manifest['version']}")
print(f"commit: {commit}")
print(f"date: {date}")
print(f"machine: {machine['model']}, {machine['cores']} cores, {machine['threads']} threads, {machine['os']}")
PY
size=$(du -sb "$TO" | cut -f1)
[ "$size" -lt 3000000 ] || { echo "$TO: $size bytes; at most 3,000,000" >&2; exit 1; }
echo "$TO: $size bytes"
