#!/usr/bin/env python3
"""Damages every kind of file that the command reads, and says what the command came to.

Usage: scripts/attack-readers.py ISOSTUDY [MUTANTS] [SEED] [FILTER]

Each mutant is a sound file with one to five changes: bits, bytes, cuts, copies, parts of other files, and words that break
readers. The command must end with exit code 0, 1 or 2, within 10 s, with less than 500 MB, without a panic, and without a control
character in what it says. A mutant that breaks this is kept in the current folder. Exit 1 if there is one.
"""

import gzip
import json
import math
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

SECONDS = 10
MEMORY_BYTES = 500 << 20
PROJECT = Path(__file__).resolve().parent.parent
ANSWERS = PROJECT / "study/paper"

WORDS = [
    b"\0", b"\n", b"\r", b" ", b",", b";", b'"', b"'", b"-1", b"0", b"1e39", b"1e999", b"nan", b"inf", b"99999999999999999999",
    b"4294967295", b"18446744073709551615", b"\xff\xff\xff\xff", b"\xff\xff\xff\x7f", b"\x00\x00\xc0\x7f", b"\xef\xbb\xbf", b"\xff\xfe",
    b"\x1b[2J", b"\xe2\x80\xae", b"[[", b"]]", b"{", b"}", b"[" * 2000, b"{a=" * 500, b"(" * 3000, b"../../", b"/dev/zero", b"=", b"#",
    b"sizes: 65535 65535 65535\n", b"sizes: 0 0 0\n", b"encoding: gzip\n", b"data file: /dev/zero\n", b"type: double\n", b"ElementDataFile = LIST\n",
    b"DimSize = 100000 100000 100000\n", b"element vertex 18446744073709551615\n", b"property list uchar int vertex_indices\n",
    b"format binary_big_endian 1.0\n", b"end_header\n", b"f -1 -2 -3\n", b"f 1/1/1 2/2/2 3/3/3\n", b"endsolid\n", b"x" * 70000,
]


