"""Reads data/*.parquet of a results folder with pyarrow or DuckDB and compares it with the tables beside it.

Every file must have the columns and types of docs/data.md; answers must add up to tables/preference_groups.csv and
tables/answer_counts.csv; meshes and times to tables/benchmark.csv; cases of a sweep to its four tables. What has no table is
compared with nothing, and said.

usage: python3 scripts/check_data.py RESULTS [pyarrow|duckdb]
Exit code 0: all agree; 1: something differs; 77: the reader is not installed.
"""

import csv
import fnmatch
import importlib
import math
import pathlib
import statistics
import sys
from collections import Counter

DOCS = pathlib.Path(__file__).resolve().parent.parent / "docs" / "data.md"
TYPES = {
    "int64": "Int64", "double": "Float64", "string": "Utf8", "bool": "Boolean",
    "BIGINT": "Int64", "DOUBLE": "Float64", "VARCHAR": "Utf8", "BOOLEAN": "Boolean",
}


def read_pyarrow(path):
    table = importlib.import_module("pyarrow.parquet").read_table(path)
    return {field.name: str(field.type) for field in table.schema}, table.to_pylist()


def read_duckdb(path):
    relation = importlib.import_module("duckdb").read_parquet(str(path))
    types = dict(zip(relation.columns, map(str, relation.types)))
    return types, [dict(zip(relation.columns, row)) for row in relation.fetchall()]


READERS = {"pyarrow": (read_pyarrow, "pyarrow.parquet"), "duckdb": (read_duckdb, "duckdb")}


def documented(name):
    """Columns and types of one file, in the order of docs/data.md: `| column | type | ...` under its heading."""
    part = DOCS.read_text(encoding="utf-8").split(f"## `data/{name}.parquet`")[1].split("\n## ")[0]
    rows = [line.split("|") for line in part.splitlines() if line.startswith("| `")]
    return [(row[1].strip().strip("`"), row[2].strip()) for row in rows]


def check_columns(name, types, problems):
    known = documented(name)
    for column, found in types.items():
        exact = [kind for pattern, kind in known if pattern == column]
        fitting = exact or [kind for pattern, kind in known if fnmatch.fnmatch(column, pattern)]
        if not fitting:
            problems.append(f"{name}: column {column} is not in docs/data.md")
        elif TYPES.get(found) != fitting[0]:
            problems.append(f"{name}: {column} is {found}, documented as {fitting[0]}")
    for pattern, _ in known:
        # A study may declare no factor, and no region.
        if not pattern.startswith(("factor_", "region")) and not fnmatch.filter(types, pattern):
            problems.append(f"{name}: there is no column {pattern}")


def table(results, name):
    path = results / "tables" / f"{name}.csv"
    if not path.exists():
        return []
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def check_answers(results, rows, problems):
    counted = [row for row in rows if row["counted"]]
    wins = Counter((row["group"], row["chosen"]) for row in counted)
    answers = Counter(row["group"] for row in counted)
    groups = table(results, "preference_groups")
    for line in groups:
        of = (line["group"], line["configuration"])
        found = (wins[of], wins[of[0], None], answers[of[0]])
        wanted = tuple(int(line[column]) for column in ("wins", "ties", "answers"))
        if found != wanted:
            problems.append(f"answers: wins, ties, answers of {of}: {found}, in preference_groups.csv {wanted}")
    by_question = Counter((row["question"], row["chosen"]) for row in counted)
    questions = table(results, "answer_counts")
    for line in questions:
        methods = [line["left"].rsplit("_", 1)[-1], None, line["right"].rsplit("_", 1)[-1]]
        found = [by_question[line["question"], method] for method in methods]
        wanted = [int(line[column]) for column in ("left_answers", "no_preference", "right_answers")]
        if found != wanted:
            problems.append(f"answers: {line['question']}: {found}, in answer_counts.csv {wanted}")
    total = sum(int(line[c]) for line in questions for c in ("left_answers", "no_preference", "right_answers"))
    if questions and total != len(counted):
        problems.append(f"answers: {len(counted)} are counted, in answer_counts.csv {total}")
    for row in rows:
        chosen = {"left": row["left"], "right": row["right"], "none": None}[row["choice"]]
        if chosen != row["chosen"]:
            problems.append(f"answers: choice and chosen differ in {row}")
    print(f"answers: {len(rows)} rows, {len(groups)} rows of preference_groups.csv, {len(questions)} questions")


def check_meshes(results, rows, problems):
    meshes = {row["id"]: row for row in rows if row["purpose"] == "benchmark"}
    lines = table(results, "benchmark")
    if lines and sorted(meshes) != sorted(line["id"] for line in lines):
        problems.append("meshes: benchmark.csv has other configurations")
    same = {
        "vertices": "vertices", "triangles": "triangles", "discarded_triangles": "discarded_triangles",
        "tetrahedra": "tetrahedra", "needed_samples": "samples", "stored_edges": "stored_edges",
        "needed_edges": "needed_edges", "vertex_bytes": "vertex_bytes", "index_bytes": "index_bytes",
        "degenerate_triangles": "degenerate_triangles", "aspect_ratio_mean": "published_aspect_ratio_mean",
    }
    for line in lines:
        mesh = meshes.get(line["id"], {})
        cells = "x".join(str(mesh.get(f"cells_{axis}")) for axis in "xyz")
        if line["resolution"] != cells:
            problems.append(f"meshes: {line['id']}: cells {cells}, in benchmark.csv {line['resolution']}")
        for column, of in same.items():
            found, wanted = mesh.get(of), line[column]
            equal = wanted == "" if found is None else wanted != "" and float(wanted) == found
            if not equal:
                problems.append(f"meshes: {line['id']}: {of} is {found}, in benchmark.csv {wanted}")
    print(f"meshes: {len(rows)} rows, {len(lines)} rows of benchmark.csv")


