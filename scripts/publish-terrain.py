#!/usr/bin/env python3
"""Renews results/published/terrain, and the tables of README.md and docs/terrain.md between their marks.

Run `make terrain` first, on a machine that does nothing else. To renew what the paper's conclusions are on terrain, run
`isostudy bench configs/paper-terrain.toml` and `isostudy study configs/paper-terrain.toml` too; else they stay as published.

--power only writes how many people find a preference, by the built command's `design power`.

--recommended only writes what to take, from what was published, into README.md and the pages that recommend.
"""
import csv
import datetime
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
TERRAIN, PAPER = ROOT / "results/terrain", ROOT / "results/paper-terrain"
TO = ROOT / "results/published/terrain"
TABLES = ["choices", "decision", "fronts", "chunks", "stored", "benchmark", "accuracy", "quality", "topology"]


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
    if not (TERRAIN / "manifest.json").exists():
        sys.exit(f"{TERRAIN}: has no manifest; see the top of {sys.argv[0]}")
    renewed = PAPER / "tables/claims.csv"
    claims = (renewed if renewed.exists() else TO / "claims.csv").read_text()
    shutil.rmtree(TO, ignore_errors=True)
    TO.mkdir(parents=True)
    for name in TABLES:
        shutil.copy(TERRAIN / f"tables/{name}.csv", TO)
    shutil.copy(TERRAIN / "tables/choices.md", TO)
    shutil.copy(TERRAIN / "figures/fronts.svg", TO)
    (TO / "claims.csv").write_text(claims)
    machine = json.loads((TERRAIN / "manifest.json").read_text())["machine"]
    # That of the program that measured, which may not be the one that is here now.
    build = json.loads((TERRAIN / "bench/short/run.json").read_text())["machine"]["build"]
    if build["dirty"]:
        sys.exit("the program that measured was built from changes that no commit has")
    commit = build["commit"][:8]
    made = f"{datetime.date.today()}, commit {commit}, {machine['cores']} cores of an {machine['model']}, one of them used"
    (TO / "made.txt").write_text(f"study: terrain\n{made}\n")
    choices = rows(TERRAIN / "tables/choices.md")
    conditions = f"Measured {made}."
    page = ROOT / "docs/terrain.md"
    replace(page, "choices", f"{choices}\n\n{conditions}")
    replace(page, "decision", rows(TERRAIN / "tables/decision.md"))
    replace(page, "chunks", chunks())
    replace(page, "fronts", unbeaten())
    replace(page, "work", work())
    replace(page, "conclusions", conclusions())
    power()
    recommend()


# Every page that recommends has the same table.
RECOMMEND = ["README.md", "docs/methods.md", "docs/terrain.md", "docs/engine.md"]


def recommend():
    for name in RECOMMEND:
        replace(ROOT / name, "take", take("docs/" if "/" not in name else ""))


def table(name, folder=TERRAIN / "tables"):
    """A table of the study, by id; of the quality tables what is said of the benchmark's meshes, and of their ground, which is last."""
    lines = csv.DictReader((folder / f"{name}.csv").open())
    return {row["id"]: row for row in lines if row.get("purpose", "benchmark") == "benchmark"}


def range_of(values, digits):
    low, high = f"{min(values):.{digits}f}", f"{max(values):.{digits}f}"
    return low if low == high else f"{low} to {high}"


OBJECTS = ["hi", "cl", "ca", "bu"]


def ratios(name, column, method, beside="mc"):
    """Of a method to another, object by object."""
    of = table(name, TO)
    return [float(of[f"{o}_{method}"][column]) / float(of[f"{o}_{beside}"][column]) for o in OBJECTS]


def errors(method):
    """Mean distance, the larger of both ways, object by object."""
    of = table("accuracy", TO)
    rows = [of[f"{o}_{method}"] for o in OBJECTS]
    return [max(float(row["distance_mean"]), float(row["distance_to_mesh_mean"])) for row in rows]


