#!/usr/bin/env python3
"""Draws the crates as docs/house.svg, and fails where an arrow between crates or files is wrong.

Usage: scripts/draw-house.py [--check] [--circles] [FOLDER]

Reads crates/*/Cargo.toml and the sources of FOLDER (by default this workspace), and writes docs/house.svg there.
It fails (exit 1)
- if crates depend on each other in a circle, in what they need to be built for use;
- if a crate uses what a rule below gives to others, or reaches a crate that it must never meet;
- if files of a crate use each other in a circle. A parent and its own child may.
--check writes nothing and fails if docs/house.svg is not what would be drawn. --circles only looks
at the files. Test modules and development dependencies are left out.
"""

import re
import sys
import tempfile
import tomllib
from pathlib import Path
from xml.sax.saxutils import escape

# External crates, and the only crates that may use them.
ONLY = {
    "polars": {"isostudy-report"},
    "polars-arrow": {"isostudy-report"},
    "polars-parquet": {"isostudy-report"},
    "plotters": {"isostudy-report"},
    "clap": {"isostudy"},
    "anyhow": {"isostudy"},
    "indicatif": {"isostudy"},
    "isostudy-expression": {"isostudy"},
    "isostudy-volume": {"isostudy"},
    "isostudy-grid": {"isostudy"},
    "isostudy-front": {"isostudy"},
    "isostudy-program": {"isostudy"},
    "isostudy-scattered": {"isostudy"},
    "isostudy-four": {"isostudy"},
}
# All crates of the workspace that these may use themselves.
KNOWS = {
    "isostudy-mesh": set(),
    "isostudy-cells": set(),
    "isostudy-foreign": set(),
    "isostudy-volume": {"isostudy-foreign"},
    "isostudy-grid": {"isostudy-foreign", "isostudy-mesh", "isostudy-field"},
    "isostudy-front": {"isostudy-mesh", "isostudy-field"},
    "isostudy-design": {"isostudy-foreign"},
    "isostudy-table": set(),
    "isostudy-statistics": set(),
    "isostudy-trilinear": {"isostudy-mesh"},
    "isostudy-finish": {"isostudy-mesh"},
    "isostudy-ffi": {"isostudy-extract"},
}
# Crates that the first one must not reach, whatever the way.
NEVER = {
    "isostudy-extract": {"isostudy-raster", "isostudy-trilinear", "isostudy-design"},
    "isostudy-raster": {"isostudy-extract", "isostudy-field", "isostudy-design"},
    "isostudy-inference": {"isostudy-mesh", "isostudy-report", "isostudy-paper"},
    "isostudy-report": {"isostudy-mesh", "isostudy-paper"},
}
# Crates that the first one must not use itself; what it uses may.
NOT_ITSELF = {"isostudy-inference": {"isostudy-table"}}
# The program. Crates that it is not built from are for development, and drawn with dashes.
PROGRAM = "isostudy"


# --- crates ------------------------------------------------------------------------------------


def read_crates(root):
    """Name -> (folder, description, normal dependencies inside, those outside)."""
    manifests = {}
    for path in sorted((root / "crates").glob("*/Cargo.toml")):
        manifest = tomllib.loads(path.read_text(encoding="utf-8"))
        manifests[manifest["package"]["name"]] = (path.parent, manifest)
    crates = {}
    for name, (folder, manifest) in manifests.items():
        needed = set(manifest.get("dependencies", {})) | set(manifest.get("build-dependencies", {}))
        for target in manifest.get("target", {}).values():
            needed |= set(target.get("dependencies", {}))
        inside = {other for other in needed if other in manifests}
        crates[name] = (folder, manifest["package"].get("description", ""), inside, needed)
    return crates


def reachable(arrows, start):
    found, waiting = set(), [start]
    while waiting:
        for other in arrows[waiting.pop()]:
            if other not in found:
                found.add(other)
                waiting.append(other)
    return found


