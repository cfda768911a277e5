#!/usr/bin/env python3
"""Writes simulated answers in the long format to standard output, row by row.

    scripts/simulate-long.py ANSWERS [--items N] [--each N] [--seed N] [--side LOG_ODDS] [--spread SD]

Each person answers `each` questions about two different items, drawn at random with their sides. The
log worths of the items go evenly from -1 to 1 (`item0` is the lowest). Choices follow Davidson's
model with ln nu = -0.5. `--side` is a bonus of the left side in log-odds. `--spread` gives each
person own worths, which differ from the items' by a normal deviation of this size for the person's
lean towards items of higher numbers. The same arguments give the same bytes.
"""

import argparse
import math
import random
import sys


def worth(item, items):
    """The log worth that is planted for an item."""
    return -1.0 + 2.0 * item / max(1, items - 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("answers", type=int)
    parser.add_argument("--items", type=int, default=1000)
    parser.add_argument("--each", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--side", type=float, default=0.0)
    parser.add_argument("--spread", type=float, default=0.5)
    given = parser.parse_args()
    draw = random.Random(given.seed)
    uniform, normal = draw.random, draw.gauss
    items, nu, exp = given.items, math.exp(-0.5), math.exp
    worths = [worth(item, items) for item in range(items)]
    names = [f"item{item}" for item in range(items)]
    out = sys.stdout
    out.write("participant,question,left,right,choice\n")
    rows, person, lean, asked = [], 0, 0.0, set()
    for answer in range(given.answers):
        if answer % given.each == 0:
            person += 1
            lean = normal(0.0, given.spread)
            asked.clear()
            if len(rows) > 20_000:
                out.write("".join(rows))
                rows.clear()
        while True:
            left = int(uniform() * items)
            right = int(uniform() * (items - 1))
            right += right >= left
            low, high = (left, right) if left < right else (right, left)
            # Nobody answers a question twice.
            if (low, high) not in asked:
                break
        asked.add((low, high))
        ahead = exp(0.5 * ((worths[left] - worths[right]) * (1.0 + lean) + given.side))
        at = uniform() * (ahead + nu + 1.0 / ahead)
        choice = "left" if at < ahead else "none" if at < ahead + nu else "right"
        rows.append(f"p{person},q{low}-{high},{names[left]},{names[right]},{choice}\n")
    out.write("".join(rows))


if __name__ == "__main__":
    main()