def tied(want, place):
    """The methods that are not distinguished from the best for a want on an object."""
    row = next(row for row in csv.DictReader((TO / "choices.csv").open()) if row["want"] == want)
    names = row[OBJECTS[place]].rsplit(", ", 1)[0].split(" = ")
    if not names[-1].endswith(" others"):
        return names
    # Too many for a cell: the next table names them, for several objects at once.
    name = {id.split("_")[0]: row["object"] for id, row in table("configurations").items()}[OBJECTS[place]]
    for row in csv.DictReader((TO / "decision.csv").open()):
        on = re.split(", | and ", row["objects"])
        if row["want"] == want and (name in row["objects"] or on == ["every object"]):
            everywhere, _, somewhere = row["take"].partition("; on some = ")
            if len(on) > 1 and {"mc", "mc-edge-groups"} & set(somewhere.split(", ")):
                sys.exit(f"{name}: whether mc is tied for the {want} is not in decision.csv: {row['take']}")
            return everywhere.split(" = ") + somewhere.split(", ")
    sys.exit(f"{name}: decision.csv has no row for the {want}")


def fastest():
    """That nobody is shown to be faster than these two, if it is so, for whole blocks, chunks and edits."""
    of_time = ["the shortest time" + what + source for what in ["", " for a chunk", " for an edit"] for source in ["", " from stored samples"]]
    of_time = [want + ", in chunks" if want.endswith("edit") else want for want in of_time]
    for want in of_time:
        for place, o in enumerate(OBJECTS):
            names = tied(want, place)
            if not {"mc", "mc-edge-groups"} & set(names):
                sys.exit(f"{o}: the {want} is {names}, and the pages recommend mc and mc-edge-groups")
    return "No other method is shown to be faster on any object."


