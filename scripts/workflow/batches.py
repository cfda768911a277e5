#!/usr/bin/env python3
"""Batches of the jobs that `isostudy plan` lists: what a scheduler starts as one task.

    batches.py list PLAN            a line per batch: name, jobs, expected seconds, what is left to do
    batches.py run PLAN NAME        does the jobs of one batch, one after the other
    batches.py status PLAN          how many jobs are done, and the last words of those that failed

PLAN is the JSON of `isostudy plan STUDY --json`. Short jobs of one kind share a batch until they are
expected to take --seconds together (60). A timing is a batch alone, for it wants a whole node.

A batch that is done leaves a marker in OUT/.workflow/, named after the digests of its jobs. So a
changed study has other markers, and what did not change is not started again. What a batch says is in
OUT/.workflow/log/.
"""

import argparse
import hashlib
import json
import os
import pathlib
import subprocess
import sys

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
        self.marker = str(folder(plan) / f"{self.name}.done")
        # The batches that come first, filled in when all are known.
        self.needs = []


def expected(job):
    return UNKNOWN_S if job["expected_s"] is None else job["expected_s"]


def folder(plan):
    return pathlib.Path(plan["out"]) / ".workflow"


def read(path, seconds):
    """All batches, each after those that it needs."""
    plan = json.loads(pathlib.Path(path).read_text())
    if plan["schema"] != 1:
        sys.exit(f"{path}: schema {plan['schema']}; this script knows 1")
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
    done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    said = done.stdout.decode(errors="replace")
    # A report whose check failed is one: it says what differs, or what was left out.
    is_done = done.returncode == 0 or is_report and done.returncode == 1
    log(batch).write_text(said + ("" if is_done else f"failed: exit code {done.returncode}\n"))
    if not is_done:
        sys.stderr.write(f"{batch.name}: {said}")
        return done.returncode if done.returncode > 0 else 1
    pathlib.Path(batch.marker).touch()
    return 0


def status(batches):
    done = sum(len(batch.jobs) for batch in batches if os.path.exists(batch.marker))
    print(f"{done} of {sum(len(batch.jobs) for batch in batches)} jobs done")
    for batch in batches:
        path = log(batch)
        said = path.read_text() if path.exists() and not os.path.exists(batch.marker) else ""
        if "\nfailed: " in "\n" + said:
            words = [line for line in said.splitlines() if line.startswith("isostudy: ")]
            print(f"{batch.name}: {words[-1] if words else said.splitlines()[-1]}")


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
            state = "done" if os.path.exists(batch.marker) else "to do"
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
