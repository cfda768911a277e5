#!/usr/bin/env python3
"""A study on HyperQueue: on this machine by itself, or on a server that is running.

    isostudy plan STUDY --json > plan.json
    scripts/workflow/submit_hyperqueue.py plan.json                            a server and a worker here
    scripts/workflow/submit_hyperqueue.py plan.json --server ~/.hq-server      a server that is running

It needs `pip install hyperqueue`. Batches that are done are not submitted again, so a run that was
killed goes on by the same line. It ends with 1 if a batch failed; batches.py status says why.
"""

import argparse
import os
import pathlib
import sys

import batches as plans

try:
    from hyperqueue import Client, Job, LocalCluster
    from hyperqueue.cluster import WorkerConfig
    from hyperqueue.ffi.protocol import ResourceRequest
except ImportError:
    sys.exit("submit_hyperqueue.py needs HyperQueue: pip install hyperqueue")

SCRIPT = str(pathlib.Path(__file__).resolve().parent / "batches.py")


def submit(client, batches, arguments):
    """One job with a task for each batch that is to be done, each after those that it needs."""
    job = Job(max_fails=None)
    tasks = {}
    for batch in batches:
        if batch.is_done():
            continue
        command = [sys.executable, SCRIPT, "run", arguments.plan, batch.name]
        command += ["--isostudy", arguments.isostudy, "--seconds", str(arguments.seconds)]
        tasks[batch.name] = job.program(
            command,
            cwd=os.getcwd(),
            name=batch.name,
            stdout=None,
            stderr=None,
            deps=[tasks[need.name] for need in batch.needs if need.name in tasks],
            # A timing has all cores of its worker.
            resources=ResourceRequest(cpus="all" if batch.exclusive else 1),
        )
    if not tasks:
        return True
    return client.wait_for_jobs([client.submit(job)], raise_on_error=False)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("plan")
    parser.add_argument("--server", help="folder of a running server [default: a server here]")
    parser.add_argument("--cores", type=int, help="cores of the worker here [default: all]")
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--isostudy", default="isostudy")
    arguments = parser.parse_args()
    batches = plans.read(arguments.plan, arguments.seconds)
    plans.forget(batches)
    # Its workers have no names that a plan could know.
    batches = plans.reachable(batches, {})
    if arguments.server:
        is_done = submit(Client(arguments.server), batches, arguments)
    else:
        with LocalCluster() as cluster:
            cluster.start_worker(WorkerConfig(cores=arguments.cores or os.cpu_count()))
            is_done = submit(cluster.client(), batches, arguments)
    plans.status(batches)
    sys.exit(0 if is_done else 1)


if __name__ == "__main__":
    main()
