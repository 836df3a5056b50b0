"""Runs an array of Slurm on a one-node cluster of its own, as root: munge, slurmctld and slurmd, no systemd.

slurm_array.py PROGRAM SCRIPT TASKS CAMPAIGN DIR [--check]     exit code 77, with the reason: it cannot run here
"""
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time

PROGRAM, SCRIPT, TASKS, CAMPAIGN, OUT = sys.argv[1:6]
NEEDED = ("munged", "slurmctld", "slurmd", "sbatch", "scontrol", "squeue")


def skip(why):
    print(why, file=sys.stderr)
    sys.exit(77)


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


def configuration(place, host, ports, munge):
    return f"""ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={munge}
CryptoType=crypto/munge
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
StateSaveLocation={place}/state
SlurmdSpoolDir={place}/spool
SlurmctldPidFile={place}/slurmctld.pid
SlurmdPidFile={place}/slurmd.pid
SlurmctldLogFile={place}/slurmctld.log
SlurmdLogFile={place}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
ReturnToService=2
SchedulerType=sched/backfill
SchedulerParameters=bf_interval=1,sched_min_interval=0,batch_sched_delay=0
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
NodeName={host} NodeAddr=127.0.0.1 CPUs={os.cpu_count()} State=UNKNOWN
PartitionName=test Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def main():
    missing = [name for name in NEEDED if not shutil.which(name)]
    if missing:
        skip(f"no {missing[0]} (Debian: slurm-wlm)")
    if os.geteuid() != 0:
        skip("only root may start a Slurm of its own")
    if "--check" in sys.argv:
        return
    place = tempfile.mkdtemp(prefix="slurm-")
    os.chmod(place, 0o755)
    for name in ("state", "spool", "munge"):
        os.mkdir(f"{place}/{name}", 0o755)
    munge, host = f"{place}/munge/socket", socket.gethostname().split(".")[0]
    with open(f"{place}/munge/key", "wb") as key:
        key.write(os.urandom(128))
    os.chmod(f"{place}/munge/key", 0o400)
    with open(f"{place}/slurm.conf", "w") as conf:
        conf.write(configuration(place, host, free_ports(2), munge))
    environment = dict(os.environ, SLURM_CONF=f"{place}/slurm.conf", TWINCHUTE=PROGRAM)
    daemons = []

    def start(*words):
        log = open(f"{place}/{words[0]}.out", "w")
        daemons.append(subprocess.Popen(words, env=environment, stdout=log, stderr=log))

    def ask(*words):
        return subprocess.run(words, env=environment, capture_output=True, text=True)

    try:
        start("munged", "--foreground", "--force", f"--socket={munge}", f"--key-file={place}/munge/key",
              f"--pid-file={place}/munge/pid", f"--seed-file={place}/munge/seed", f"--log-file={place}/munge/log")
        for _ in range(100):
            if os.path.exists(munge):
                break
            time.sleep(0.05)
        start("slurmctld", "-D", "-i")
        start("slurmd", "-D")
        for _ in range(200):
            if "State=IDLE" in ask("scontrol", "show", "node", host).stdout:
                break
            time.sleep(0.1)
        else:
            skip("Slurm did not come up: " + open(f"{place}/slurmctld.out").read()[-300:])
        job = ask("sbatch", "--parsable", f"--array=1-{TASKS}", "--output=/dev/null", SCRIPT,
                  os.path.abspath(CAMPAIGN), os.path.abspath(OUT))
        if job.returncode != 0:
            sys.exit(job.stderr)
        for _ in range(600):
            if not ask("squeue", "-h").stdout.strip():
                return
            time.sleep(0.2)
        sys.exit("the array did not end")
    finally:
        for daemon in reversed(daemons):
            daemon.terminate()
        for daemon in daemons:
            daemon.wait()
        shutil.rmtree(place, ignore_errors=True)


main()