def take(docs):
    """The table of recommendations: which method, why, and its price. `docs` leads to the folder of that name."""
    called = lambda method: range_of(ratios("chunks", "chunk_ms", method), 1)
    stored = lambda method: range_of(ratios("stored", "chunk_ms", method), 1)
    chunk = lambda method: f"It takes {called(method)} times the time per chunk of `mc` ({stored(method)} from samples)"
    error = lambda method: [of / cubes for of, cubes in zip(errors(method), errors("mc"))]
    fewer = [100 * (1 - ratio) for ratio in ratios("quality", "triangles", "snapmc")]
    ratio = lambda method: range_of([float(table("quality", TO)[f"{o}_{method}"]["radius_ratio_mean"]) for o in OBJECTS], 2)
    edge = lambda method: float(table("accuracy", TO)[f"bu_{method}"]["sharp_edges_mean"])
    topology = table("topology", TO)
    # Tables of a study without regions have the whole alone.
    pairs = lambda id: int(topology[id].get("self_intersections_judged") or topology[id]["self_intersections"])
    most = max(pairs(f"{o}_bi-relaxed") for o in OBJECTS)
    if any(pairs(f"{o}_cms") for o in OBJECTS):
        sys.exit("cms has triangles that intersect, and the pages say that it has none")
    mc33 = 100 * (max(ratios("chunks", "chunk_ms", "mc33")) - 1)
    more = range_of(ratios("quality", "triangles", "bi-relaxed"), 1)
    lines = [
        ("for", "take", "because", "its price"),
        ("---", "---", "---", "---"),
        (
            "caves, cliffs, or you do not know",
            "`mc33`",
            "It is a manifold with every tunnel of the interpolated samples.",
            f"It takes up to {max(1, mc33):.0f} % more time per chunk than `mc`.",
        ),
        (
            "the shortest time",
            "`mc` or `mc-edge-groups`",
            fastest(),
            f"Many triangles are thin: the mean radius ratio is {ratio('mc')}.",
        ),
        (
            "meshes that you edit",
            "`nets-manifold`",
            f"It is a manifold of more regular triangles: the mean radius ratio is {ratio('nets-manifold')}.",
            f"{chunk('nets-manifold')}, and has up to {max(error('nets-manifold')):.1f} times the error.",
        ),
        (
            "buildings and sharp edges",
            "`dc-in-cell`",
            f"It has {edge('dc-in-cell'):.3f} cube edges of error at the sharp edges of the building, where `mc` has {edge('mc'):.2f}.",
            f"{chunk('dc-in-cell')}. {pairs('bu_dc-in-cell'):,} pairs of triangles intersect there, {pairs('ca_dc-in-cell'):,} in the caves.",
        ),
        (
            "the same without intersections",
            "`cms`",
            f"No two triangles intersect here. It has {range_of(error('cms'), 2)} of `mc`'s error, {edge('cms'):.3f} cube edges at sharp edges.",
            f"It takes {range_of(ratios('benchmark', 'total_without_normals_s', 'cms'), 1)} times the time of `mc`, without chunks.",
        ),
        (
            "near-equilateral triangles",
            "`bi-relaxed`",
            f"Its mean radius ratio is {ratio('bi-relaxed')}. It has {range_of(error('bi-relaxed'), 2)} of the error of `mc`.",
            f"{chunk('bi-relaxed')}, and has {more} times the triangles. Up to {most} pairs intersect.",
        ),
        (
            "few triangles, none thin",
            "`snapmc`",
            f"It has {range_of(fewer, 0)} % fewer than `mc`. No angle is below 12.7 degrees.",
            f"{chunk('snapmc')}, and has up to {max(error('snapmc')):.2f} times the error. Close sheets touch.",
        ),
        (
            "coarse terrain far away",
            "`mc` or `nets`",
            f"Both have [levels of detail]({docs}lod.md) without cracks.",
            "`nets` is no manifold. `mc` has thin triangles.",
        ),
        (
            "the look that people like most",
            "`si`, `bi` or `bp`",
            "They have the highest worths, and are not shown to differ.",
            "People saw other objects and six methods.",
        ),
    ]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def unbeaten():
    """Who is on each front, object by object."""
    rows = list(csv.DictReader((TERRAIN / "tables/fronts.csv").open()))
    fronts = list(dict.fromkeys(row["front"] for row in rows))
    lines = ["| On | " + " | ".join(f"Not beaten in {front}" for front in fronts) + " |", "|---|" + "---|" * len(fronts)]
    for name in dict.fromkeys(row["object"] for row in rows):
        on = lambda front: [
            f"`{row['method']}`"
            for row in rows
            if (row["object"], row["front"], row["standing"]) == (name, front, "on the front")
        ]
        lines.append(f"| {name} | " + " | ".join(", ".join(on(front)) for front in fronts) + " |")
    return "\n".join(lines)


def by_object(of, cell):
    """A row a method, a column an object, of a table by id; what is there for its look or its number of triangles alone is left out."""
    names = {id.split("_")[0]: row["object"] for id, row in table("configurations").items()}
    methods = [m for m in dict.fromkeys(id.split("_")[1] for id in of) if not m.endswith(("-flat", "-smooth", "-matched"))]
    lines = ["| method | " + " | ".join(names[o] for o in OBJECTS) + " |", "|---|" + "---:|" * len(OBJECTS)]
    for method in methods:
        lines.append(f"| `{method}` | " + " | ".join(cell(of[f"{o}_{method}"]) for o in OBJECTS) + " |")
    return "\n".join(lines)


# Families of contrasts of the questionnaire, by what they are over and how many questions show one.
KINDS = {
    ("methods as a whole", "4"): "two methods on all objects",
    ("methods on one object", "1"): "two methods on one object",
    ("methods as a whole", "1"): "two looks on the building",
}


