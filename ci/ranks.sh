#!/bin/sh
# Usage: ci/ranks.sh
# Builds the programs in build/ and makes RANKS_RUNS (20) meshes on 2 to 9 ranks of one process, of about RANKS_CELLS
# (20000) cells each. Phantom, ranks, algorithm, threads, initial ratio (1 to 2) and the cuts of blocks, thin ones among
# them, are drawn by the seeds from RANKS_FIRST (1) on. podm-verify has to prove all claims of each from its pieces, and
# podm replay to make it again from the logs of its ranks. With RANKS_IMAGES=FOLDER the images there are meshed instead,
# of about RANKS_CELLS (3000000) cells, on 2, 3, 5 and 8 ranks in process and on 2 and 4 of MPI: what is printed is a
# table in Markdown. A run that fails is told with its command, and the exit code is 1 then.
set -eu
cd "$(dirname "$0")/.."

cmake -S . -B build -G Ninja > /dev/null
cmake --build build --target podm podm-mpi podm-verify > /dev/null
PODM_PROGRAM=$PWD/build/bin/podm
PODM_MPI_PROGRAM=$PWD/build/bin/podm-mpi
export PODM_PROGRAM PODM_MPI_PROGRAM

if [ -n "${RANKS_IMAGES:-}" ]; then
  exec /usr/bin/python3 -B mesher/tests/stress_ranks.py images "$RANKS_IMAGES" --cells "${RANKS_CELLS:-3000000}"
fi
exec /usr/bin/python3 -B mesher/tests/stress_ranks.py random --first "${RANKS_FIRST:-1}" --runs "${RANKS_RUNS:-20}" \
  --cells "${RANKS_CELLS:-20000}"
