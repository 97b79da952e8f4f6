#!/bin/bash
# engines.bash RIGTWIN -- `rigtwin sweep` on the engines of clusters: a Slurm array job, Open MPI, GNU parallel and one process give the same
# bytes. Slurm runs on this machine alone, without systemd: munged, slurmctld and slurmd of its own, with files in a folder of its own.
. "$(dirname "$0")/common.bash"
program=$(realpath "$1")
need mpirun
need parallel
need slurmd
need munged
[ "$(id -u)" -eq 0 ] || skip "not root: slurmd starts the jobs of other users"

folder=$(mktemp -d)
started=()
stop() {
  local id
  for id in "${started[@]}"; do kill "$id" 2>/dev/null || true; done
  wait
  rm -rf "$folder"
}
trap stop EXIT

cp host_sim/rigs/paper_rig_fdva.toml "$folder/car.toml"
cat >"$folder/plan.toml" <<'END'
rig = "car.toml"
repeats = 2
[run]
duration = 0.5
[vary]
road = ["iso8608:A", "iso8608:B"]
speed = { from = 15.0, to = 35.0, steps = 3 }
open_ducts = [0, 2, 6]
[draw]
"body.mass" = { mean = 290.0, standard_deviation = 3.0 }
END
plan=$folder/plan.toml
"$program" sweep "$plan" --out "$folder/whole" >/dev/null

# same NAME -- merges the results of an engine and compares.
same() {
  "$program" sweep --merge "$folder/$1" >/dev/null
  cmp "$folder/whole/results.csv" "$folder/$1/results.csv"
  cmp "$folder/whole/results.jsonl" "$folder/$1/results.jsonl"
  echo "$1: $(ls "$folder/$1" | grep -c '^results-') shards, same bytes"
}

mpirun --allow-run-as-root --oversubscribe -n 4 "$program" sweep "$plan" --out "$folder/mpi" >/dev/null
same mpi
seq 7 | parallel --will-cite -j 2 "$program" sweep "$plan" --out "$folder/parallel" --shard '{}/7' >/dev/null
same parallel

# Slurm. Its key, sockets, state and logs are in the folder; ports beside the usual ones, so that a Slurm of this machine is not met.
mkdir -p "$folder/munge" "$folder/state" "$folder/spool"
dd if=/dev/urandom of="$folder/munge/key" bs=128 count=1 status=none
chmod 400 "$folder/munge/key"
chmod 755 "$folder"
munged --foreground --force --key-file="$folder/munge/key" --socket="$folder/munge/socket" --pid-file="$folder/munge/pid" \
  --log-file="$folder/munge/log" --seed-file="$folder/munge/seed" >"$folder/munge/out" 2>&1 &
started+=($!)
name=$(hostname -s)
cat >"$folder/slurm.conf" <<END
ClusterName=rigtwin
SlurmctldHost=$name(127.0.0.1)
SlurmctldPort=16817
SlurmdPort=16818
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge/socket
CredType=cred/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
MailProg=/bin/true
NodeName=localhost NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=localhost Default=YES MaxTime=INFINITE State=UP
END
export SLURM_CONF=$folder/slurm.conf
until [ -S "$folder/munge/socket" ]; do kill -0 "${started[0]}" && sleep 0.1; done
slurmctld -D >"$folder/slurmctld.out" 2>&1 &
started+=($!)
slurmd -D -N localhost >"$folder/slurmd.out" 2>&1 &
started+=($!)
# The job script of a cluster's user, toolchains/sweep.slurm; --wait ends with the last task.
job() {
  sbatch --wait --array=0-6 --output="$folder/task-%a.log" --export="ALL,RIGTWIN=$program" toolchains/sweep.slurm "$plan" "$folder/slurm"
}
# The controller takes a moment to come up: sbatch itself waits for it, but refuses while the node is unknown.
for attempt in 1 2 3 4 5 6 7 8 9 10; do
  sinfo -h -o %T 2>/dev/null | grep -q idle && break
  sleep 1
done
job || { tail -n 20 "$folder"/task-*.log "$folder"/slurm*.log; exit 1; }
same slurm