def power():
    """The chance to find a preference that 69 % of the decided answers show, by people asked, after Holm's correction."""
    command = [ROOT / "target/release/isostudy", "design", "power", ROOT / "configs/terrain.toml", "--shares", "0.69"]
    with tempfile.TemporaryDirectory() as folder:

        def run(participants, *more):
            subprocess.run([*command, "--participants", participants, *more, "--out", folder], check=True, capture_output=True)
            rows = csv.DictReader((pathlib.Path(folder) / "power_by_kind.csv").open())
            return {(row["over"], row["questions"]): row for row in rows}

        plain, by_side = run("36,54,72,252"), run("36", "--side-bias", "1.5")
    lines = ["| Preferred between | 36 people | 54 | 72 | 252 | 36 who like the left side by 1.5 log-odds |", "|---|" + "---:|" * 5]
    for kind, name in KINDS.items():
        cells = [plain[kind][f"power_{people}"] for people in (36, 54, 72, 252)] + [by_side[kind]["power_36"]]
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    replace(ROOT / "docs/terrain.md", "power", "\n".join(lines))


def work():
    """Samples of the field, and megabytes where somebody saw them, of one block."""
    memory = lambda row: f"{int(row['extraction_memory_bytes']) / 1e6:.1f}" if row["extraction_memory_bytes"] else "unknown"
    return by_object(table("benchmark"), lambda row: f"{int(row['evaluations']):,}; {memory(row)}")


# What the paper concludes, by the claim that says it, and how the claim's number upholds it here.
CONCLUSIONS = {
    "discard_integrated": ("Integrated clustering discards most triangles", "most"),
    "discard_edge_collapse": ("Edge collapse discards most triangles", "most"),
    "vertex_integrated": ("Integrated clustering lengthens the vertex pass", "time"),
    "geometry_integrated": ("Integrated clustering shortens the geometry pass", "time"),
    "vertex_edge_collapse": ("Edge collapse shortens the vertex pass", "time"),
    "geometry_edge_collapse": ("Edge collapse lengthens the geometry pass", "time"),
    "arrangement_vertex": ("The body-centred lattice lengthens the vertex pass", "time"),
    "arrangement_geometry": ("The body-centred lattice lengthens the geometry pass", "time"),
    "arrangement_triangles": ("The body-centred lattice gives more triangles", "more"),
    "arrangement_samples": ("The body-centred lattice takes twice the samples", "twice"),
    "less_uniform": ("Integrated clustering gives less uniform triangles than edge collapse", "cases"),
    "fewer_triangles": ("Integrated clustering gives fewer triangles than edge collapse", "cases"),
}


def conclusions():
    """Whether the paper's conclusions hold on terrain, by the direction of what was measured and its interval."""
    lines = ["| Conclusion of the paper | There | Here | Holds here |", "|:---|---:|---:|:---|"]
    for row in csv.DictReader((TO / "claims.csv").open()):
        if row["id"] not in CONCLUSIONS:
            continue
        conclusion, rule = CONCLUSIONS[row["id"]]
        ours, reason = float(row["ours"]), row["reason"]
        if rule == "most":
            verdict = "yes" if ours > 50 else "no"
        elif rule == "more":
            verdict = "yes" if ours > 0 else "no"
        elif rule == "twice":
            verdict = "yes" if abs(ours - 2) < 0.15 else "no"
        elif rule == "cases":
            verdict = re.match(r"holds (in \d+ of \d+ cases)", reason)[1]
        else:
            said = {"same direction": "yes", "opposite direction": "no", "no change measurable": "open"}
            verdict = next(verdict for words, verdict in said.items() if reason.startswith(words))
        percent = row["unit"] == "%"
        show = lambda value: (f"{float(value):.0f} %" if percent else f"{float(value):.2f}").replace("-", "\u2212")
        there = show(row["published"]) if row["published"] else ""
        here = "" if rule == "cases" else show(row["ours"])
        lines.append(f"| {conclusion} | {there} | {here} | {verdict} |")
    return "\n".join(lines)


def short(milliseconds):
    value = float(milliseconds)
    return f"{value:.0f}" if value >= 10 else f"{value:.1f}"


def chunks():
    """Milliseconds per chunk and per edit."""
    return by_object(table("chunks"), lambda row: f"{short(row['chunk_ms'])}, {short(row['edit_ms'])}")


if sys.argv[1:] == ["--recommended"]:
    recommend()
elif sys.argv[1:] == ["--power"]:
    power()
else:
    main()
