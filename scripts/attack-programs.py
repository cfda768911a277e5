#!/usr/bin/env python3
"""Attacks the command with bad programs, as methods of a study and as binaries of `bench ab`, and says what each came to.

Usage: scripts/attack-programs.py ISOSTUDY [FILTER]

For each program: the exit code must be 1 or 2 (0 for those that are no attack), the time below the limits, the memory of the
command below 300 MB, and no process and no temporary folder may stay. Exit 1 if one does not keep to it.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

LIMIT_S = 2
SLACK_S = 40
MEMORY_BYTES = 300 << 20
READY = '{"ready": {"name": "x", "version": "1"}}'
DONE = '{"id": 1, "extraction_s": 1e-6, "vertices": 3, "triangles": 1}'
BENCH_READY = '{"ready": null}'

# What is done instead of a word, by its name: Python, with `say` for a line.
DEEDS = {
    "hangs": "time.sleep(1000)",
    "hangs in a loop": "while True: pass",
    "ignores SIGTERM": "[signal.signal(s, signal.SIG_IGN) for s in (1, 2, 15)]; time.sleep(1000)",
    "stops itself": "os.kill(os.getpid(), signal.SIGSTOP); time.sleep(1000)",
    "floods stdout": "flood(1, b'x' * 65536)",
    "floods stdout with lines": "flood(1, b'x\\n' * 32768)",
    "floods stdout with answers": "flood(1, DONE.encode() + b'\\n')",
    "floods stdout with zeros": "flood(1, bytes(65536))",
    "floods stderr": "flood(2, b'x' * 65536)",
    "floods stderr with lines": "flood(2, b'noise\\n' * 10000)",
    "floods both": "threading.Thread(target=flood, args=(2, b'x' * 65536)).start(); flood(1, b'y' * 65536)",
    "closes stdout": "os.close(1); time.sleep(1000)",
    "closes all three": "[os.close(i) for i in range(3)]; time.sleep(1000)",
    "closes stdin": "os.close(0); time.sleep(1000)",
    "half a line": "out(DONE[:20]); time.sleep(1000)",
    "half a line and an end": "out(DONE[:20]); os._exit(0)",
    "ends": "os._exit(0)",
    "ends with 3": "os._exit(3)",
    "is killed": "os.kill(os.getpid(), 9)",
    "crashes": "os.kill(os.getpid(), signal.SIGSEGV)",
    "aborts": "os.abort()",
    "no JSON": "say('hello')",
    "an empty line": "say('')",
    "only spaces": "say(' ' * 1000)",
    "an array": "say('[' * 60000)",
    "deep objects": "say('{\"a\":' * 10000)",
    "null": "say('null')",
    "a number": "say('1e999')",
    "no UTF-8": "os.write(1, b'\\xff\\xfe\\n'); time.sleep(1000)",
    "nul bytes": "os.write(1, bytes(100) + b'\\n'); time.sleep(1000)",
    "escapes": "say('\\x1b[2J\\x1b[H forged'); time.sleep(1000)",
    "escapes on stderr": "os.write(2, b'\\x1b[2J\\rforged\\n'); os._exit(1)",
    "huge id": "say(DONE.replace('\"id\": 1', '\"id\": 99999999999999999999999'))",
    "huge count": "say(DONE.replace('3', '1' * 400))",
    "counts of u64": "say(DONE.replace('3', '18446744073709551615'))",
    "negative count": "say(DONE.replace('3', '-3'))",
    "seconds of zero": "say(DONE.replace('1e-6', '0.0'))",
    "seconds of minus zero": "say(DONE.replace('1e-6', '-0.0'))",
    "seconds of 1e308": "say(DONE.replace('1e-6', '1e308'))",
    "seconds of 1e999": "say(DONE.replace('1e-6', '1e999'))",
    "seconds of -1": "say(DONE.replace('1e-6', '-1'))",
    "seconds as text": "say(DONE.replace('1e-6', '\"1\"'))",
    "a failure of 60 kB": "say(json.dumps({'failed': 'x' * 60000}))",
    "a failure with escapes": "say(json.dumps({'failed': '\\x1b[2K\\rall is well'}))",
    "an unknown key": "say('{\"other\": 1}')",
    "the same key twice": "say(DONE[:-1] + ', \"id\": 1}')",
    "a child that hangs": "subprocess.Popen(['sleep', '1000']); time.sleep(1000)",
    "a child that holds stdout": "subprocess.Popen(['sleep', '1000']); os._exit(0)",
    "a child in a session of its own": "subprocess.Popen(['sleep', '1000'], start_new_session=True); time.sleep(1000)",
    "a child in a session of its own, and an end": "subprocess.Popen(['sleep', '1000'], start_new_session=True); os._exit(0)",
    "a daemon": "daemon(); os._exit(0)",
    "a daemon beside": "daemon(); time.sleep(1000)",
    "twenty children": "[subprocess.Popen(['sleep', '1000']) for _ in range(20)]; time.sleep(1000)",
    "forks that fork": "tree(4); time.sleep(1000)",
    "forks that fork in sessions": "tree(4, True); time.sleep(1000)",
    "a zombie": "subprocess.Popen(['true']); time.sleep(1000)",
    "memory at once": "b = b'x' * (3 << 30); time.sleep(1000)",
    "memory bit by bit": "b = []\nwhile True: b.append(b'x' * (8 << 20)); time.sleep(.01)",
    "memory in a child": "subprocess.Popen([sys.executable, '-c', 'b = b\"x\" * (600 << 20); import time; time.sleep(1000)']); time.sleep(1000)",
    "memory in a session": "subprocess.Popen([sys.executable, '-c', 'b = b\"x\" * (600 << 20); import time; time.sleep(1000)'], start_new_session=True); time.sleep(1000)",
    "removes its folder": "import shutil; shutil.rmtree(os.getcwd()); time.sleep(1000)",
    "makes its folder read-only": "os.chmod(os.getcwd(), 0o500); time.sleep(1000)",
    "a link in its folder": "os.symlink('/', 'root'); os._exit(1)",
    "a pipe in its folder": "os.mkfifo('mesh.ply'); time.sleep(1000)",
    "a thousand files": "[open(str(i), 'w') for i in range(1000)]; time.sleep(1000)",
    "signals its parent's group": "os.killpg(os.getpgrp(), signal.SIGTERM); time.sleep(1000)",
}
# Answers with a mesh that is none, after a good start.
MESHES = {
    "no mesh": "pass",
    "an empty mesh": "open(MESH, 'w').close()",
    "a pipe as mesh": "os.mkfifo(MESH)",
    "a folder as mesh": "os.mkdir(MESH)",
    "a device as mesh": "os.symlink('/dev/zero', MESH)",
    "a link to a mesh that grows": "os.symlink('/proc/self/mem', MESH)",
    "a header alone": "open(MESH, 'w').write('ply\\nformat ascii 1.0\\n')",
    "a header without end": "open(MESH, 'w').write('ply\\nformat ascii 1.0\\n' + 'comment x' * 10_000_000)",
    "four billion vertices": "open(MESH, 'w').write('ply\\nformat binary_little_endian 1.0\\nelement vertex 4000000000\\nproperty float x\\nproperty float y\\nproperty float z\\nend_header\\n')",
    "a sparse terabyte": "os.truncate(os.open(MESH, os.O_CREAT | os.O_RDWR), 1 << 40) if 0 else os.ftruncate(os.open(MESH, os.O_CREAT | os.O_RDWR), 1 << 40)",
    "NaN": "ply('nan 0 0', '3 0 1 2')",
    "infinity": "ply('inf 0 0', '3 0 1 2')",
    "far away": "ply('1e30 0 0', '3 0 1 2')",
    "an index out of range": "ply('0 0 0', '3 0 1 7')",
    "a polygon of 4 billion": "ply('0 0 0', '4000000000 0 1 2')",
}
LANGUAGE = f"""
import json, os, signal, subprocess, sys, threading, time
READY, DONE, BENCH = {READY!r}, {DONE!r}, {BENCH_READY!r}
def out(text): sys.stdout.write(text); sys.stdout.flush()
def say(text): out(text + "\\n")
def flood(to, what):
    while True: os.write(to, what)
