#!/bin/sh
# Delaunay refinement by CGAL's surface mesher, which `make cgal` builds, beside isostudy's methods: a sphere of radius 0.8, angle bound 30
# degrees, radius bound and distance bound 0.05. CGAL draws its first points, so that it has a row for each of six seeds. isostudy's
# methods have the cells that give about as many vertices.
#
# usage: scripts/cgal.sh [ISOSTUDY]
set -eu
cd "$(dirname "$0")/.."

make --quiet cgal
isostudy=${1:-target/release/isostudy}
if [ ! -x "$isostudy" ]; then
    cargo build --release --locked --quiet --package isostudy --bin isostudy
fi
meshes=$(mktemp -d)
trap 'rm -r "$meshes"' EXIT
python3 - "$isostudy" "$meshes" <<'PYTHON'
import json, math, struct, subprocess, sys

isostudy, meshes = sys.argv[1:]
print("| method | vertices | smallest angle | largest angle | evaluations a vertex |")
print("|---|---:|---:|---:|---:|")


def row(name, vertices, least, largest, evaluations):
    print(f"| {name} | {vertices:,} | {least:.1f} | {largest:.1f} | {evaluations} |")


def angles(path):
    """Of a PLY of `isostudy extract`: the number of vertices, the least and the largest angle in degrees."""
    head, _, body = open(path, "rb").read().partition(b"end_header\n")
    counts = {line.split()[1]: int(line.split()[2]) for line in head.decode().splitlines() if line.startswith("element")}
    stride = 4 * sum(line.startswith("property float") for line in head.decode().splitlines())
    at = [struct.unpack_from("<3f", body, n * stride) for n in range(counts["vertex"])]
    least, largest = 180.0, 0.0
    for n in range(counts["face"]):
        corners = struct.unpack_from("<3I", body, counts["vertex"] * stride + 13 * n + 1)
        for i in range(3):
            p, q, r = (at[corners[(i + k) % 3]] for k in range(3))
            u, v = [a - b for a, b in zip(q, p)], [a - b for a, b in zip(r, p)]
            cosine = sum(a * b for a, b in zip(u, v)) / (math.hypot(*u) * math.hypot(*v))
            angle = math.degrees(math.acos(max(-1.0, min(1.0, cosine))))
            least, largest = min(least, angle), max(largest, angle)
    return counts["vertex"], least, largest


for seed in range(6):
    command = ["cache/methods/cgal-surface-mesher", "sphere", "0.8", str(seed), "30", "0.05", "0.05"]
    found = json.loads(subprocess.run(command, capture_output=True, check=True).stdout)
    each = round(found["evaluations"] / found["vertices"])
    row(f"CGAL, seed {seed}", found["vertices"], found["smallest_angle"], found["largest_angle"], each)
# There are samples at all corners of the cubes, and at their middles too where the lattice is body-centred; a relaxed vertex asks for more.
points = {"mc": 1, "snapmc": 1, "nets": 1, "bi": 2, "bw": 2}
for method, cells in (("mc", 30), ("snapmc", 38), ("nets", 30), ("bi", 28), ("bi-relaxed", 28), ("bw", 26)):
    command = [isostudy, "extract", "--field", "sqrt(x^2 + y^2 + z^2) - 0.8", "--bounds=-1.1,-1.1,-1.1,1.1,1.1,1.1"]
    subprocess.run([*command, "--cells", str(cells), "--method", method, "-o", f"{meshes}/{method}.ply"], check=True, capture_output=True)
    found = angles(f"{meshes}/{method}.ply")
    evaluations = f"about {round(points[method] * (cells + 1) ** 3 / found[0])}" if method in points else ""
    row(f"`{method}`, {cells} cells", *found, evaluations)
PYTHON