def check_times(results, rows, problems):
    stages = ["allocation_s", "sampling_s", "vertex_s", "geometry_s", "clustering_s", "normals_s"]
    for row in rows:
        finishing = row.get("finishing_s", 0.0)
        if abs(sum(row[stage] for stage in stages) + finishing - row["total_s"]) > 1e-9:
            problems.append(f"times: stages do not add up in {row}")
    lines = table(results, "benchmark")
    for line in lines:
        own = [row for row in rows if row["id"] == line["id"] and row["block"] == "measured"]
        median = statistics.median(row["total_s"] - row["normals_s"] for row in own)
        mean = statistics.fmean(row["sampling_s"] for row in own)
        for found, column in ((median, "total_without_normals_median_s"), (mean, "sampling_s")):
            if abs(found - float(line[column])) > 1e-9:
                problems.append(f"times: {line['id']}: {column} is {found}, in benchmark.csv {line[column]}")
    print(f"times: {len(rows)} rows, {len(lines)} rows of benchmark.csv")


MEASURES = {
    "sample points": "samples", "triangles": "triangles", "distance to the isosurface": "distance_mean",
    "distance to the mesh": "distance_to_mesh_mean", "radius ratio": "radius_ratio_mean",
}


def mean(values):
    """The geometric mean of those above 0, and how many they are."""
    logs = [math.log(value) for value in values if value is not None and value > 0]
    return (math.exp(math.fsum(logs) / len(logs)) if logs else None), len(logs)


def slope(points):
    """Of least squares on logarithms."""
    logs = [(math.log(x), math.log(y)) for x, y in points]
    x0, y0 = (statistics.fmean(of) for of in zip(*logs))
    return sum((x - x0) * (y - y0) for x, y in logs) / sum((x - x0) ** 2 for x, _ in logs)


def check_sweep(results, read, problems):
    """The rows of sweep/meshes against every mean and exponent of the tables."""
    rows = {}
    own = ["case", "cells_per_axis", "left_out", "object.*", "method.*"]
    known = own + [column for column, _ in documented("meshes")]
    for path in sorted((results / "sweep" / "meshes").glob("object=*/method=*/*.parquet")):
        pair = "_".join(part.split("=", 1)[1] for part in path.parts[-3:-1])
        types, found = read(path)
        rows.setdefault(pair, []).extend(found)
        strange = [name for name in types if not any(fnmatch.fnmatch(name, pattern) for pattern in known)]
        problems.extend(f"sweep: column {name} is not in docs/data.md" for name in strange)
    if not rows:
        return
    for pair, own in rows.items():
        if sorted(row["case"] for row in own) != list(range(len(own))):
            problems.append(f"sweep: the cases of {pair} are not 0 to {len(own) - 1}")
    column = lambda row, quantity: row.get("region_" + MEASURES[quantity], row.get(MEASURES[quantity]))
    compared = 0

    def compare(line, found, name):
        nonlocal compared
        compared += 1
        wanted = float(line[name])
        if found is None or abs(found / wanted - 1) > 1e-9:
            problems.append(f"sweep: {name} of {line} is {found}")

    for line in table(results, "sweep_cases"):
        compare(line, float(len(rows[line["id"]])), "cases")
    at = {}
    for line in table(results, "sweep_resolutions"):
        if line["quantity"] not in MEASURES:
            continue
        own = [row for row in rows[line["id"]] if row["cells_per_axis"] == int(line["cells"])]
        found, cases = mean(column(row, line["quantity"]) for row in own)
        compare(line, found, "mean")
        compare(line, float(cases), "cases")
        at.setdefault((line["id"], line["quantity"]), []).append((int(line["cells"]), found))
    for line in table(results, "sweep_exponents"):
        if line["quantity"] in MEASURES:
            compare(line, slope(at[line["id"], line["quantity"]]), "exponent")
    for line in table(results, "sweep_settings"):
        if line["quantity"] in MEASURES:
            said = lambda value: str(value).lower() if isinstance(value, bool) else str(value)
            value = line["value"].strip('"')
            own = [row for row in rows[line["id"]] if said(row[line["setting"]]) == value]
            compare(line, mean(column(row, line["quantity"]) for row in own)[0], "mean")
    print(f"sweep: {sum(map(len, rows.values()))} rows, {compared} numbers of four tables")


CHECKS = {"answers": check_answers, "meshes": check_meshes, "times": check_times}


def main():
    results, reader = pathlib.Path(sys.argv[1]), (sys.argv[2:] or ["pyarrow"])[0]
    read, module = READERS[reader]
    try:
        importlib.import_module(module)
    except ImportError:
        print(f"{reader} is not installed")
        sys.exit(77)
    problems = []
    files = sorted((results / "data").glob("*.parquet"))
    if not files:
        problems.append(f"{results} has no data/*.parquet")
    for path in files:
        types, rows = read(path)
        check_columns(path.stem, types, problems)
        CHECKS[path.stem](results, rows, problems)
    check_sweep(results, read, problems)
    print("\n".join(problems[:50]))
    sys.exit(1 if problems else 0)


main()