def daemon():
    if os.fork() == 0:
        os.setsid()
        if os.fork() == 0:
            time.sleep(1000)
        os._exit(0)
    time.sleep(.3)
def tree(depth, sessions=False):
    for _ in range(2):
        if depth and os.fork() == 0:
            if sessions: os.setsid()
            tree(depth - 1, sessions)
            time.sleep(1000)
def ply(first, face):
    open(MESH, "w").write("ply\\nformat ascii 1.0\\nelement vertex 3\\nproperty float x\\nproperty float y\\nproperty float z\\n"
        f"element face 1\\nproperty list uchar uint vertex_indices\\nend_header\\n{{first}}\\n1 0 0\\n0 1 0\\n{{face}}\\n")
"""


def attacks():
    """Kind, name and source of each."""
    for name, deed in DEEDS.items():
        yield "method", f"at the start: {name}", deed
    for name, deed in DEEDS.items():
        yield "method", f"when asked: {name}", f"say(READY)\nrequest = json.loads(sys.stdin.readline())\n{deed}"
    for name, deed in MESHES.items():
        yield "method", name, f"say(READY)\nrequest = json.loads(sys.stdin.readline()); MESH = request['mesh']\n{deed}\nsay(DONE)"
    for name, deed in DEEDS.items():
        yield "binary", f"at the start: {name}", deed
    for name, deed in DEEDS.items():
        yield "binary", f"when asked: {name}", f"say(BENCH)\nsys.stdin.readline()\n{deed}"
    if shutil.which("bwrap"):
        for name, deed in DEEDS.items():
            yield "sandboxed", f"when asked: {name}", f"say(READY)\nrequest = json.loads(sys.stdin.readline())\n{deed}"


def study(folder, isostudy):
    subprocess.run([isostudy, "new", "my"], cwd=folder, check=True, capture_output=True)
    path = folder / "my/study.toml"
    lines = path.read_text().splitlines()
    number = next(i for i, line in enumerate(lines) if line.startswith("recipe = "))
    own = list(lines)
    own[number] = 'recipe = { kind = "program", command = ["python3", "./attack.py"], time_limit_s = %d, memory_gib = 0.4 }' % LIMIT_S
    (folder / "my/attacked.toml").write_text("\n".join(own))
    valid = subprocess.run([isostudy, "validate", "my/study.toml"], cwd=folder, check=True, capture_output=True, text=True)
    return valid.stdout.split()[0]


def alive(mark):
    """Processes that have the mark in their environment, which every program of this attack inherits."""
    found = []
    for process in filter(str.isdigit, os.listdir("/proc")):
        try:
            if mark.encode() in Path("/proc", process, "environ").read_bytes():
                found.append(process)
        except OSError:
            pass
    return found


def main():
    isostudy, only = str(Path(sys.argv[1]).resolve()), sys.argv[2] if len(sys.argv) > 2 else ""
    wrong, count, slowest, largest, worst_panic = [], 0, 0.0, 0, 0
    with tempfile.TemporaryDirectory() as root:
        folder = Path(root)
        (folder / "tmp").mkdir()
        first = study(folder, isostudy)
        for kind, name, source in attacks():
            if only not in f"{kind} {name}":
                continue
            count += 1
            mark = f"ATTACK={os.getpid()}-{count}"
            environment = {**os.environ, "TMPDIR": str(folder / "tmp"), "XDG_STATE_HOME": str(folder / "state"), "ATTACK": mark[7:]}
            text = LANGUAGE + source + "\ntime.sleep(1000)\n"
            if kind != "binary":
                (folder / "my/attack.py").write_text(text)
                words = ["extract", "my/attacked.toml", "--out", "out", "--only", first, "--allow-programs"]
                words += ["--sandbox"] * (kind == "sandboxed")
            else:
                (folder / "binary").write_text("#!/usr/bin/env python3" + text)
                (folder / "binary").chmod(0o755)
                words = ["bench", "ab", "./binary", isostudy, "my/study.toml", "--out", "out", "--time-limit", str(LIMIT_S), "--seconds", "1", "--only", first]
            begin = time.monotonic()
            said = tempfile.TemporaryFile()
            child = subprocess.Popen([isostudy, *words], cwd=folder, env=environment, stdout=said, stderr=said, stdin=subprocess.DEVNULL)
            peak, status = 0, None
            while time.monotonic() - begin < LIMIT_S * 3 + SLACK_S:
                try:
                    lines = Path("/proc", str(child.pid), "status").read_text().splitlines()
                    peak = max([peak, *(1024 * int(line.split()[1]) for line in lines if line.startswith("VmHWM"))])
                except OSError:
                    pass
                status = child.poll()
                if status is not None:
                    break
                time.sleep(0.02)
            if status is None:
                child.kill()
                child.wait()
            took = time.monotonic() - begin
            time.sleep(0.1)
            left = alive(mark)
            folders = [path.name for path in (folder / "tmp").iterdir()]
            said.seek(0)
            words = said.read().decode(errors="replace")
            faults = []
            if status not in (1, 2):
                faults.append(f"exit {status}")
            if left:
                faults.append(f"processes left: {left}")
                for process in left:
                    subprocess.run(["kill", "-9", process], check=False, capture_output=True)
            if folders:
                faults.append(f"folders left: {folders}")
                subprocess.run(["rm", "-rf", *[str(folder / "tmp" / name) for name in folders]], check=False)
            if peak > MEMORY_BYTES:
                faults.append(f"{peak >> 20} MB")
            if "panicked" in words:
                faults.append("a panic")
            if any(ord(c) < 32 and c not in "\n\t" for c in words):
                faults.append("a control character in what it said")
            if len(words) > 200_000:
                faults.append(f"{len(words)} bytes said")
            slowest, largest = max(slowest, took), max(largest, peak)
            if faults:
                wrong.append(name)
                print(f"WRONG {kind}: {name}: {'; '.join(faults)}\n    {words.strip()[-400:]!r}", flush=True)
    print(json.dumps({"attacks": count, "wrong": len(wrong), "slowest_s": round(slowest, 1), "largest_mb": largest >> 20}))
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
