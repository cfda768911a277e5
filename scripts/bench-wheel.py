#!/usr/bin/env python3
"""Times the wheel's `extract` beside the same extraction in Rust, in turns, in one run, and prints the ratio of each round.

Usage: scripts/bench-wheel.py PROGRAM [SAMPLES [ROUNDS]]

PROGRAM is the example `volume_times` of isostudy-extract. Run it by a Python that has the wheel, such as that of `make wheel`:

    cargo build --release --locked -p isostudy-extract --example volume_times
    target/wheel/fresh/bin/python scripts/bench-wheel.py target/release/examples/volume_times 256 21
"""

import statistics
import subprocess
import sys
import tempfile
import time

import isostudy
import numpy as np

METHODS = ["mc", "mc33", "nets", "si", "bi"]


def gyroid(n):
    x, y, z = np.meshgrid(*3 * [np.linspace(-np.pi * 2, np.pi * 2, n, dtype=np.float32)], indexing="ij")
    return np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)


def main():
    program, n, rounds = sys.argv[1], int((sys.argv[2:] or [256])[0]), int((sys.argv[3:] or [11])[0])
    samples = gyroid(n)
    with tempfile.NamedTemporaryFile() as file:
        samples.tofile(file.name)
        with subprocess.Popen([program, str(n), file.name], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as rust:
            print(f"{n}^3 samples of a gyroid, one thread, {rounds} rounds: median, and from the second least to the second largest ratio")
            for method in METHODS:
                times, ratios = [[], []], []
                for round_ in range(rounds + 1):
                    rust.stdin.write(f"{method} 1\n")
                    rust.stdin.flush()
                    ms, vertices, triangles = rust.stdout.readline().split()
                    start = time.perf_counter()
                    mesh = isostudy.extract(samples, method=method, threads=1)
                    own = (time.perf_counter() - start) * 1e3
                    counts = (len(mesh.vertices), len(mesh.faces))
                    assert counts == (int(vertices), int(triangles)), (method, counts, vertices, triangles)
                    # The first round warms both up.
                    if round_:
                        times[0].append(float(ms))
                        times[1].append(own)
                        ratios.append(own / float(ms))
                    del mesh
                ratios.sort()
                medians = [statistics.median(of) for of in times]
                low, high = ratios[1], ratios[-2]
                print(
                    f"{method:6} Rust {medians[0]:8.1f} ms, Python {medians[1]:8.1f} ms, "
                    f"ratio {statistics.median(ratios):.3f} ({low:.3f} to {high:.3f})"
                )
            rust.stdin.close()


main()