def circles(arrows):
    """Sets of more than one node that reach each other, sorted."""
    far = {node: reachable(arrows, node) for node in arrows}
    found = {frozenset(other for other in far[node] | {node} if node in far[other] or other == node) for node in arrows}
    return sorted(sorted(group) for group in found if len(group) > 1)


def faults_of_crates(crates):
    arrows = {name: inside for name, (_, _, inside, _) in crates.items()}
    faults = ["crates in a circle: " + ", ".join(group) for group in circles(arrows)]
    for name, (_, description, inside, needed) in crates.items():
        if not description:
            faults.append(f"{name} has no description in its Cargo.toml")
        for other in sorted(needed):
            if name not in ONLY.get(other, {name}):
                faults.append(f"{name} uses {other}, which only {', '.join(sorted(ONLY[other]))} may")
        for other in sorted(reachable(arrows, name) & NEVER.get(name, set())):
            faults.append(f"{name} reaches {other} and must not")
        for other in sorted((inside & NOT_ITSELF.get(name, set())) | (inside - KNOWS.get(name, inside))):
            faults.append(f"{name} uses {other} and must not")
    return faults


# --- files -------------------------------------------------------------------------------------


def code_of(text):
    """The code without comments, strings, and modules and items for tests."""
    pattern = r'//[^\n]*|/\*.*?\*/|r(#*)".*?"\1|b?"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])\''
    code = re.sub(pattern, " ", text, flags=re.S)
    while match := re.search(r"#\[cfg\((?:test|all\(test[^\]]*)\)\]", code):
        end, depth = match.end(), 0
        while end < len(code):
            depth += {"{": 1, "}": -1}.get(code[end], 0)
            end += 1
            if depth == 0 and code[end - 1] in ";}":
                break
        code = code[: match.start()] + code[end:]
    return code


def expand(tree):
    """`a::{b, c as d}` as [(["a", "b"], "b"), (["a", "c"], "d")]."""
    tree = tree.strip()
    if "{" not in tree:
        path, _, alias = tree.partition(" as ")
        parts = [part.strip() for part in path.split("::") if part.strip()]
        if parts and parts[-1] == "self":
            parts.pop()
        return [(parts, alias.strip() or (parts[-1] if parts else ""))]
    head, _, rest = tree.partition("{")
    prefix = [part.strip() for part in head.split("::") if part.strip()]
    items, depth, start = [], 0, 0
    inner = rest[: rest.rindex("}")]
    for place, letter in enumerate(inner + ","):
        depth += {"{": 1, "}": -1}.get(letter, 0)
        if letter == "," and depth == 0:
            items.append(inner[start:place])
            start = place + 1
    return [(prefix + parts, alias if parts else prefix[-1]) for item in items if item.strip() for parts, alias in expand(item)]


class Module:
    """One file of a crate: what it imports under which name, and the paths it names."""

    def __init__(self, path, file, code):
        self.path, self.file = path, file
        uses = re.findall(r"\buse\s+([^;]+);", code)
        self.imports, self.globs = {}, []
        for parts, alias in (item for tree in uses for item in expand(tree)):
            if alias == "*":
                self.globs.append(parts[:-1])
            elif parts:
                self.imports[alias] = parts
        rest = re.sub(r"\buse\s+[^;]+;", " ", code)
        self.named = {tuple(found.split("::")) for found in re.findall(r"(?<![\w:])(?:[A-Za-z_]\w*::)+[A-Za-z_]\w*", rest)}


def read_modules(root_file):
    modules = {}

    def read(path, file):
        code = code_of(file.read_text(encoding="utf-8"))
        modules[path] = Module(path, file, code)
        folder = file.parent if not path else file.with_suffix("")
        for name in re.findall(r"\bmod\s+(\w+)\s*;", code):
            child = folder / f"{name}.rs"
            if child.exists():
                read((*path, name), child)

    read((), root_file)
    return modules


