"""A program that does what its argument says, mostly wrong. Needs Python alone."""

import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time

PLAN = sys.argv[1]


def say(line, end="\n"):
    sys.stdout.write((line if isinstance(line, str) else json.dumps(line)) + end)
    sys.stdout.flush()


def linger():
    """Something that this program started, which outlives it and holds its output open."""
    child = subprocess.Popen(["sleep", "1000"])
    with open("lingering", "w") as file:
        file.write(str(child.pid))


def take(megabytes):
    taken = bytearray(megabytes << 20)
    for place in range(0, len(taken), 4096):
        taken[place] = 1
    return taken


def work(seconds):
    """So many seconds of this process's CPU time."""
    begin = time.process_time()
    while time.process_time() - begin < seconds:
        pass


def write_mesh(path, rows=("0 0 0", "1 0 0", "0 1 0"), corners="0 1 2"):
    with open(path, "w") as file:
        file.write(
            f"ply\nformat ascii 1.0\nelement vertex {len(rows)}\nproperty float x\nproperty float y\nproperty float z\n"
            "element face 1\nproperty list uchar uint vertex_indices\nend_header\n"
        )
        file.write("\n".join(rows) + f"\n3 {corners}\n")


def start():
    if os.listdir(".") or os.path.realpath(os.environ["TMPDIR"]) != os.path.realpath("."):
        sys.exit("not an empty folder of its own")
    if PLAN == "slow-start":
        time.sleep(0.3)
    elif PLAN == "hang-at-start":
        time.sleep(1000)
    elif PLAN == "fail-at-start":
        say({"failed": "No module named 'nowhere'"})
        return sys.exit(0)
    elif PLAN == "crash-at-start":
        sys.exit("a last word")
    elif PLAN == "no-version":
        say({"ready": {"name": "planted"}})
    elif PLAN == "no-name":
        say({"ready": {"name": " ", "version": "1.0"}})
    elif PLAN == "memory-at-start":
        taken = take(400)
        time.sleep(1000)
        del taken
    elif PLAN == "noisy":
        sys.stderr.write("a line of noise\n" * 100_000 + "the very last words\n")
        sys.exit(1)
    say({"ready": {"name": "planted", "version": "1.0", "note": PLAN}})


def answer(request):
    done = {"id": request["id"], "extraction_s": 1e-6, "callback_s": 0, "peak_bytes": 1000, "vertices": 3, "triangles": 1}
    mesh = request["mesh"]
    if mesh and PLAN not in ("no-mesh", "pipe"):
        write_mesh(mesh)
    if PLAN == "hang":
        time.sleep(1000)
    elif PLAN == "crash":
        sys.stderr.write("words before the end\n")
        os._exit(3)
    elif PLAN == "signal":
        os.kill(os.getpid(), signal.SIGSEGV)
    elif PLAN == "busy":
        # In a thread that ends, in nobody, in a process that ends.
        if request["id"] == 1:
            thread = threading.Thread(target=work, args=(0.3,))
            thread.start()
            thread.join()
        elif request["id"] == 2:
            time.sleep(0.3)
        else:
            busy = "import time\nwhile time.process_time() < 0.3: pass"
            subprocess.run([sys.executable, "-c", busy], check=True)
    elif PLAN == "linger":
        linger()
    elif PLAN == "linger-and-crash":
        linger()
        os._exit(5)
    elif PLAN == "memory":
        taken = take(400)
        time.sleep(1000)
        del taken
    elif PLAN == "memory-of-a-child":
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([sys.executable, __file__, "memory-at-start"], cwd=folder, env={**os.environ, "TMPDIR": folder})
    elif PLAN == "fail-once" and request["id"] == 1:
        return say({"id": 1, "failed": "out of luck"})
    elif PLAN == "garbage":
        return say("Extracting 1 of 1 ... done")
    elif PLAN == "list":
        return say([1, 2])
    elif PLAN == "huge-line":
        return say("x" * 1_000_000)
    elif PLAN == "no-line":
        while True:
            say("x" * 1000, end="")
    elif PLAN == "cut-line":
        say('{"id": 1, "extrac', end="")
        os._exit(0)
    elif PLAN == "piecewise":
        line = json.dumps(done)
        for begin in range(0, len(line), 20):
            say(line[begin : begin + 20], end="")
            time.sleep(0.02)
        return say("")
    elif PLAN == "close":
        os.close(1)
        time.sleep(1000)
    elif PLAN == "other-id":
        done["id"] += 6
    elif PLAN == "no-id":
        del done["id"]
    elif PLAN == "other-key":
        done["extraction_sec"] = done.pop("extraction_s")
    elif PLAN == "no-seconds":
        for key in ("extraction_s", "callback_s", "peak_bytes"):
            del done[key]
    elif PLAN == "nan-seconds":
        done["extraction_s"] = float("nan")
    elif PLAN == "zero-seconds":
        done["extraction_s"] = 0.0
    elif PLAN == "negative-seconds":
        done["extraction_s"] = -0.001
    elif PLAN == "milliseconds":
        time.sleep(0.02)
        done["extraction_s"] = 20.0
    elif PLAN == "both-seconds":
        # Long beside what a loaded machine adds: with as much again, both would fit.
        time.sleep(0.5)
        done["extraction_s"] = done["callback_s"] = 0.5
    elif PLAN == "negative-bytes":
        done["peak_bytes"] = -1
    elif PLAN == "twice":
        say(done)
    elif PLAN == "ahead":
        say(json.dumps(done) + "\n" + json.dumps(done | {"id": done["id"] + 1}))
        return None
    elif PLAN == "other-counts":
        done["triangles"] = 2
    elif PLAN == "no-triangles":
        done["vertices"] = done["triangles"] = 0
    elif PLAN == "pipe" and mesh:
        os.mkfifo(mesh)
    elif PLAN == "index" and mesh:
        write_mesh(mesh, corners="0 1 3")
    elif PLAN == "nan" and mesh:
        write_mesh(mesh, rows=("0 0 0", "nan 0 0", "0 1 0"))
    elif PLAN == "in-cells" and mesh:
        write_mesh(mesh, rows=("0 0 0", "20 0 0", "0 1 0"))
    elif PLAN == "cut-mesh" and mesh:
        with open(mesh, "r+") as file:
            file.truncate(os.path.getsize(mesh) - 8)
    elif PLAN == "large-mesh" and mesh:
        with open(mesh, "r+") as file:
            file.truncate(1 << 30)
    say(done)


start()
if PLAN == "never-read":
    time.sleep(1000)
for line in sys.stdin:
    answer(json.loads(line))
if PLAN == "no-end":
    time.sleep(1000)
if PLAN == "bad-end":
    sys.exit(4)
