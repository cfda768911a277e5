#!/usr/bin/env python3
"""Batches of the jobs that `isostudy plan` lists: what a scheduler starts as one task.

    batches.py list PLAN            a line per batch: name, jobs, expected seconds, what is left to do
    batches.py run PLAN NAME        does the jobs of one batch, in one process
    batches.py status PLAN          how many jobs are done, and the last words of those that are not

PLAN is the JSON of `isostudy plan STUDY --json`. Short jobs of one kind share a batch until they are
expected to take --seconds together (60). A timing is a batch alone, for it wants a whole node.

A batch that is done leaves a marker in OUT/.workflow/, named after the digests of its jobs. Markers of
other plans go, and so do those whose files are gone. The report always runs, for it checks everything.
What a job was first expected to take is kept in OUT/.workflow/costs.json, so that another plan has the
same batches of what did not change. What a batch says is in OUT/.workflow/log/.
"""

import argparse
import hashlib
import json
import os
import pathlib
import socket
import subprocess
import sys
import time

# Of a job that a program makes, nobody knows how long it takes.
UNKNOWN_S = 60.0
UNKNOWN_BYTES = 4 << 30


class Batch:
    def __init__(self, plan, jobs):
        self.plan, self.jobs = plan, jobs
        digest = hashlib.sha256("".join(job["digest"] for job in jobs).encode()).hexdigest()
        first = jobs[0]["id"].replace("/", ".")
        self.name = f"{first}-{digest[:12]}"
        self.seconds = sum(expected(job) for job in jobs)
        self.bytes = max(job["expected_bytes"] or UNKNOWN_BYTES for job in jobs)
        self.exclusive = any(job["exclusive"] for job in jobs)
        # A timing is a batch alone, and may be for one machine.
        self.machine = jobs[0]["machine"]
        self.marker = str(folder(plan) / f"{self.name}.done")
        # The batches that come first, filled in when all are known.
        self.needs = []

    def is_done(self):
        return os.path.exists(self.marker)


def expected(job):
    return UNKNOWN_S if job["expected_s"] is None else job["expected_s"]


def with_first_costs(plan):
    """Puts what each job was first expected to take into a plan: trials differ from one plan to the next."""
    path = folder(plan) / "costs.json"
    try:
        known = json.loads(path.read_text())
    except (FileNotFoundError, json.JSONDecodeError):
        known = {}
    now = {job["digest"]: known.get(job["digest"], job["expected_s"]) for job in plan["jobs"]}
    for job in plan["jobs"]:
        job["expected_s"] = now[job["digest"]]
    if now.keys() - known.keys():
        path.parent.mkdir(parents=True, exist_ok=True)
        written = path.with_suffix(f".{os.getpid()}")
        written.write_text(json.dumps(known | now))
        os.replace(written, path)


def reachable(batches, machines):
    """The batches that a scheduler can place. A job of a machine that it cannot choose is left to whoever sits there: elsewhere, its times
    would have a wrong name. The report then says that this machine has not measured."""
    placed = [batch for batch in batches if batch.machine is None or batch.machine in machines]
    for batch in placed:
        batch.needs = [need for need in batch.needs if need in placed]
    for batch in batches:
        if batch not in placed:
            print(f"{batch.jobs[0]['id']}: left to machine {batch.machine}", file=sys.stderr)
    return placed


def forget(batches):
    """Removes the markers of other plans, and those of batches whose files are gone."""
    plan = batches[0].plan
    out = pathlib.Path(plan["out"])

    def is_there(job):
        left_out = out / "failed" / (job["id"].replace("/", ".") + ".json")
        return left_out.exists() or all((out / path).exists() for path in job["outputs"])

    is_report = lambda batch: batch.jobs[0]["kind"] == "report"
    kept = {batch.marker for batch in batches if not is_report(batch) and all(map(is_there, batch.jobs))}
    for marker in folder(plan).glob("*.done"):
        if str(marker) not in kept:
            marker.unlink(missing_ok=True)