def target(modules, module, parts, inline=False, depth=0):
    """The path of the module that defines what `parts` names in `module`, or None for what is outside."""
    if not parts or depth > 20:
        return None
    here, rest = module.path, list(parts)
    if rest[0] == "crate":
        here, rest = (), rest[1:]
    elif rest[0] in ("self", "super"):
        while rest and rest[0] in ("self", "super"):
            here, rest = (here[:-1] if rest[0] == "super" else here), rest[1:]
    elif (*here, rest[0]) not in modules and not (inline and rest[0] in module.imports):
        return None
    while rest and (*here, rest[0]) in modules:
        here, rest = (*here, rest[0]), rest[1:]
    there = modules.get(here)
    if there is None:
        return None
    if rest and rest[0] in there.imports:
        found = target(modules, there, there.imports[rest[0]] + rest[1:], depth=depth + 1)
        return found if found is not None else (None if there is module else here)
    for glob in there.globs if rest else ():
        found = target(modules, there, [*glob, rest[0]], depth=depth + 1)
        if found is not None and found != here and defines(modules[found], rest[0]):
            return found
    return here


def defines(module, name):
    return re.search(rf"\b(?:fn|struct|enum|trait|type|const|static|union)\s+{name}\b", module.file.read_text(encoding="utf-8"))


def is_module(modules, module, parts):
    """Whether `parts` names a module and no item in one; using it then says nothing yet."""
    here, rest = module.path, list(parts)
    if rest[0] == "crate":
        here, rest = (), rest[1:]
    while rest and rest[0] in ("self", "super"):
        here, rest = (here[:-1] if rest[0] == "super" else here), rest[1:]
    return bool(rest) and (*here, *rest) in modules


def arrows_of_files(modules):
    arrows = {path: set() for path in modules}
    for path, module in modules.items():
        paths = [parts for parts in module.imports.values() if not is_module(modules, module, parts)]
        paths += [[*glob, "*"] for glob in module.globs]
        found = {target(modules, module, parts) for parts in paths}
        found |= {target(modules, module, list(parts), inline=True) for parts in module.named}
        arrows[path] = found - {None, path}
    return arrows


def related(one, other):
    shorter = min(len(one), len(other))
    return one[:shorter] == other[:shorter]


def circles_of_files(modules):
    """Circles among files; those of a parent and its own children alone are none."""
    arrows = arrows_of_files(modules)
    apart = {path: {other for other in others if not related(path, other)} for path, others in arrows.items()}
    found = circles(apart)
    # A file may still close a circle through a parent: then no member stands above all others. The crate's
    # root declares every file, so it is no member.
    below = {path: {other for other in others if other} for path, others in arrows.items() if path}
    for group in circles(below):
        if not any(all(other[: len(top)] == top for other in group) for top in group) and not any(set(small) <= set(group) for small in found):
            found.append(group)
    return [[str(modules[path].file) for path in group] for group in found]


def faults_of_files(root, crates):
    faults = []
    for folder, *_ in crates.values():
        for name in ("lib.rs", "main.rs"):
            if (folder / "src" / name).exists():
                for group in circles_of_files(read_modules(folder / "src" / name)):
                    names = [str(Path(file).relative_to(root)) for file in group]
                    faults.append("files in a circle: " + ", ".join(names))
    return faults


# Small crates, and the files of each that are in a circle.
EXAMPLES = [
    ({"lib": "mod a; mod b; pub use a::A; pub use b::B;", "a": "use crate::B; pub struct A;", "b": "use crate::A; pub struct B;"}, ["a", "b"]),
    ({"lib": "mod a; mod b;", "a": "use crate::b::B; pub struct A;", "b": "pub struct B; #[cfg(test)] mod tests { use crate::a::A; }"}, []),
    ({"lib": "mod a; mod b;", "a": "use crate::b::B; pub struct A;", "b": "/* use crate::a::A; */ pub struct B; const C: &str = \"crate::a::A\";"}, []),
    ({"lib": "mod a;", "a": "mod c; pub struct A; use c::C;", "a/c": "use super::A; pub struct C;"}, []),
    ({"lib": "mod a;", "a": "mod c; mod e;", "a/c": "use super::e::E; pub struct C;", "a/e": "use super::c::C; pub struct E;"}, ["a/c", "a/e"]),
    ({"lib": "mod a; mod b;", "a": "pub mod c; fn f() { crate::b::g(); c::h() }", "a/c": "use super::A; pub struct C;", "b": "use crate::a::c::C; pub fn g() {}"}, ["a", "a/c", "b"]),
]


