#!/usr/bin/env python3
"""How often `isostudy bench ab` finds a planted slowdown between two builds of one source whose code lies in another order.

Usage: scripts/bench-ab-links.py LINKS [SECONDS [RUNS [SAME]]]      a folder of `scripts/links.sh`, of an even number of links

Half of the links are OLD, the others NEW. RUNS comparisons (20) have a slowdown of 1, 3, 5 and 10 % planted, and SAME (60) have none. Each
takes SECONDS (10). All comparisons share the links, so they are not independent draws of the layout of code. Prints a table for docs/benchmark.md, by CPU time and by time.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

STUDY = """methods = ["mc", "nets", "si", "bi"]
cells = 32
rounds = 30

[objects.waves]
field = { kind = "formula", text = "sin(3*x)*sin(3*y) - 2*z" }
min = [-1, -1, -0.5]
max = [1, 1, 0.5]
"""


def main():
    links = sorted(Path(sys.argv[1]).resolve().iterdir())
    seconds = sys.argv[2] if len(sys.argv) > 2 else "10"
    runs, same = (int(sys.argv[i]) if len(sys.argv) > i else default for i, default in ((3, 20), (4, 60)))
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        (folder / "waves.toml").write_text(STUDY)
        builds = {}
        for name, own, percent in [("old", links[0::2], 0)] + [(str(of), links[1::2], of) for of in (0, 1, 3, 5, 10)]:
            builds[name] = folder / name
            builds[name].mkdir()
            for link in own:
                at = builds[name] / link.name
                at.write_text(f"#!/bin/sh\nISOSTUDY_PLANTED_SLOWDOWN={percent / 100} exec '{link}' \"$@\"\n")
                at.chmod(0o755)
        print(f"{len(links) // 2} links of each build, {seconds} s each")
        print("| planted | quantity | comparisons | slower told, all together | any verdict | estimate, all together |")
        print("|---:|---|---:|---:|---:|---:|")
        for percent in (0, 3, 5, 10, 1):
            found = []
            for run in range(same if percent == 0 else runs):
                line = [links[0], "bench", "ab", builds["old"], builds[str(percent)], folder / "waves.toml"]
                line += ["--out", folder / f"{percent}-{run}", "--seconds", seconds, "--processes", str(2 * len(links))]
                done = subprocess.run([*line, "--relative", "0", "--format", "json"], capture_output=True, text=True, cwd=folder)
                if done.returncode > 1:
                    sys.exit(done.stderr)
                found.append(json.loads(done.stdout))
            for quantity in ("cpu-time", "time"):
                rows = [[row for row in one["rows"] if row["quantity"] == quantity] for one in found]
                together = [of[0] for of in rows]
                slower = sum(row["verdict"] == "slower" for row in together)
                some = sum(any(row["verdict"] != "cannot-say" for row in of) for of in rows)
                ratios = sorted(100 * (row["ratio"] - 1) for row in together)
                print(f"| {percent} % | {quantity} | {len(found)} | {slower} | {some} | {ratios[0]:+.1f} to {ratios[-1]:+.1f} % |", flush=True)
    print(f"load average at the end: {os.getloadavg()[1]:.1f}")


main()