def sound_files(isostudy, folder):
    """Family, sound files with those beside them, and the command's words; `{}` stands for the damaged file."""
    run = lambda *words: subprocess.run([isostudy, *words], cwd=folder, check=True, capture_output=True)
    n = 8
    half = (n - 1) / 2
    at = [(x - half, y - half, z - half) for z in range(n) for y in range(n) for x in range(n)]
    u8 = bytes(int(max(0, 200 - 40 * (x * x + y * y + z * z) ** 0.5)) for x, y, z in at)
    labels = bytes((x > 0) + 2 * (y > 0) if x * x + y * y + z * z < 9 else 0 for x, y, z in at)
    space = "space: left-posterior-superior\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n"
    head = lambda encoding, more="": f"NRRD0005\ntype: uint8\ndimension: 3\n{space}sizes: {n} {n} {n}\nencoding: {encoding}\n{more}".encode()
    meta = lambda data: f"ObjectType = Image\nNDims = 3\nDimSize = {n} {n} {n}\nElementType = MET_UCHAR\nElementSpacing = 1 1 1\nElementDataFile = {data}\n".encode()
    (folder / "data.raw").write_bytes(u8)
    raw = (f'file = "data.raw"\ntype = "u8"\nsize = [{n}, {n}, {n}]\nspacing = [1.0, 1.0, 1.0]\n').encode()
    volumes = {
        "raw.nrrd": head("raw") + b"\n" + u8,
        "gzip.nrrd": head("gzip") + b"\n" + gzip.compress(u8, mtime=0),
        "text.nrrd": head("ascii") + b"\n" + " ".join(map(str, u8)).encode(),
        "apart.nhdr": head("raw", "data file: data.raw\n"),
        "one.mha": meta("LOCAL") + u8,
        "two.mhd": meta("data.raw"),
        "raw.toml": raw,
    }
    for name, data in volumes.items():
        (folder / name).write_bytes(data)
    shutil.copy(PROJECT / "crates/isostudy-grid/tests/it/vtk/few.ele", folder)
    (folder / "labels.nrrd").write_bytes(head("raw") + b"\n" + labels)
    run("extract", "--field", "sqrt(x^2+y^2+z^2) - 1", "--bounds=-1.2,-1.2,-1.2,1.2,1.2,1.2", "--cells", "6", "-o", "sound.ply")
    for kind in ("obj", "stl"):
        run("extract", "--field", "sqrt(x^2+y^2+z^2) - 1", "--bounds=-1.2,-1.2,-1.2,1.2,1.2,1.2", "--cells", "6", "-o", f"sound.{kind}")
    (folder / "table.json").write_bytes(run("table", "mc", "--json").stdout)
    run("new", "my")
    # Where a study lies, the files that it names are found.
    placed = lambda path: path.read_text().replace('"cpu/', f'"{PROJECT}/configs/cpu/').replace('"../', f'"{PROJECT}/').encode()
    studies = [placed(path) for path in sorted((PROJECT / "configs").glob("*.toml"))]
    studies.append((folder / "my/study.toml").read_bytes())
    long = ["participant,question,left,right,choice"]
    long += [f"p{person},q{q},{'abcd'[q % 4]},{'abcd'[(q + 1) % 4]},{['left', 'right', 'none'][(person * q) % 3]}" for person in range(6) for q in range(8)]
    answers = {"long.csv": "\n".join(long).encode()}
    (folder / "long.csv").write_bytes(answers["long.csv"])
    for to in ("arenakit", "pwcmp"):
        if subprocess.run([isostudy, "convert", "long.csv", "--to", to, "-o", f"{to}.csv"], cwd=folder, capture_output=True).returncode == 0:
            answers[f"{to}.csv"] = (folder / f"{to}.csv").read_bytes()
    answers["responses.csv"] = (ANSWERS / "responses.csv").read_bytes()
    small = ["--memory", "200MB", "-o", "{out}.ply"]
    yield "volume", [(name, data) for name, data in volumes.items()], ["extract", "--volume", "{}", "--isovalue", "90.5", *small]
    yield "volume-cells", [(name, data) for name, data in volumes.items()], ["extract", "--volume", "{}", "--isovalue", "90.5", "--method", "bi", *small]
    yield "labels", [("labels.nrrd", (folder / "labels.nrrd").read_bytes())], ["extract", "--labels", "{}", *small]
    meshes = [(f"sound.{kind}", (folder / f"sound.{kind}").read_bytes()) for kind in ("ply", "obj", "stl")]
    yield "mesh", meshes, ["distance", "{}", "sound.ply", "--samples", "1000"]
    yield "mesh-field", meshes, ["extract", "--mesh", "{}", "--cells", "6", "--allow-open", *small]
    yield "mesh-verify", meshes, ["verify", "{}", "--volume", "raw.nrrd", "--isovalue", "90.5"]
    yield "study", [(f"study{i}.toml", data) for i, data in enumerate(studies)], ["validate", "{}"]
    yield "design", [("study.toml", placed(PROJECT / "configs/balanced.toml"))], ["design", "check", "{}"]
    yield "answers", list(answers.items()), ["convert", "{}", "--to", "long", "-o", "{out}.csv"]
    yield "analysis", [("long.csv", answers["long.csv"])], ["analyse", "{}", "-o", "{out}"]
    yield "table", [("table.json", (folder / "table.json").read_bytes())], ["table", "{}"]
    grids = PROJECT / "crates/isostudy-grid/tests/it/vtk"
    yield "grid", [(path.name, path.read_bytes()) for path in sorted(grids.glob("mixed_*"))], ["extract", "--grid", "{}", "--isovalue", "0.105", *small]
    yield "tetgen", [("few.node", (grids / "few.node").read_bytes())], ["extract", "--grid", "{}", "--isovalue", "0.105", *small]
    spiral = [(math.sin(2.4 * i), math.cos(2.4 * i), 0.9 - 0.06 * i) for i in range(30)]
    rows = [(*p, *(x / math.dist(p, (0, 0, 0)) for x in p)) for p in spiral]
    scan = "".join("%.4f %.4f %.4f %.4f %.4f %.4f\n" % row for row in rows)
    names = "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
    ply = f"ply\nformat ascii 1.0\nelement vertex {len(rows)}\n{names}end_header\n{scan}"
    yield "points", [("scan.xyz", scan.encode()), ("scan.ply", ply.encode())], ["extract", "--points", "{}", "--cells", "5", *small]
    yield "soup", meshes, ["extract", "--soup", "{}", "--cells", "5", *small]
    yield "formula", [("formula", b"min(sqrt(x^2+y^2+z^2) - 1, max(abs(x), 0.3*fbm(x*2, y, z, 3)) - sin(y))")], ["extract", "--field", "{text}", "--bounds=-1,-1,-1,1,1,1", "--cells", "5", *small]