def self_test():
    """Examples in which other circles are found than there are."""
    wrong = []
    for files, expected in EXAMPLES:
        with tempfile.TemporaryDirectory() as folder:
            for name, text in files.items():
                path = Path(folder) / f"{name}.rs"
                path.parent.mkdir(exist_ok=True)
                path.write_text(text, encoding="utf-8")
            groups = circles_of_files(read_modules(Path(folder) / "lib.rs"))
            found = sorted(str(Path(file).relative_to(folder))[:-3] for group in groups for file in group)
        if found != expected:
            wrong.append(f"in {files} the files {found} are in a circle, not {expected}")
    return wrong


# --- drawing -----------------------------------------------------------------------------------

WIDTH, MARGIN = 1000, 10
BOX, GAP, SLOT = 148, 12, 12
NAME, TEXT, LINE = 14, 11.5, 14.5
BETWEEN = 52


def reduced(arrows):
    """Without the arrows that longer ways make plain."""
    return {
        name: {other for other in others if not any(other in reachable(arrows, third) for third in others if third != other)}
        for name, others in arrows.items()
    }


def floors(arrows):
    """Leaves on the ground; others as near as they can be to what they use and what uses them."""
    users = {name: [other for other in arrows if name in arrows[other]] for name in arrows}
    floor = {}
    while len(floor) < len(arrows):
        for name in sorted(arrows):
            if name not in floor and all(other in floor for other in arrows[name]):
                floor[name] = 1 + max((floor[other] for other in arrows[name]), default=-1)
    top = max(floor.values())
    full = 6
    for _ in range(len(arrows)):
        for name in sorted(arrows):
            if not arrows[name]:
                continue
            lowest = 1 + max(floor[other] for other in arrows[name])
            highest = min((floor[other] for other in users[name]), default=top + 1) - 1

            def cost(level):
                length = sum(level - floor[other] for other in arrows[name]) + sum(floor[other] - level for other in users[name])
                crowd = sum(1 for other in floor if other != name and floor[other] == level)
                return (crowd >= full, length, level)

            floor[name] = min(range(lowest, highest + 1), key=cost)
    return floor


def ordered(floor, arrows):
    """Rows of boxes, and of slots where an arrow passes a floor, with few crossings."""
    rows = [sorted(name for name in floor if floor[name] == level) for level in range(max(floor.values()) + 1)]
    ways = []
    for name in sorted(arrows):
        for other in sorted(arrows[name]):
            way = [name]
            for level in range(floor[name] - 1, floor[other], -1):
                # Arrows to the same crate share their way down.
                slot = ("slot", other, level)
                if slot not in rows[level]:
                    rows[level].append(slot)
                way.append(slot)
            ways.append([*way, other])
    pieces = {(a, b) for way in ways for a, b in zip(way, way[1:])}
    level_of = {node: level for level, row in enumerate(rows) for node in row}

    def crossings():
        total = 0
        for level in range(len(rows) - 1):
            above = {node: place for place, node in enumerate(rows[level + 1])}
            below = {node: place for place, node in enumerate(rows[level])}
            lines = [(above[a], below[b]) for a, b in pieces if level_of[b] == level]
            total += sum((a - c) * (b - d) < 0 for i, (a, b) in enumerate(lines) for c, d in lines[:i])
        return total

    best, fewest = [list(row) for row in rows], crossings()
    for step in range(60):
        down = step % 2 == 0
        for level in range(len(rows) - 2, -1, -1) if down else range(1, len(rows)):
            beside = rows[level + 1] if down else rows[level - 1]
            share = {node: (place + 0.5) / len(beside) for place, node in enumerate(beside)}
            old = {node: (place + 0.5) / len(rows[level]) for place, node in enumerate(rows[level])}

            def middle(node):
                near = [share[a if down else b] for a, b in pieces if (b if down else a) == node and (a if down else b) in share]
                return (sum(near) / len(near) if near else old[node], str(node))

            rows[level].sort(key=middle)
        if crossings() < fewest:
            best, fewest = [list(row) for row in rows], crossings()
    rows[:] = best
    # Neighbours change places where that crosses fewer arrows.
    changed = True
    while changed:
        changed = False
        for row in rows:
            for place in range(len(row) - 1):
                before = crossings()
                row[place], row[place + 1] = row[place + 1], row[place]
                if crossings() < before:
                    changed = True
                else:
                    row[place], row[place + 1] = row[place + 1], row[place]
    return rows, ways, pieces


