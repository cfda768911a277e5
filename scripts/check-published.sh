#!/usr/bin/env bash
# Holds the tables of results/published against a run of `isostudy study configs/paper.toml` in results/paper (or the folder that
# is named), times aside: columns of seconds, their shares, and claims about time. Ends with 1 if one differs, or if the published report
# links a file that is not there.
set -euo pipefail
cd "$(dirname "$0")/.."
FROM=${1:-results/paper}
dead=$(python3 scripts/published_links.py results/published)
[ -z "$dead" ] || { echo "results/published/report.md: links what is not there: $dead" >&2; exit 1; }
python3 - results/published/tables "$FROM/tables" <<'PY'
import csv, pathlib, sys
published, fresh = map(pathlib.Path, sys.argv[1:])
SHARES = {"sampling_fraction", "vertex_fraction", "geometry_fraction"}
# What the published text says about time, or counts of verdicts that include it.
ROWS = ("vertex_", "geometry_", "sampling_", "arrangement_vertex", "arrangement_geometry")

def rows(path):
    with open(path, newline="") as file:
        header, *rows = list(csv.reader(file))
    kept = [i for i, name in enumerate(header) if not (path.stem == "benchmark" and (name.endswith("_s") or name in SHARES))]
    if path.stem == "claims":
        rows = [row for row in rows if not row[0].startswith(ROWS)]
    return [header[i] for i in kept], [[row[i] for i in kept] for row in rows]

differs = []
names = sorted(path.name for path in published.glob("*.csv"))
for name in names:
    if name == "comparison_summary.csv":
        continue  # It counts verdicts, those about time among them.
    (old_header, old), (header, new) = rows(published / name), rows(fresh / name)
    if old_header != header or len(old) != len(new):
        differs.append(f"{name}: columns or number of rows")
    differs += [f"{name}: {a} is now {b}" for a, b in zip(old, new) if a != b]
for line in differs:
    print(line)
print(f"{len(names)} tables, {len(differs)} differences")
sys.exit(1 if differs or not names else 0)
PY
