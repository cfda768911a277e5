#!/usr/bin/env python3
"""Renews results/published/terrain, and the tables of README.md and docs/terrain.md between their marks.

Run `make terrain` and `isostudy bench configs/paper-terrain.toml`, `isostudy study configs/paper-terrain.toml` first, on a machine
that does nothing else.
"""
import datetime
import json
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
TERRAIN, PAPER = ROOT / "results/terrain", ROOT / "results/paper-terrain"
TO = ROOT / "results/published/terrain"
TABLES = ["choices", "decision", "fronts", "chunks", "benchmark", "accuracy", "quality", "topology"]


def rows(path):
    """The lines of the first table of a Markdown file."""
    lines = path.read_text().splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("|"))
    last = next((i for i in range(first, len(lines)) if not lines[i].startswith("|")), len(lines))
    return "\n".join(lines[first:last])


def replace(path, name, text):
    """Puts a text between the marks of a page."""
    page = path.read_text()
    found = re.compile(rf"(<!-- {name} -->\n).*?(<!-- end of {name} -->)", re.S)
    new, times = found.subn(lambda m: f"{m[1]}\n{text}\n\n{m[2]}", page)
    if times != 1:
        sys.exit(f"{path.name}: {times} places for {name}, not 1")
    path.write_text(new)


def main():
    for folder in (TERRAIN, PAPER):
        if not (folder / "manifest.json").exists():
            sys.exit(f"{folder}: has no manifest; see the top of {sys.argv[0]}")
    shutil.rmtree(TO, ignore_errors=True)
    TO.mkdir(parents=True)
    for name in TABLES:
        shutil.copy(TERRAIN / f"tables/{name}.csv", TO)
    shutil.copy(TERRAIN / "tables/choices.md", TO)
    shutil.copy(TERRAIN / "figures/fronts.svg", TO)
    shutil.copy(PAPER / "tables/claims.csv", TO / "claims.csv")
    machine = json.loads((TERRAIN / "manifest.json").read_text())["machine"]
    commit = subprocess.check_output(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], text=True).strip()
    made = f"{datetime.date.today()}, commit {commit}, {machine['cores']} cores of an {machine['model']}, one of them used"
    (TO / "made.txt").write_text(f"study: terrain\n{made}\n")
    choices = rows(TERRAIN / "tables/choices.md")
    conditions = f"Measured {made}."
    replace(ROOT / "README.md", "choices", f"{choices}\n\n{conditions}")
    page = ROOT / "docs/terrain.md"
    replace(page, "choices", f"{choices}\n\n{conditions}")
    replace(page, "decision", rows(TERRAIN / "tables/decision.md"))
    replace(page, "chunks", chunks())
    replace(page, "claims", rows(PAPER / "tables/claims.md"))


def short(milliseconds):
    value = float(milliseconds)
    return f"{value:.0f}" if value >= 10 else f"{value:.1f}"


def chunks():
    """Milliseconds per chunk and per edit, a row a method, a column an object."""
    import csv

    table = list(csv.DictReader((TERRAIN / "tables/chunks.csv").open()))
    objects = list(dict.fromkeys(row["id"].split("_")[0] for row in table))
    names = {row["id"].split("_")[0]: row["object"] for row in csv.DictReader((TERRAIN / "tables/configurations.csv").open())}
    methods = [m for m in dict.fromkeys(row["id"].split("_")[1] for row in table) if not m.endswith("-flat")]
    of = {row["id"]: row for row in table}
    lines = ["| method | " + " | ".join(names[o] for o in objects) + " |", "|---|" + "---:|" * len(objects)]
    for method in methods:
        cells = [of.get(f"{o}_{method}") for o in objects]
        text = [f"{short(c['chunk_ms'])}, {short(c['edit_ms'])}" if c else "" for c in cells]
        lines.append(f"| `{method}` | " + " | ".join(text) + " |")
    return "\n".join(lines)


main()
