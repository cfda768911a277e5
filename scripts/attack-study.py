#!/usr/bin/env python3
"""Takes disk, folder, process and clock away from a running study, and says what each came to.

Usage: scripts/attack-study.py ISOSTUDY [STUDY] [SEED]

STUDY is configs/quick.toml unless it is named. First the study runs undisturbed. Then:

- full disks: it runs on disks that are too small, from a fiftieth of what it needs to nearly all, and again when there is room.
- removed folders: its folder of results is removed at random moments, and it runs again.
- kills: it is killed at random moments, and runs again.
- a stopped clock: it runs under libfaketime (Debian's `faketime`), where no time passes.

A disturbed run must end within a minute more than an undisturbed one takes, without a panic, and with exit code 0 or 2. With 2 it
must name a file or folder. The run after it must end with exit code 0 and write the meshes, animations and pairs of the
undisturbed run, byte by byte. Exit 1 if one does not keep to it.
"""

import hashlib
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SAME = (".ply", ".obj", ".gif", ".mp4", ".webm")
CLOCK = "/usr/lib/x86_64-linux-gnu/faketime/libfaketimeMT.so.1"
MOMENTS = 8


def digests(results):
    files = [path for path in sorted(results.rglob("*")) if path.suffix in SAME and path.is_file()]
    return {str(path.relative_to(results)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


class Study:
    def __init__(self, isostudy, study):
        self.isostudy, self.study = isostudy, study

    def start(self, results, environment=None):
        words = [self.isostudy, "study", self.study, "--out", str(results)]
        return subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                errors="replace", env={**os.environ, **(environment or {})})

    def end(self, child, seconds):
        try:
            said, _ = child.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            child.kill()
            child.communicate()
            return None, "", [f"it still ran after {seconds:.0f} s"]
        faults = ["a panic"] * ("panicked" in said)
        if child.returncode not in (0, 2):
            faults.append(f"exit code {child.returncode}")
        return child.returncode, said, faults


def names_a_place(said, results):
    return str(results) in said or str(results.parent) in said


def on_a_disk(study, folder, kilobytes, seconds):
    """One run on a disk of this size, and one after the disk has grown. This process has a mount namespace of its own."""
    disk = folder / "disk"
    disk.mkdir(exist_ok=True)
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "none", str(disk)], check=True)
    try:
        results = disk / "results"
        code, said, faults = study.end(study.start(results), seconds)
        if code == 0:
            faults.append("it ended well on a disk that was too small")
        elif code == 2 and not ("No space left" in said and names_a_place(said, results)):
            faults.append(f"it did not say which file has no room: {said.strip()[-300:]!r}")
        subprocess.run(["mount", "-o", "remount,size=4g", str(disk)], check=True)
        code, said, more = study.end(study.start(results), seconds)
        faults += more + [f"the second run ended with {code}: {said.strip()[-300:]!r}"] * (code != 0)
        return digests(results), faults
    finally:
        subprocess.run(["umount", str(disk)], check=True)


def main():
    if "--on-disk" in sys.argv:
        isostudy, study, _, folder, kilobytes, seconds = sys.argv[1:]
        found, faults = on_a_disk(Study(isostudy, study), Path(folder), int(kilobytes), float(seconds))
        print(json.dumps({"digests": found, "faults": faults}))
        return
    isostudy = str(Path(sys.argv[1]).resolve())
    file = sys.argv[2] if len(sys.argv) > 2 else str(Path(__file__).resolve().parent.parent / "configs/quick.toml")
    chance = random.Random(int(sys.argv[3]) if len(sys.argv) > 3 else 1)
    study, failed = Study(isostudy, file), False

    def tell(attack, number, faults):
        nonlocal failed
        failed |= bool(faults)
        print(json.dumps({"attack": attack, "runs": number, "faults": faults}), flush=True)

    with tempfile.TemporaryDirectory() as root:
        folder = Path(root)
        results = folder / "undisturbed"
        begin = time.monotonic()
        code, said, faults = study.end(study.start(results), 3600)
        took = time.monotonic() - begin
        truth, limit = digests(results), took * 1.5 + 60
        kilobytes = sum(path.stat().st_size for path in results.rglob("*") if path.is_file()) >> 10
        tell("none", 1, faults + [f"exit code {code}: {said[-300:]!r}"] * (code != 0) + ["nothing was made"] * (not truth))
        print(json.dumps({"files": len(truth), "kilobytes": kilobytes, "seconds": round(took, 1)}), flush=True)

        faults, runs = [], 0
        unshare = next((words for words in (["unshare", "--mount"], ["unshare", "--mount", "--map-root-user"])
                        if subprocess.run([*words, "mount", "-t", "tmpfs", "none", "/mnt"], capture_output=True, check=False).returncode == 0), None)
        for share in (0.02, 0.1, 0.25, 0.4, 0.55, 0.7, 0.85, 0.95) if unshare else ():
            words = [*unshare, sys.executable, __file__, isostudy, file, "--on-disk", str(folder), str(int(kilobytes * share)), str(limit)]
            done = json.loads(subprocess.run(words, stdout=subprocess.PIPE, text=True, check=True).stdout)
            runs += 1
            faults += [f"at {share}: {fault}" for fault in done["faults"]]
            faults += [f"at {share}: other files"] * (done["digests"] != truth)
        tell("full disks", runs, faults if unshare else ["no mount namespace can be made here"])

        for attack in ("removed folders", "kills"):
            faults = []
            for number in range(MOMENTS):
                results = folder / f"{attack[:4]}{number}"
                child = study.start(results)
                moment = chance.uniform(0.02, 0.95) * took
                time.sleep(moment)
                if attack == "kills":
                    child.kill()
                    child.communicate()
                else:
                    if results.exists():
                        results.rename(folder / "removed")
                        shutil.rmtree(folder / "removed")
                    code, said, more = study.end(child, limit)
                    faults += [f"after {moment:.1f} s: {fault}" for fault in more]
                    if code == 2 and not names_a_place(said, results):
                        faults.append(f"after {moment:.1f} s: it named no place: {said.strip()[-300:]!r}")
                code, said, more = study.end(study.start(results), limit)
                faults += [f"after {moment:.1f} s, again: {fault}" for fault in more]
                faults += [f"after {moment:.1f} s, again: exit code {code}: {said.strip()[-300:]!r}"] * (code != 0)
                faults += [f"after {moment:.1f} s, again: other files"] * (digests(results) != truth)
                shutil.rmtree(results, ignore_errors=True)
            tell(attack, MOMENTS, faults)

        if Path(CLOCK).exists():
            results = folder / "stopped"
            stopped = {"LD_PRELOAD": CLOCK, "FAKETIME": "2026-01-01 00:00:00", "FAKETIME_NO_CACHE": "1"}
            code, said, faults = study.end(study.start(results, stopped), limit)
            print(json.dumps({"exit_code": code, "said": said.strip()[-600:]}), flush=True)
            faults += ["other files"] * (code == 0 and digests(results) != truth)
            tell("a stopped clock", 1, faults)
        else:
            tell("a stopped clock", 0, ["libfaketime is not installed"])
    sys.exit(failed)


if __name__ == "__main__":
    main()
