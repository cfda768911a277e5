#!/usr/bin/env python3
"""Times `isostudy analyse` on ever more simulated answers, and tells the most memory that it held (Linux).

    scripts/bench-many.py COMMAND [--items N] [--least N] [--most N] [--threads N]

COMMAND is the built command, such as target/release/isostudy. Answers come from
scripts/simulate-long.py: 10 answers of each person about pairs of 1,000 items, unless --items says
otherwise. There are ten times as many answers in each row, from 10^4 to 10^7.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path


def measured(command, threads):
    """Seconds of wall clock and of CPU, and MiB, of a command that must end well."""
    begin = time.monotonic()
    environment = {**os.environ, "RAYON_NUM_THREADS": str(threads)}
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, env=environment)
    _, status, used = os.wait4(process.pid, 0)
    if os.waitstatus_to_exitcode(status) != 0:
        sys.exit(f"{command} failed")
    return time.monotonic() - begin, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("command")
    parser.add_argument("--items", type=int, default=1000)
    parser.add_argument("--least", type=int, default=10_000)
    parser.add_argument("--most", type=int, default=10_000_000)
    parser.add_argument("--threads", type=int, default=2)
    given = parser.parse_args()
    simulate = Path(__file__).with_name("simulate-long.py")
    print("| answers | people | file, MB | time, s | CPU, s | memory, MiB |")
    print("|---:|---:|---:|---:|---:|---:|")
    answers = given.least
    while answers <= given.most:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder, "answers.csv")
            with file.open("w") as out:
                words = [sys.executable, simulate, str(answers), "--items", str(given.items)]
                subprocess.run(words, stdout=out, check=True)
            words = [given.command, "analyse", str(file), "--many", "--out", str(Path(folder, "out"))]
            wall, cpu, memory = measured(words, given.threads)
            size = file.stat().st_size / 1e6
        row = f"| {answers:,} | {answers // 10:,} | {size:.1f} | {wall:.1f} | {cpu:.1f} | {memory:,.0f} |"
        print(row, flush=True)
        answers *= 10


if __name__ == "__main__":
    main()