def damaged(data, others, chance):
    data = bytearray(data)
    for _ in range(chance.choice([1, 1, 1, 2, 3, 5])):
        at = chance.randint(0, len(data))
        end = min(len(data), at + chance.randint(0, 60))
        kind = chance.randrange(9)
        if kind == 0 and at < len(data):
            data[at] ^= 1 << chance.randrange(8)
        elif kind == 1 and at < len(data):
            data[at] = chance.randrange(256)
        elif kind == 2:
            del data[at:end]
        elif kind == 3:
            data[at:at] = chance.choice(WORDS)
        elif kind == 4:
            word = chance.choice(WORDS)
            data[at : at + len(word)] = word
        elif kind == 5:
            data[at:at] = data[at:end]
        elif kind == 6 and chance.random() < 0.3:
            del data[at:]
        elif kind == 7:
            # A number that the file has, for another one.
            numbers = list(re.finditer(rb"-?\d+(\.\d+)?", bytes(data[:20000])))
            if numbers:
                number = chance.choice(numbers)
                data[number.start() : number.end()] = chance.choice([b"0", b"-1", b"1e30", b"4294967296", b"0.0000001", b"7", b"nan", b"65536"])
        else:
            from_other = chance.choice(others)[1]
            start = chance.randrange(len(from_other))
            data[at:at] = from_other[start : start + 60]
    return bytes(data)


def attack(isostudy, folder, number, name, data, words):
    place = folder / f"run{number}"
    place.mkdir()
    for beside in ("data.raw", "raw.nrrd", "sound.ply", "few.ele"):
        os.link(folder / beside, place / beside)
    file = place / name.replace("sound.", "damaged.").replace("raw.nrrd", "damaged.nrrd")
    if "{text}" in words:
        text = data.replace(b"\0", b" ").decode(errors="replace")
        words = [text if word == "{text}" else word for word in words]
        words = ["extract", f"--field={words[2]}", *words[3:]]
    else:
        file.write_bytes(data)
    words = [word.replace("{out}", "out").replace("{}", file.name) if word != words[1] or "{" in word else word for word in words]
    said = tempfile.TemporaryFile()
    begin = time.monotonic()
    child = subprocess.Popen([isostudy, *words], cwd=place, stdin=subprocess.DEVNULL, stdout=said, stderr=said, start_new_session=True)
    faults = []
    status = usage = None
    while status is None:
        pid, status_now, usage = os.wait4(child.pid, os.WNOHANG)
        if pid:
            status = os.waitstatus_to_exitcode(status_now)
        elif time.monotonic() - begin > SECONDS:
            child.kill()
            os.wait4(child.pid, 0)
            faults.append(f"longer than {SECONDS} s")
            break
        else:
            time.sleep(0.002)
    child.returncode = 0
    said.seek(0)
    text = said.read().decode(errors="replace")
    if status is not None and status not in (0, 1, 2):
        faults.append(f"exit code {status}")
    if "panicked" in text:
        faults.append("a panic")
    if usage is not None and usage.ru_maxrss * 1024 > MEMORY_BYTES:
        faults.append(f"{usage.ru_maxrss >> 10} MB")
    if any((ord(c) < 32 and c not in "\n\t") or c in "\u202e\u2066" for c in text):
        faults.append("a control character in what it said")
    if len(text) > 200_000:
        faults.append(f"{len(text)} characters said")
    took = time.monotonic() - begin
    shutil.rmtree(place)
    return status, faults, text, words, took


def main():
    isostudy = str(Path(sys.argv[1]).resolve())
    mutants = int(sys.argv[2]) if len(sys.argv) > 2 else 20_000
    seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    only = sys.argv[4] if len(sys.argv) > 4 else ""
    wrong = 0
    with tempfile.TemporaryDirectory() as root:
        folder = Path(root)
        families = [family for family in sound_files(isostudy, folder) if only in family[0]]
        share = -(-mutants // len(families))
        for family, files, words in families:
            def one(number, family=family, files=files, words=words):
                chance = random.Random(f"{seed} {family} {number}")
                name, data = chance.choice(files)
                data = damaged(data, files, chance)
                return number, name, data, attack(isostudy, folder, f"{family}{number}", name, data, words)

            codes, slowest = {}, 0.0
            with ThreadPoolExecutor(2) as pool:
                for number, name, data, (status, faults, text, typed, took) in pool.map(one, range(share)):
                    codes[status] = codes.get(status, 0) + 1
                    slowest = max(slowest, took)
                    if faults:
                        wrong += 1
                        kept = Path(f"mutant-{family}-{number}-{name}")
                        kept.write_bytes(data)
                        print(f"WRONG {kept}: {'; '.join(faults)}\n    {' '.join(typed)[:300]}\n    {text.strip()[-400:]!r}", flush=True)
            print(json.dumps({"family": family, "mutants": share, "exit_codes": {str(code): codes[code] for code in sorted(codes, key=str)}, "slowest_s": round(slowest, 2)}), flush=True)
    print(json.dumps({"mutants": share * len(families), "wrong": wrong}))
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
