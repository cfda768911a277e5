#!/usr/bin/env python3
"""Attacks the server of the questionnaire, and says what each attack came to.

Usage: scripts/attack-server.py ISOSTUDY [STUDY]

Unless STUDY is named, it is the forms of configs/balanced.toml over the small animations of configs/quick.toml. The attacks:

- kills: 40 people answer while the server is killed 20 times. Every confirmed answer must be in the export exactly once, and
  99 of 100 confirmations of a server that runs must take less than 50 ms.
- tokens: four clients send 1,000 wrong tokens per second together. A right token must be answered within 100 ms.
- a full disk: the folder of the answers is on a disk of 8 MB, which is filled in the middle. The server must refuse and go on.
- a removed folder: the folder of the answers is removed in the middle. The server must refuse what follows, and the researcher's
  page must still have what it confirmed.

The full disk needs a mount namespace (`unshare --mount`, as root or with --map-root-user). The script says when it has none.
Exit 1 if an attack finds a fault.
"""

import http.client
import json
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

TOKEN = "a-token-for-this-attack"
PEOPLE = 40
KILLS = 20
WRONG_PER_SECOND = 1000
P99_MS = 50
TOKEN_MS = 100


class Server:
    """`isostudy serve`, started again as often as it is killed."""

    def __init__(self, isostudy, study, results, answers, prefix=()):
        self.words = [*prefix, isostudy, "serve", study, "--out", str(results), "--answers", str(answers), "--admin-token", TOKEN,
                      "--with-faults", "--sessions-per-address", "0"]
        self.port, self.child = 0, None
        self.start()

    def start(self):
        self.child = subprocess.Popen([*self.words, "--port", str(self.port)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                      text=True)
        said = []
        for line in self.child.stderr:
            said.append(line)
            if line.startswith("questionnaire"):
                self.port = int(line.split("http://")[1].strip().strip("/").split(":")[1])
                break
        else:
            raise SystemExit("the server did not start:\n" + "".join(said))
        # A full pipe must not stop the server.
        threading.Thread(target=lambda out: [None for _ in out], args=(self.child.stderr,), daemon=True).start()

    def kill(self):
        self.child.kill()
        self.child.wait()

    def ask(self, method, path, body=None, token=None, connection=None):
        """Status and text. With a connection, it is kept open."""
        own = connection or http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        headers = {"content-type": "application/json"} if body is not None else {}
        if token is not None:
            headers["authorization"] = f"Bearer {token}"
        try:
            own.request(method, path, body, headers)
            reply = own.getresponse()
            return reply.status, reply.read().decode()
        finally:
            if connection is None:
                own.close()

    def kept(self):
        """Participant and place of every answer in the export, to its choice."""
        status, text = self.ask("GET", "/api/admin/answers.csv", token=TOKEN)
        assert status == 200, text
        head, *lines = [line.split(",") for line in text.splitlines()]
        person, order, choice = head.index("participant"), head.index("order"), head.index("choice")
        rows = [((line[person], line[order]), line[choice]) for line in lines]
        return dict(rows), len(rows) - len(dict(rows))


class Person:
    """Somebody who answers one question after the other, and asks again until the server confirms."""

    def __init__(self, server, number, confirmed, latencies_ms):
        self.server, self.number, self.confirmed, self.latencies_ms = server, number, confirmed, latencies_ms
        self.refused = 0

    def begin(self, until):
        while time.monotonic() < until:
            try:
                status, text = self.server.ask("POST", "/api/sessions", "{}")
                if status == 200:
                    return json.loads(text)
            except OSError:
                pass
            except http.client.HTTPException:
                pass
            time.sleep(0.02)
        return None

    def answer_all(self, until, pause_s):
        session = self.begin(until)
        if session is None:
            return
        questions = session["form"]["questions"]
        first = len(session["form"]["training"]) + 1
        for place, stimulus in enumerate(questions):
            choice = ["L", "NP", "R"][(self.number + place) % 3]
            while time.monotonic() < until:
                body = json.dumps({"token": session["token"], "order": first + place, "stimulus": stimulus, "choice": choice, "rt_ms": 1500})
                begin = time.monotonic()
                try:
                    status, text = self.server.ask("POST", "/api/answers", body)
                except (OSError, http.client.HTTPException):
                    time.sleep(0.02)
                    continue
                if status == 200:
                    self.latencies_ms.append((time.monotonic() - begin) * 1e3)
                    self.confirmed[session["participant"], str(first + place)] = choice
                    break
                if status == 404 and place == 0:
                    # Nobody is written down before the first answer.
                    session = self.begin(until)
                    if session is None:
                        return
                    continue
                if status != 503:
                    raise SystemExit(f"an answer got {status}: {text}")
                self.refused += 1
                time.sleep(0.05)
            time.sleep(pause_s)


def crowd(server, seconds, pause_s, meanwhile):
    """People who answer while something happens; what was confirmed, the latencies, and how often the server refused."""
    confirmed, latencies_ms = {}, []
    people = [Person(server, number, confirmed, latencies_ms) for number in range(PEOPLE)]
    until = time.monotonic() + seconds
    threads = [threading.Thread(target=person.answer_all, args=(until, pause_s), daemon=True) for person in people]
    for thread in threads:
        thread.start()
    meanwhile()
    for thread in threads:
        thread.join()
    return confirmed, sorted(latencies_ms), sum(person.refused for person in people)


def compare(server, confirmed):
    kept, twice = server.kept()
    lost = [key for key, choice in confirmed.items() if kept.get(key) != choice]
    return [f"{len(lost)} confirmed answers are lost"] * bool(lost) + [f"{twice} answers are there twice"] * bool(twice)


def attack_by_kills(server):
    def kill_often():
        for _ in range(KILLS):
            time.sleep(0.4)
            server.kill()
            server.start()

    confirmed, latencies_ms, _ = crowd(server, 90, 0.1, kill_often)
    p99 = latencies_ms[len(latencies_ms) * 99 // 100]
    faults = compare(server, confirmed) + [f"p99 of {p99:.0f} ms"] * (p99 >= P99_MS)
    return {"confirmed": len(confirmed), "kills": KILLS, "median_ms": round(latencies_ms[len(latencies_ms) // 2], 1), "p99_ms": round(p99, 1)}, faults


def attack_by_tokens(server):
    clients, seconds = 4, 10
    statuses, end = [], time.monotonic() + seconds
    # A client that does not wait for replies: the server may answer wrong tokens as late as it likes.
    wrong_loop = f"""
import asyncio, time
async def one(number):
    try:
        reader, writer = await asyncio.open_connection("127.0.0.1", {server.port})
        writer.write(b"GET /api/admin/summary HTTP/1.1\\r\\nhost: localhost\\r\\nauthorization: Bearer wrong-token-%d\\r\\nconnection: close\\r\\n\\r\\n" % number)
        await writer.drain()
        await reader.read()
        writer.close()
    except OSError:
        pass
async def main():
    begin, sent, tasks = time.monotonic(), 0, set()
    while time.monotonic() - begin < {seconds}:
        while sent < (time.monotonic() - begin) * {WRONG_PER_SECOND // clients}:
            task = asyncio.create_task(one(sent))
            tasks.add(task)
            task.add_done_callback(tasks.discard)
            sent += 1
        await asyncio.sleep(0.005)
    print(sent)
asyncio.run(main())
"""
    attackers = [subprocess.Popen([sys.executable, "-c", wrong_loop], stdout=subprocess.PIPE, text=True) for _ in range(clients)]
    time.sleep(0.5)
    latencies_ms = []
    while time.monotonic() < end - 0.5:
        begin = time.monotonic()
        status, _ = server.ask("GET", "/api/admin/summary", token=TOKEN)
        latencies_ms.append((time.monotonic() - begin) * 1e3)
        statuses.append(status)
        time.sleep(0.05)
    sent = sum(int(attacker.communicate()[0]) for attacker in attackers)
    slowest = max(latencies_ms)
    faults = [f"a right token got {status}" for status in set(statuses) - {200}]
    faults += [f"a right token took {slowest:.0f} ms"] * (slowest >= TOKEN_MS)
    faults += [f"only {sent / seconds:.0f} wrong tokens per second were sent"] * (sent < 0.9 * WRONG_PER_SECOND * seconds)
    return {"wrong_per_s": round(sent / seconds), "right": len(statuses), "slowest_right_ms": round(slowest, 1)}, faults


def attack_by_full_disk(server, disk):
    def fill_and_free():
        time.sleep(2)
        filler = disk / "filler"
        try:
            with filler.open("wb", buffering=0) as file:
                while True:
                    file.write(bytes(4096))
        except OSError:
            pass
        time.sleep(4)
        filler.unlink()

    confirmed, _, refused = crowd(server, 90, 0.3, fill_and_free)
    whole = PEOPLE * 32
    faults = compare(server, confirmed) + ["nothing was refused"] * (refused == 0)
    faults += [f"only {len(confirmed)} of {whole} answers came through"] * (len(confirmed) < whole)
    return {"confirmed": len(confirmed), "refused": refused}, faults


def attack_by_removed_folder(server, answers):
    def remove():
        time.sleep(2)
        shutil.rmtree(answers)

    confirmed, _, refused = crowd(server, 15, 0.3, remove)
    faults = compare(server, confirmed) + ["nothing was refused"] * (refused == 0)
    return {"confirmed": len(confirmed), "refused": refused}, faults


def on_a_small_disk(isostudy, study, results, folder):
    """Runs the attack in a mount namespace of its own, where the folder is a disk of 8 MB."""
    disk = folder / "disk"
    disk.mkdir()
    words = [sys.executable, __file__, isostudy, study, "--on-disk", str(results), str(disk)]
    for unshare in (["unshare", "--mount"], ["unshare", "--mount", "--map-root-user"]):
        if subprocess.run([*unshare, "mount", "-t", "tmpfs", "none", str(disk)], capture_output=True, check=False).returncode == 0:
            mount = f'mount -t tmpfs -o size=8m none {disk} && exec "$@"'
            done = subprocess.run([*unshare, "sh", "-c", mount, "sh", *words], stdout=subprocess.PIPE, text=True, check=False)
            result = json.loads(done.stdout)
            return result["found"], result["faults"]
    return {"left_out": "no mount namespace can be made here"}, []


def small_study(folder):
    configs = Path(__file__).resolve().parent.parent / "configs"
    quick, balanced = (configs / "quick.toml").read_text(), (configs / "balanced.toml").read_text()
    path = folder / "study.toml"
    path.write_text(quick[: quick.index("[responses]")].replace('"cpu/', f'"{configs}/cpu/').replace('"../', f'"{configs.parent}/') + balanced[balanced.index("[forms]") :])
    return str(path)


def main():
    if "--on-disk" in sys.argv:
        isostudy, study, _, results, disk = sys.argv[1:]
        server = Server(isostudy, study, results, Path(disk, "answers"))
        try:
            found, faults = attack_by_full_disk(server, Path(disk))
        finally:
            server.kill()
        print(json.dumps({"found": found, "faults": faults}))
        return
    isostudy = str(Path(sys.argv[1]).resolve())
    failed = False
    with tempfile.TemporaryDirectory() as root:
        folder = Path(root)
        study = sys.argv[2] if len(sys.argv) > 2 else small_study(folder)
        results = folder / "results"
        subprocess.run([isostudy, "bundle", study, "--out", str(results), "--with-faults"], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for name in ("kills", "tokens", "a full disk", "a removed folder"):
            answers = folder / name.replace(" ", "-") / "answers"
            if name == "a full disk":
                found, faults = on_a_small_disk(isostudy, study, results, folder)
            else:
                server = Server(isostudy, study, results, answers)
                try:
                    if name == "kills":
                        found, faults = attack_by_kills(server)
                    elif name == "tokens":
                        found, faults = attack_by_tokens(server)
                    else:
                        found, faults = attack_by_removed_folder(server, answers)
                finally:
                    server.kill()
            print(json.dumps({"attack": name, **found, "faults": faults}), flush=True)
            failed |= bool(faults)
            shutil.rmtree(folder / name.replace(" ", "-"), ignore_errors=True)
    sys.exit(failed)


if __name__ == "__main__":
    main()
