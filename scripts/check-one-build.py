#!/usr/bin/env python3
"""Checks that what `make study` builds is built once: `make test` must take each of its libraries as it is.

Usage: scripts/check-one-build.py

Cargo compiles a library again where its features, its profile or one of its dependencies differ. This
compares cargo's own plans for both commands, without building anything. Every library, macro and build
script that `make test` would compile in another way is printed with the reason; exit 1 if there is one.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# As in the Makefile, which must say the same.
STUDY = "run --release --locked --quiet --package isostudy --bin isostudy"
TEST = "test --release --locked --workspace"


def plan(arguments):
    """The units that cargo would compile. The plan has been unstable for years, hence the variable."""
    command = ["cargo", *arguments.replace("run", "build", 1).split(), "--unit-graph", "-Z", "unstable-options"]
    environment = {**os.environ, "RUSTC_BOOTSTRAP": "1"}
    answer = subprocess.run(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, check=True)
    return json.loads(answer.stdout)["units"]


def own(unit):
    """What a unit is compiled from and how, without its dependencies."""
    target = unit["target"]
    return {
        "what": [unit["pkg_id"], target["kind"], target["name"], unit["mode"], unit["platform"]],
        "features": unit["features"],
        "profile": unit["profile"],
    }


def identities(units):
    """Each unit with all below it, as text: cargo shares units for which this is the same."""
    known = {}

    def identity(index):
        if index not in known:
            unit = units[index]
            below = sorted((d["extern_crate_name"], identity(d["index"])) for d in unit["dependencies"])
            # Numbers keep the text short.
            known[index] = numbers.setdefault(json.dumps([own(unit), below], sort_keys=True), len(numbers))
        return known[index]

    return [identity(index) for index in range(len(units))]


numbers = {}


def reason(unit, others):
    """Why a unit is none of those of its name."""
    what = own(unit)
    alike = [other for other in others if own(other)["what"] == what["what"]]
    if not alike:
        return "not built there"
    for key in ("features", "profile"):
        there = [own(other)[key] for other in alike]
        if what[key] not in there:
            return f"{key} {json.dumps(what[key])}, there {json.dumps(there[0])}"
    return "a dependency differs"


def main():
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for arguments in (STUDY, TEST):
        if f"cargo {arguments}" not in makefile:
            print(f"check-one-build: the Makefile has no `cargo {arguments}`", file=sys.stderr)
            return 2
    study, test = plan(STUDY), plan(TEST)
    shared = set(identities(test))
    unshared = [unit for unit, identity in zip(study, identities(study)) if identity not in shared]
    for unit in unshared:
        print(f"{unit['target']['name']} ({unit['pkg_id']}, {unit['mode']}): {reason(unit, test)}")
    print(f"{len(unshared)} of the {len(study)} units of `make study` are built again by `make test`")
    return 1 if unshared else 0


if __name__ == "__main__":
    sys.exit(main())
