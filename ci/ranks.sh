#!/bin/sh
# Usage: ci/ranks.sh
# Builds the programs in build/ and makes RANKS_RUNS (20) meshes on 2 to 64 ranks of one process, of about RANKS_CELLS
# (20000) cells each. The seeds from RANKS_FIRST (1) on draw the phantom, ranks, algorithm, threads, initial ratio (1 to
# 2) and the cuts into blocks, including thin blocks; and they cut some runs, which other ranks resume from a
# checkpoint. podm-verify, and podm-verify-mpi on 1 to 5 ranks, must prove all claims of each mesh from its pieces, and
# podm replay must make the mesh again from the logs of its ranks. With RANKS_IMAGES=FOLDER the images of that folder
# are meshed instead, with about RANKS_CELLS (3000000) cells, on 2, 3, 5 and 8 ranks in process and on 2 and 4 of MPI;
# the output is then a table in Markdown. If a run fails, its command is printed and the exit code is 1.
set -eu
cd "$(dirname "$0")/.."

cmake -S . -B build -G Ninja > /dev/null
cmake --build build --target podm podm-mpi podm-verify podm-verify-mpi > /dev/null
PODM_PROGRAM=$PWD/build/bin/podm
PODM_MPI_PROGRAM=$PWD/build/bin/podm-mpi
export PODM_PROGRAM PODM_MPI_PROGRAM

if [ -n "${RANKS_IMAGES:-}" ]; then
  exec /usr/bin/python3 -B mesher/tests/stress_ranks.py images "$RANKS_IMAGES" --cells "${RANKS_CELLS:-3000000}"
fi
exec /usr/bin/python3 -B mesher/tests/stress_ranks.py random --first "${RANKS_FIRST:-1}" --runs "${RANKS_RUNS:-20}" \
  --cells "${RANKS_CELLS:-20000}"