def folder(plan):
    return pathlib.Path(plan["out"]) / ".workflow"


def read(path, seconds):
    """All batches, each after those that it needs."""
    plan = json.loads(pathlib.Path(path).read_text())
    if plan["schema"] != 1:
        sys.exit(f"{path}: schema {plan['schema']}; this script knows 1")
    with_first_costs(plan)
    batches, jobs = [], []

    def close():
        if jobs:
            batches.append(Batch(plan, list(jobs)))
            jobs.clear()

    for job in plan["jobs"]:
        if jobs and (job["kind"] != jobs[-1]["kind"] or job["exclusive"]):
            close()
        jobs.append(job)
        if job["exclusive"] or sum(map(expected, jobs)) >= seconds:
            close()
    close()
    of = {job["id"]: batch for batch in batches for job in batch.jobs}
    for batch in batches:
        needs = {of[need].name: of[need] for job in batch.jobs for need in job["needs"]}
        batch.needs = [needs[name] for name in sorted(needs) if name != batch.name]
    return batches


def log(batch):
    return folder(batch.plan) / "log" / (batch.name + ".txt")


def run(batch, program):
    """Does the jobs of a batch. One that failed ends it, and what was done stays."""
    plan = batch.plan
    (folder(plan) / "log").mkdir(parents=True, exist_ok=True)
    # One process for all of them: what is found of an object serves all of its meshes.
    is_report = batch.jobs[0]["kind"] == "report"
    command = [program, "job", plan["study"], "--out", plan["out"]]
    command += ["--threads", "0" if batch.exclusive or is_report else "1"]
    command += os.environ.get("ISOSTUDY_JOB_OPTIONS", "").split()
    command += ["--digests", ",".join(job["digest"] for job in batch.jobs), *(job["id"] for job in batch.jobs)]
    host = socket.gethostname()
    log(batch).write_text(f"begun {time.strftime('%Y-%m-%d %H:%M:%S')} on {host}, and not ended\n")
    try:
        done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    except OSError as error:
        log(batch).write_text(f"isostudy: {program}: {error.strerror}\nfailed on {host}\n")
        sys.exit(f"{program}: {error.strerror}")
    said = done.stdout.decode(errors="replace")
    # A report whose check failed is one: it says what differs, or what was left out.
    is_done = done.returncode == 0 or is_report and done.returncode == 1
    log(batch).write_text(said + ("" if is_done else f"failed with exit code {done.returncode} on {host}\n"))
    if not is_done:
        sys.stderr.write(f"{batch.name}: {said}")
        return done.returncode if done.returncode > 0 else 1
    pathlib.Path(batch.marker).touch()
    return 0


def status(batches):
    done = sum(len(batch.jobs) for batch in batches if batch.is_done())
    print(f"{done} of {sum(len(batch.jobs) for batch in batches)} jobs done")
    for batch in batches:
        if not batch.is_done() and log(batch).exists():
            said = log(batch).read_text().splitlines()
            words = [line for line in said if line.startswith("isostudy: ")]
            print(f"{batch.name}: {(words or said or ['no word'])[-1]}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("verb", choices=["list", "run", "status"])
    parser.add_argument("plan")
    parser.add_argument("name", nargs="?")
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--isostudy", default="isostudy", help="the program [default: the one on the path]")
    arguments = parser.parse_args()
    batches = read(arguments.plan, arguments.seconds)
    if arguments.verb == "list":
        for batch in batches:
            state = "done" if batch.is_done() else "to do"
            print(f"{batch.name}\t{len(batch.jobs)}\t{batch.seconds:.1f}\t{state}")
    elif arguments.verb == "status":
        status(batches)
    else:
        found = [batch for batch in batches if batch.name == arguments.name]
        if not found:
            sys.exit(f"{arguments.name}: is no batch of {arguments.plan}; `batches.py list` has them")
        sys.exit(run(found[0], arguments.isostudy))


if __name__ == "__main__":
    main()
