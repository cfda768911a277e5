"""isostudy's extraction of given samples beside VTK's Flying Edges, in one run: ratios of times. scripts/flying-edges.sh starts it.

usage: beside_flying_edges.py WORKER [CELLS] [ROUNDS] [FIELD ...]

WORKER is the example `given_samples` of isostudy-extract. In each round every extractor has its turn, in an order by chance, and
each ratio is of two times of one round. The table has medians over rounds, of wall-clock time and of CPU time. Neither has normals in
it, and both have the memory of the mesh. Of two threads there is no CPU time. `isostudy` on the same samples: the body-centred
lattice has twice as many on the same box. `sum` adds the samples up: nothing that reads each of them once is faster.
"""

import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median, quantiles

import numpy as np
from vtk_image import as_image, single_threaded
from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D

VTK = "Flying Edges 1"
SUM = "sum 1"
METHODS = [SUM, "mc 1", "mc 2", "mc-edge-groups 1", "mc33 1", "snapmc 1", "bi 1", "bi 2"]
# Over what, and what is wanted: at most this.
GOALS = [
    ("mc 1", VTK, 1.0),
    ("mc 1", SUM, 2.0),
    ("mc 2", "mc 1", 1 / 1.8),
    ("mc-edge-groups 1", "mc 1", None),
    ("mc33 1", "mc 1", 1.3),
    ("snapmc 1", "mc 1", 2.0),
    ("bi 1", VTK, 1.0),
    ("bi 2", "bi 1", None),
]


def flying_edges(image):
    """Milliseconds by the wall clock and of CPU time, and triangles."""
    edges = vtkFlyingEdges3D()
    edges.SetInputData(image)
    edges.SetValue(0, 0.0)
    edges.ComputeNormalsOff()
    edges.ComputeGradientsOff()
    edges.ComputeScalarsOff()
    wall, cpu = time.perf_counter(), time.thread_time()
    edges.Update()
    wall, cpu = time.perf_counter() - wall, time.thread_time() - cpu
    return wall * 1e3, cpu * 1e3, edges.GetOutput().GetNumberOfPolys()


def ours(worker, method):
    worker.stdin.write(method + "\n")
    worker.stdin.flush()
    wall, cpu, _, triangles = worker.stdout.readline().split()
    return float(wall), float(cpu), int(triangles)


def measure(program, field, n, rounds):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "samples.f32"
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        with subprocess.Popen([program, field, str(n), str(path)], **pipes) as worker:
            ours(worker, "mc 1")
            samples = np.fromfile(path, dtype="<f4")
            spacing = 2.0 / (n - 1)
            image = as_image(samples, {"size": [n] * 3, "origin": [-1.0] * 3, "spacing": [spacing] * 3})
            turns = {VTK: lambda: flying_edges(image)} | {m: lambda m=m: ours(worker, m) for m in METHODS}
            times = {name: [] for name in turns}
            for name in turns:  # Once to warm up.
                turns[name]()
            shuffler = random.Random(n)
            for _ in range(rounds):
                # By chance, since the first of a process after another's turn is slower.
                for name in shuffler.sample(list(turns), len(turns)):
                    times[name].append(turns[name]())
            worker.stdin.close()
    return times


def cell(values):
    low, _, high = quantiles(values, n=4)
    return f"{median(values):.2f} ({low:.2f} to {high:.2f})"


def main():
    program = sys.argv[1]
    n, rounds = [int(text) for text in (sys.argv[2:4] + ["256", "15"])[:2]] if len(sys.argv) > 3 else (256, 15)
    fields = sys.argv[4:] or ["sphere", "asteroid", "gyroid"]
    single_threaded()
    print(f"VTK {vtkVersion.GetVTKVersion()}, {n}^3 samples, {rounds} rounds, {time.strftime('%Y-%m-%d')}")
    for field in fields:
        times = measure(program, field, n, rounds)
        print(f"\n| {field} | triangles | ms, wall | ms, CPU | over | wall ratio (quartiles) | CPU ratio | wanted |")
        print("|---|---:|---:|---:|---|---:|---:|---:|")
        for name, found in times.items():
            wall, cpu = (median(t[i] for t in found) for i in (0, 1))
            begin = f"| {name} | {found[0][2]:,} | {wall:.1f} | {cpu:.1f} |"
            goals = [(base, wanted) for of, base, wanted in GOALS if of == name]
            if not goals:
                print(begin + " | | | |")
            for base, wanted in goals:
                ratios = [[t[i] / b[i] for t, b in zip(found, times[base])] for i in (0, 1)]
                by_cpu = cell(ratios[1]) if name.endswith(" 1") else ""
                print(f"{begin} {base} | {cell(ratios[0])} | {by_cpu} | {'' if wanted is None else f'{wanted:.2f}'} |")


main()