def width_of(text, size):
    """Wider than DejaVu Sans sets it."""
    narrow, wide = "ijlt.,:;'|()f ", "mwMW"
    return size * sum(0.4 if letter in narrow else 0.99 if letter in wide else 0.64 for letter in text)


def wrapped(text, size, room):
    lines = [""]
    for word in text.split():
        longer = f"{lines[-1]} {word}".strip()
        if width_of(longer, size) <= room or not lines[-1]:
            lines[-1] = longer
        else:
            lines.append(word)
    return lines


def node_width(node):
    return SLOT if isinstance(node, tuple) else BOX


def places(rows, pieces):
    """The middle of every box and slot, left to right, near what it is connected with."""
    centre = {}
    for row in rows:
        free = WIDTH - 2 * MARGIN - sum(map(node_width, row))
        gap = max(4, min(GAP, free / max(1, len(row) - 1)))
        x = (WIDTH - sum(map(node_width, row)) - gap * (len(row) - 1)) / 2
        for node in row:
            centre[node] = x + node_width(node) / 2
            x += node_width(node) + gap
    for _ in range(80):
        for row in rows:
            wish = {}
            for node in row:
                near = [centre[b] for a, b in pieces if a == node] + [centre[a] for a, b in pieces if b == node]
                wish[node] = sum(near) / len(near) if near else centre[node]
            # As near to the wish as neighbours and the margins let it be.
            left = MARGIN
            lowest, highest = {}, {}
            for node in row:
                lowest[node] = left + node_width(node) / 2
                left += node_width(node) + 8
            right = WIDTH - MARGIN
            for node in reversed(row):
                highest[node] = right - node_width(node) / 2
                right -= node_width(node) + 8
            edge = None
            for node in row:
                low = lowest[node] if edge is None else max(lowest[node], edge + 8 + node_width(node) / 2)
                centre[node] = min(max((centre[node] + wish[node]) / 2, low), max(low, highest[node]))
                edge = centre[node] + node_width(node) / 2
    return centre


