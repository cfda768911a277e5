"""The loop that every adapter shares: requests in, meshes and answers out. The protocol is in docs/programs.md.

An adapter calls `serve(name, version, extract)`. `extract(samples, request)` is given the samples as a flat array of 32-bit floats, x
fastest, and the request as a dictionary; it returns an `Extraction`.
"""

import json
import os
import sys
import traceback
from typing import NamedTuple

import numpy as np


class Extraction(NamedTuple):
    positions: np.ndarray  # n x 3, in the samples' space
    triangles: np.ndarray  # m x 3, counter-clockwise seen from outside, which is where samples are small
    extraction_s: float  # the library's call alone
    callback_s: float | None = None  # making what the library takes, and positions and triangles of what it gives


def serve(name, version, extract, note=None):
    """Says that it is ready, and answers until the input ends."""
    # A library that prints must not be taken for an answer: what it prints goes to standard error.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)

    def say(line):
        answers.write(json.dumps(line) + "\n")
        answers.flush()

    say({"ready": {"name": name, "version": version, "note": note}})
    for line in sys.stdin:
        request = json.loads(line)
        try:
            say(answer(request, extract))
        except Exception as error:
            traceback.print_exc()
            say({"id": request["id"], "failed": f"{type(error).__name__}: {error}"})


def answer(request, extract):
    samples = np.fromfile(request["samples"], dtype="<f4")
    found = extract(samples, request)
    if request["mesh"]:
        write_ply(request["mesh"], found.positions, found.triangles)
    return {
        "id": request["id"],
        "extraction_s": found.extraction_s,
        "callback_s": found.callback_s,
        "vertices": len(found.positions),
        "triangles": len(found.triangles),
    }


def write_ply(path, positions, triangles):
    faces = np.empty(len(triangles), dtype=[("count", "u1"), ("corners", "<u4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    with open(path, "wb") as file:
        file.write(
            f"ply\nformat binary_little_endian 1.0\nelement vertex {len(positions)}\nproperty float x\nproperty float y\n"
            f"property float z\nelement face {len(triangles)}\nproperty list uchar uint vertex_indices\nend_header\n".encode()
        )
        np.ascontiguousarray(positions, dtype="<f4").tofile(file)
        faces.tofile(file)
