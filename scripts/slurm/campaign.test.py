#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs campaign.sbatch on a Slurm of one node, which it starts and stops: an array of shards, one of them requeued
while it runs, and the dependent merge. The result must be that of a single run.
  campaign.test.py GRAZE [--pairs N] [--shards N]
Exits with 77, which skips the test, if Slurm or munge is not installed, or if only root may start them.
"""
import argparse
import filecmp
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
NEEDED = ["munged", "slurmctld", "slurmd", "sbatch", "srun", "scontrol", "squeue"]


def free_port():
    with socket.socket() as probe:
        probe.bind(("", 0))
        return probe.getsockname()[1]


class Slurm:
    def __init__(self, folder):
        self.folder, self.running = folder, []
        host, cores = socket.gethostname().split(".")[0], os.cpu_count()
        for name in ["state", "spool"]:
            (folder / name).mkdir()
        (folder / "munged.key").write_bytes(os.urandom(1024))
        os.chmod(folder / "munged.key", 0o600)
        (folder / "slurm.conf").write_text(
            f"""ClusterName=graze
SlurmctldHost={host}(127.0.0.1)
AuthInfo=socket={folder}/munge.socket
SlurmUser=root
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldPort={free_port()}
SlurmdPort={free_port()}
ProctrackType=proctrack/pgid
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmdParameters=config_overrides
SchedulerParameters=sched_interval=1,sched_min_interval=0,defer_batch
RebootProgram=/bin/true
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={cores} State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""
        )
        self.environment = dict(os.environ, SLURM_CONF=str(folder / "slurm.conf"))
        for name in ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE"]:
            self.environment.pop(name, None)

    def begin(self):
        folder = self.folder
        files = [f"--{kind}-file={folder}/munged.{kind}" for kind in ("key", "pid", "log", "seed")]
        self.start("munged", "--foreground", "--force", f"--socket={folder}/munge.socket", *files)
        self.wait_for(lambda: (folder / "munge.socket").exists(), "munged's socket")
        self.start("slurmctld", "-D")
        self.start("slurmd", "-D")
        self.wait_for(lambda: "idle" in self("sinfo", "-h", "-o", "%t", fails=True), "an idle node")

    def start(self, *command):
        log = open(self.folder / f"{command[0]}.out", "w")  # pylint: disable=consider-using-with
        self.running.append(
            subprocess.Popen(command, env=self.environment, stdout=log, stderr=log, start_new_session=True)
        )

    def wait_for(self, holds, what, seconds=60):
        until = time.time() + seconds
        while not holds():
            if time.time() > until or any(process.poll() is not None for process in self.running):
                logs = "\n".join(f"{file.name}:\n{file.read_text()[-1500:]}" for file in self.folder.glob("*.out"))
                raise RuntimeError(f"expected {what}, found none after {seconds} s\n{logs}")
            time.sleep(0.2)

    def __call__(self, *command, fails=False, **more):
        ran = subprocess.run(command, env=dict(self.environment, **more), capture_output=True, text=True, check=False)
        if ran.returncode != 0 and not fails:
            raise RuntimeError(f"{command}: {ran.stdout}{ran.stderr}")
        return ran.stdout

    def stop(self):
        for process in reversed(self.running):
            process.terminate()
        for process in self.running:
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()


def run(slurm, root, graze, pairs, shards):
    campaign = ["--pairs", str(pairs), "--seed", "7", "--strata", "near_*,degenerate", "--lanes", "*/f32/cpu"]
    subprocess.run([graze, "fuzz", *campaign, "--out", root / "whole"], check=True, capture_output=True)
    more = {"GRAZE": str(graze), "GRAZE_OUT": str(root / "out"), "TMPDIR": str(root)}
    script = str(HERE / "campaign.sbatch")
    job = slurm(
        "sbatch", "--parsable", f"--array=1-{shards}", f"--output={root}/job-%a.txt", script, *campaign, **more
    ).strip()
    merge = slurm(
        "sbatch", "--parsable", f"--dependency=afterok:{job}", f"--output={root}/merge.txt", script, "merge", **more
    ).strip()
    print(f"array {job} of {shards} shards, merge {merge} after it")
    slurm.wait_for(lambda: (root / "out/shard-1/status.json").exists(), "a shard that runs")
    requeued = slurm("scontrol", "requeue", f"{job}_1", fails=True) is not None and "Restarts=1" in slurm(
        "scontrol", "show", "job", f"{job}_1", fails=True
    )
    print(f"shard 1 requeued while it ran: {requeued}")
    print(slurm("squeue", "--array"), end="")
    # A requeued job normally waits two minutes; this releases it immediately.
    seen = ""
    while state := slurm("squeue", "-h", "-o", "%i %T %r"):
        if state != seen:
            print(state, end="")
        seen = state
        if f"{job}_1 PENDING BeginTime" in state:
            slurm("scontrol", "update", f"JobId={job}_1", "StartTime=now", fails=True)
        slurm.wait_for(lambda: True, "Slurm")
        time.sleep(0.5)
    print((root / "merge.txt").read_text())
    print(
        subprocess.run(
            [graze, "status", *sorted((root / "out").glob("shard-*"))], check=True, capture_output=True, text=True
        ).stdout
    )
    same = filecmp.dircmp(root / "whole/cases", root / "out/campaign/cases")
    assert not same.left_only and not same.right_only and not same.diff_files and same.same_files
    assert filecmp.cmp(root / "whole/summary.json", root / "out/campaign/summary.json", shallow=False)
    assert requeued, "expected that shard 1 was requeued while it ran, found that it was not"
    print(f"summary and {len(same.same_files)} files of cases: the same bytes as one run of the whole")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("graze", type=lambda name: pathlib.Path(name).resolve())
    parser.add_argument("--pairs", type=int, default=400000)
    parser.add_argument("--shards", type=int, default=3)
    options = parser.parse_args()
    missing = [name for name in NEEDED if not shutil.which(name)]
    if missing or os.geteuid() != 0:
        print(f"skipped: {'not installed: ' + ', '.join(missing) if missing else 'not root'}")
        return 77
    with tempfile.TemporaryDirectory() as name:
        root = pathlib.Path(name)
        (root / "slurm").mkdir(mode=0o755)
        os.chmod(root, 0o755)
        slurm = Slurm(root / "slurm")
        try:
            slurm.begin()
            run(slurm, root, options.graze, options.pairs, options.shards)
        except BaseException:
            for file in sorted(root.glob("*.txt")):
                print(f"{file.name}:\n{file.read_text()}")
            raise
        finally:
            slurm.stop()
    return 0


if __name__ == "__main__":
    sys.exit(main())
