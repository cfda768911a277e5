"""CGAL's Surface_mesher: Delaunay refinement (Boissonnat & Oudot 2005). Needs Python alone, and the program that `make cgal` builds.

usage: cgal_surface_mesher.py PROGRAM [--angle DEGREES] [--radius LENGTH] [--distance LENGTH]

PROGRAM is cache/methods/cgal-surface-mesher, which runs once for each request. No triangle has an angle below --angle, which is 30 where
it is left out and the most that is proved to end. --radius bounds the ball round a triangle, and --distance how far the surface is from
its middle; both are the smallest spacing where they are left out. Between samples is their trilinear interpolant. A solid that ends at
the box gets walls there.
"""

import argparse
import json
import os
import subprocess
import sys

ANSWERED = ("extraction_s", "vertices", "triangles")


def main():
    bounds = arguments()
    try:
        version = subprocess.run([bounds.program, "version"], capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError) as error:
        return say({"failed": f"{error}; `make cgal` builds it"})
    say({"ready": {"name": "CGAL Surface_mesher", "version": version, "note": "it calls the samples' trilinear interpolant, in its time"}})
    for line in sys.stdin:
        request = json.loads(line)
        say({"id": request["id"], **answer(request, bounds)})


def arguments():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--angle", type=float, default=30.0)
    parser.add_argument("--radius", type=float)
    parser.add_argument("--distance", type=float)
    bounds = parser.parse_args()
    if not 0.0 <= bounds.angle <= 30.0:
        parser.error("--angle must be from 0 to 30 degrees: beyond, refinement may not end")
    for name in ("radius", "distance"):
        length = getattr(bounds, name)
        if length is not None and not 0.0 < length < float("inf"):
            parser.error(f"--{name} must be a length above 0")
    return bounds


def answer(request, bounds):
    """What CGAL did, in the protocol's fields; what else the program says goes to standard error."""
    spacing = min(request["spacing"])
    words = ["samples", request["samples"], *request["size"], *request["origin"], *request["spacing"], request["isovalue"]]
    words += [bounds.angle, bounds.radius or spacing, bounds.distance or spacing, request["mesh"] or "-"]
    run = subprocess.run([bounds.program, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if run.returncode != 0:
        return {"failed": run.stderr.strip() or f"{os.path.basename(bounds.program)} ended with {run.returncode}"}
    sys.stderr.write(run.stdout)
    found = json.loads(run.stdout)
    return {field: found[field] for field in ANSWERED}


def say(line):
    print(json.dumps(line), flush=True)


main()