def draw(crates):
    arrows = reduced({name: inside for name, (_, _, inside, _) in crates.items()})
    floor = floors(arrows)
    rows, ways, pieces = ordered(floor, arrows)
    centre = places(rows, pieces)
    texts = {name: wrapped(description, TEXT, BOX - 14) for name, (_, description, _, _) in crates.items()}
    height = [30 + LINE * max((len(texts[node]) for node in row if node in texts), default=1) for row in rows]
    top, y = {}, MARGIN
    for level in range(len(rows) - 1, -1, -1):
        top[level] = y
        y += height[level] + BETWEEN
    total = y - BETWEEN + MARGIN
    # A full floor may need more than the width.
    left = min(0, min(centre[node] - node_width(node) / 2 for node in centre) - MARGIN)
    width = max(WIDTH, max(centre[node] + node_width(node) / 2 for node in centre) + MARGIN) - left
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{left:.0f} 0 {width:.0f} {total:.0f}" width="{width:.0f}" height="{total:.0f}" '
        'font-family="DejaVu Sans, Verdana, sans-serif">',
        "<title>The crates of isostudy. An arrow leads from a crate to one that it uses.</title>",
        '<defs><marker id="head" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto">'
        '<path d="M0 0.5 8 4 0 7.5z" fill="#47586b"/></marker></defs>',
        f'<rect x="{left:.0f}" width="{width:.0f}" height="{total:.0f}" fill="#ffffff"/>',
    ]
    # Where arrows leave and reach a box, they are spread over its side in the order of their other ends.
    ends = {}
    for side in (0, 1):
        for level, row in enumerate(rows):
            for node in row:
                mine = sorted((piece for piece in pieces if piece[side] == node), key=lambda piece: (centre[piece[1 - side]], str(piece)))
                room = 0 if isinstance(node, tuple) else BOX - 44
                for place, piece in enumerate(mine):
                    share = (place + 0.5) / len(mine) - 0.5
                    ends[piece, side] = centre[node] + room * share
    level_of = {node: level for level, row in enumerate(rows) for node in row}
    built = reachable(arrows, PROGRAM) | {PROGRAM} if PROGRAM in arrows else set(arrows)
    for a, b in sorted(pieces, key=str):
        from_y, to_y = top[level_of[a]] + height[level_of[a]], top[level_of[b]]
        x0, x1 = ends[(a, b), 0], ends[(a, b), 1]
        start = from_y
        line = f"M{x0:.1f} {start:.1f}C{x0:.1f} {start + BETWEEN * 0.55:.1f} {x1:.1f} {to_y - BETWEEN * 0.55:.1f} {x1:.1f} {to_y:.1f}"
        if isinstance(b, tuple):
            line += f"V{to_y + height[level_of[b]]:.1f}"
        head = "" if isinstance(b, tuple) else ' marker-end="url(#head)"'
        head += "" if isinstance(a, tuple) or a in built else ' stroke-dasharray="4 3"'
        out.append(f'<path d="{line}" fill="none" stroke="#47586b" stroke-width="1.3"{head}/>')
    for level, row in enumerate(rows):
        for node in row:
            if isinstance(node, tuple):
                continue
            x = centre[node] - BOX / 2
            fill = ("#e8eef5" if arrows[node] else "#f4ecd8") if node in built else "#ffffff"
            dashes = "" if node in built else ' stroke-dasharray="4 3"'
            out.append(f'<rect x="{x:.1f}" y="{top[level]:.1f}" width="{BOX}" height="{height[level]:.1f}" rx="5" fill="{fill}" stroke="#47586b"{dashes}/>')
            name = node.removeprefix("isostudy-")
            out.append(f'<text x="{centre[node]:.1f}" y="{top[level] + 18:.1f}" font-size="{NAME}" font-weight="bold" text-anchor="middle" fill="#12202f">{escape(name)}</text>')
            for number, line in enumerate(texts[node]):
                line_y = top[level] + 35 + LINE * number
                out.append(f'<text x="{centre[node]:.1f}" y="{line_y:.1f}" font-size="{TEXT}" text-anchor="middle" fill="#12202f">{escape(line)}</text>')
    return "\n".join([*out, "</svg>", ""])


def main(arguments):
    options = [argument for argument in arguments if argument.startswith("--")]
    folders = [argument for argument in arguments if not argument.startswith("--")]
    if set(options) - {"--check", "--circles"} or len(folders) > 1:
        print(__doc__.split("\n\n")[1], file=sys.stderr)
        return 2
    root = Path(folders[0]).resolve() if folders else Path(__file__).resolve().parent.parent
    crates = read_crates(root)
    faults = self_test() + faults_of_files(root, crates)
    if "--circles" not in options:
        faults += faults_of_crates(crates)
        if not any("crates in a circle" in fault for fault in faults):
            picture, path = draw(crates), root / "docs/house.svg"
            if "--check" not in options:
                path.write_text(picture, encoding="utf-8")
            elif not path.exists() or path.read_text(encoding="utf-8") != picture:
                faults.append("docs/house.svg is not the house of today: run scripts/draw-house.py")
    for fault in faults:
        print(f"draw-house: {fault}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
