#!/bin/sh
# Usage: ci/cluster.sh [slurm|container...]
# Runs what is made for clusters. Needs root, the packages of `scripts/setup cluster`, and a mirror of Debian. Without
# words it makes both checks:
#   slurm      Debian's SLURM with two nodes on this machine runs scripts/slurm/podm.sbatch and
#              examples/slurm/podm-mpi.sbatch to their end, and each again until SIGTERM, as before a time limit
#   container  buildah builds scripts/container/Containerfile on a system that mmdebstrap makes, and runs an experiment
# Exits with 1 if one fails.
set -eu
cd "$(dirname "$0")/.."
[ "$(id -u)" = 0 ] || { echo "ci/cluster.sh: SLURM's nodes and buildah need root here" >&2; exit 2; }
[ $# -gt 0 ] || set -- slurm container
scripts/setup build packaging cluster
scratch=$(mktemp -d)
chmod 755 "$scratch"
is_alive() { case $(sed -n 's/^State:[[:space:]]*//p' "/proc/$1/status" 2> /dev/null) in '' | Z*) return 1 ;; esac; }
# Ends the daemons, at the latest after 30 seconds each. They write into $scratch until they have ended.
end() {
  daemons=$(cat "$scratch"/*.pid 2> /dev/null || true)
  for pid in $daemons; do kill "$pid" 2> /dev/null || true; done
  for pid in $daemons; do
    for _ in $(seq 300); do is_alive "$pid" || break; sleep 0.1; done
    if is_alive "$pid"; then kill -9 "$pid" 2> /dev/null || true; fi
  done
  rm -rf "$scratch"
}
trap end EXIT

# Starts munge, the controller and two nodes, all in $scratch.
start_slurm() {
  export SLURM_CONF="$scratch/slurm.conf"
  cat > "$SLURM_CONF" << END
ClusterName=podmark
SlurmctldHost=$(hostname)
SlurmctldPort=16817
SlurmUser=root
StateSaveLocation=$scratch/state
SlurmdSpoolDir=$scratch/spool.%n
SlurmctldPidFile=$scratch/slurmctld.pid
SlurmdPidFile=$scratch/slurmd.%n.pid
SlurmctldLogFile=$scratch/slurmctld.log
SlurmdLogFile=$scratch/slurmd.%n.log
AuthInfo=socket=$scratch/munge/socket
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
NodeName=n1 NodeHostname=$(hostname) NodeAddr=127.0.0.1 Port=16821 CPUs=$(nproc) State=UNKNOWN
NodeName=n2 NodeHostname=$(hostname) NodeAddr=127.0.0.1 Port=16822 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=n1,n2 Default=YES State=UP
END
  mkdir "$scratch/munge" "$scratch/state" "$scratch/spool.n1" "$scratch/spool.n2" "$scratch/tmp_of_n2"
  head -c 1024 /dev/urandom > "$scratch/munge/key"
  chown -R munge: "$scratch/munge"
  chmod 600 "$scratch/munge/key"
  runuser -u munge -- munged --socket="$scratch/munge/socket" --key-file="$scratch/munge/key" \
    --pid-file="$scratch/munge/pid" --log-file="$scratch/munge/log" --seed-file="$scratch/munge/seed" --force
  ln "$scratch/munge/pid" "$scratch/munge.pid"
  slurmctld
  slurmd -N n1
  # PMIx gives both nodes the same folder in /tmp, so the second node has a /tmp of its own.
  mkdir -p "$scratch/tmp_of_n2/$(basename "$scratch")"
  unshare --mount sh -c 'mount --bind "$0" "$0/tmp_of_n2/$(basename "$0")" && mount --rbind "$0/tmp_of_n2" /tmp &&
    exec slurmd -N n2' "$scratch"
  for _ in $(seq 30); do
    [ "$(sinfo --noheader --states=idle --format=%D)" != 2 ] || return 0
    sleep 1
  done
  echo "ci/cluster.sh: SLURM's nodes do not start" >&2
  return 1
}

# Submits the job after $1, sends SIGTERM to its step after $1 seconds, and waits for its end.
end_after() {
  wait_s=$1
  shift
  job=$(sbatch --parsable "$@")
  sleep "$wait_s"
  scancel --signal=TERM "$job"
  while squeue --noheader --jobs="$job" 2> /dev/null | grep -q .; do sleep 1; done
}

check_slurm() {
  root=$PWD
  start_slurm
  mkdir "$scratch/job"
  cd "$scratch/job"
  cp -r "$root/experiments" .
  export TIER=kick-tires PODM_BENCH="$root/build/bin/podm-bench" PODM_MPI="$root/build/bin/podm-mpi"
  sbatch --wait "$root/scripts/slurm/podm.sbatch" experiments/first_mesh.toml
  grep -q '"status":"ok"' results/runs/first_mesh.jsonl
  TIER=full RESULTS=ended end_after 6 "$root/scripts/slurm/podm.sbatch" experiments/first_mesh.toml
  grep -q '"status":"interrupted"' ended/first_mesh.jsonl

  sbatch --wait "$root/examples/slurm/podm-mpi.sbatch" phantom:abdomen@64 whole.pvtu --radius 16
  "$root/build/bin/podm-verify" whole.pvtu
  end_after 15 "$root/examples/slurm/podm-mpi.sbatch" phantom:abdomen@256 ended.pvtu --radius 1 --threads 1
  "$root/build/bin/podm-verify" ended.pvtu --claims structure
  cd "$root"
}

check_container() {
  make deb
  . scripts/packaging/mirror.sh
  mmdebstrap --quiet --variant=minbase bookworm "$scratch/base.tar" "$(debian_mirror)"
  export STORAGE_DRIVER=vfs BUILDAH_ISOLATION=chroot
  storage="--root $scratch/storage --runroot $scratch/run"
  # shellcheck disable=SC2086  # a list of options, here and below
  base=$(buildah $storage from scratch)
  buildah $storage add --quiet "$base" "$scratch/base.tar" / > /dev/null
  buildah $storage commit --quiet "$base" base
  buildah $storage build --quiet --build-arg BASE=localhost/base -f scripts/container/Containerfile -t podmark .
  made=$(buildah $storage from --pull-never podmark)
  buildah $storage run "$made" -- podm-bench run --tier kick-tires experiments/first_mesh.toml
  buildah $storage run "$made" -- grep -c '"status":"ok"' results/runs/first_mesh.jsonl
}

for check; do
  echo "== $check"
  "check_$check"
done
