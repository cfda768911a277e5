#!/usr/bin/env python3
"""The part of scripts/test-cluster.sh that starts Slurm, hurts it and compares: see there."""

import hashlib
import json
import os
import pathlib
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Of about 60 tasks, with the expected seconds of each that this study has.
CANCELLED, AT_ONCE, SECONDS = 5, 2, 0.08
LIMIT_S = 900


class Slurm:
    """A controller and a node on this machine, in a folder of their own."""

    def __init__(self, folder):
        self.folder, self.running = folder, []
        for name in ["state", "spool", "log"]:
            (folder / name).mkdir()
        host = socket.gethostname().split(".")[0]
        self.ports = [free_port(), free_port()]
        (folder / "slurm.conf").write_text(
            f"""ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={self.ports[0]}
SlurmdPort={self.ports[1]}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CryptoType=crypto/munge
SlurmUser=root
SlurmdUser=root
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
MpiDefault=none
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/log/slurmctld
SlurmdLogFile={folder}/log/slurmd
SchedulerParameters=sched_interval=1,batch_sched_delay=0
MinJobAge=3600
NodeName={host} NodeAddr=127.0.0.1 CPUs={os.cpu_count()} RealMemory={memory_mb()} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP OverSubscribe=NO
"""
        )
        key = folder / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o600)
        self.env = {**os.environ, "SLURM_CONF": str(folder / "slurm.conf")}
        munged = ["munged", "--foreground", "--force", f"--socket={folder}/munge.socket", f"--key-file={key}"]
        munged += [f"--pid-file={folder}/munged.pid", f"--log-file={folder}/log/munged", f"--seed-file={folder}/seed"]
        self.start(munged)
        time.sleep(1)
        self.start(["slurmd", "-D", "-N", host])
        self.controller = self.start(["slurmctld", "-D"])

    def start(self, command):
        log = open(self.folder / "log" / (pathlib.Path(command[0]).name + ".out"), "ab")
        process = subprocess.Popen(command, env=self.env, stdout=log, stderr=log, start_new_session=True)
        self.running.append(process)
        return process

    def stop_controller(self):
        # It saves which tasks there are. Killed, it would give their numbers to others.
        self.controller.terminate()
        self.controller.wait()

    def start_controller(self):
        self.controller = self.start(["slurmctld", "-D"])

    def say(self, *command):
        done = subprocess.run(command, env=self.env, capture_output=True, text=True)
        return done.stdout

    def has_node(self):
        """Waits for the node, at most half a minute."""
        until = time.time() + 30
        while time.time() < until:
            if any(state in self.say("sinfo", "-h", "-o", "%T") for state in ["idle", "mixed", "allocated"]):
                return True
            time.sleep(0.2)
        return False

    def stop(self):
        for process in reversed(self.running):
            process.terminate()
        for process in self.running:
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()


def memory_mb():
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // (1 << 20)


def free_port():
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]


def digests(out):
    """Of every file of the results, but what a scheduler keeps there."""
    found = {}
    for path in sorted(out.rglob("*")):
        name = path.relative_to(out).as_posix()
        if path.is_file() and not name.startswith((".stages/", ".workflow/")):
            found[name] = hashlib.sha256(path.read_bytes()).hexdigest()
    return found


def main():
    isostudy, env, seed = sys.argv[1], pathlib.Path(sys.argv[2]), int(sys.argv[3])
    draw = random.Random(seed)
    folder = pathlib.Path(tempfile.mkdtemp(prefix="isostudy-cluster-"))
    study, whole, out = "configs/quick.toml", folder / "whole", folder / "out"
    os.chdir(ROOT)
    one_run = subprocess.run([isostudy, "study", study, "--out", whole], capture_output=True, text=True)
    if one_run.returncode > 1:
        sys.exit(one_run.stderr)
    (out / ".stages").mkdir(parents=True)
    shutil.copytree(whole / "bench/short", out / "bench/short")
    shutil.copy(whole / ".stages/bench.short.json", out / ".stages")
    plan = folder / "plan.json"
    plan.write_text(subprocess.run([isostudy, "plan", study, "--out", out, "--json"], capture_output=True, check=True, text=True).stdout)
    batches = subprocess.run(
        [ROOT / "scripts/workflow/batches.py", "list", plan, "--seconds", str(SECONDS)], capture_output=True, check=True, text=True
    ).stdout.splitlines()
    slurm = Slurm(folder)
    if not slurm.has_node():
        slurm.stop()
        print(f"test-cluster: not run: Slurm does not start here: {(folder / 'log/slurmctld').read_text()[-500:]}")
        return
    began = time.time()
    try:
        cancelled, killed = run(slurm, env, plan, isostudy, draw)
    finally:
        slurm.stop()
    took = time.time() - began
    one, other = digests(whole), digests(out)
    differ = sorted(name for name in one.keys() | other.keys() if one.get(name) != other.get(name))
    print(json.dumps({"tasks": len(batches), "at_once": AT_ONCE, "cancelled": cancelled, "schedulers_killed": killed,
                      "files": len(one), "differ": differ, "seconds": round(took)}))
    shutil.rmtree(folder)
    sys.exit(1 if differ or cancelled < CANCELLED or not killed else 0)


def run(slurm, env, plan, isostudy, draw):
    """Runs the study to its end. Returns how many tasks were cancelled, and how often the scheduler was killed."""
    command = [env / "bin/snakemake", "--snakefile", "scripts/workflow/Snakefile", "--profile", "scripts/workflow/profiles/slurm"]
    command += ["--jobs", str(AT_ONCE), "--seconds-between-status-checks", "1", "--latency-wait", "20", "--retries", "6"]
    command += ["--directory", ROOT, "--config", f"plan={plan}", f"isostudy={isostudy}", f"seconds={SECONDS}"]
    environment = {**slurm.env, "PATH": f"{env}/bin:{os.environ['PATH']}"}
    log = open(slurm.folder / "snakemake.log", "wb")
    until, cancelled, killed, was_cancelled = time.time() + LIMIT_S, 0, 0, set()
    while time.time() < until:
        workflow = subprocess.Popen(command, env=environment, stdout=log, stderr=log, start_new_session=True)
        while workflow.poll() is None and time.time() < until:
            time.sleep(1)
            queued = slurm.say("squeue", "-h", "-t", "R", "-o", "%i").split()
            fresh = [job for job in queued if job not in was_cancelled]
            if cancelled == 3 and not killed:
                # The scheduler of the workflow dies, and that of the tasks ends, as when a login node does.
                slurm.stop_controller()
                os.killpg(workflow.pid, signal.SIGKILL)
                killed += 1
            elif cancelled < CANCELLED and fresh and draw.random() < 0.4:
                job = draw.choice(fresh)
                was_cancelled.add(job)
                slurm.say("scancel", job)
                cancelled += 1
        if workflow.poll() == 0:
            return cancelled, killed
        if slurm.controller.poll() is None:
            break
        workflow.wait()
        if slurm.controller.poll() is not None:
            slurm.start_controller()
            if not slurm.has_node():
                sys.exit(f"Slurm did not start again: {(slurm.folder / 'log/slurmctld').read_text()[-2000:]}")
        unlock = command[:5] + ["--directory", ROOT, "--unlock", "--config", f"plan={plan}", f"isostudy={isostudy}", f"seconds={SECONDS}"]
        subprocess.run(unlock, env=environment, stdout=log, stderr=log)
    workflow.kill()
    sys.exit(f"not done: {(slurm.folder / 'snakemake.log').read_text()[-3000:]}")


if __name__ == "__main__":
    main()
