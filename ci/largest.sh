#!/bin/sh
# Usage: ci/largest.sh [FOLDER]
# Builds the programs in build/. Makes a mesh of a phantom on LARGEST_RANKS (8) ranks in one process, with its pieces
# and logs in a new folder in FOLDER (build). LARGEST_RADIUS (0.72 mm) gives about 160 million cells. The ranks may take
# LARGEST_GIB in all (80 % of the available memory). podm-verify-mpi must prove all claims but fidelity from the pieces,
# and podm-mpi replay must make the mesh again from the logs. Prints the seconds and the memory of each step. If a step
# fails, the exit code is 1 and the folder stays.
set -eu
cd "$(dirname "$0")/.."
ranks=${LARGEST_RANKS:-8}
radius=${LARGEST_RADIUS:-0.72}

cmake -S . -B build -G Ninja > /dev/null
cmake --build build --target podm podm-mpi podm-verify-mpi > /dev/null
folder=$(mktemp -d -p "${1:-build}" largest.XXXXXX)
image=$folder/abdomen.nii.gz
build/bin/podm phantom abdomen -o "$image"

# Runs a command and prints its seconds and memory.
step() {
  /usr/bin/time -f "$1 $2: %e s, %U s of processor time, at most %M KiB of memory" -o "$folder/cost.txt" "$@" ||
    { echo "ci/largest.sh: failed: $*" >&2; exit 1; }
  cat "$folder/cost.txt"
}

step build/bin/podm-mpi mesh "$image" --radius "$radius" --in-process "$ranks" \
  ${LARGEST_GIB:+--max-memory-gib "$LARGEST_GIB"} --log "$folder/run.log" -o "$folder/mesh.pvtu"
du -sh "$folder"
step build/bin/podm-verify-mpi "$folder/mesh.pvtu" --image "$image" --in-process "$ranks" \
  --radius "$radius" \
  --claims structure,radius_edge,boundary_angles,size,delaunay,conformity,surface,labels,surface_vertices
step build/bin/podm-mpi replay "$image" "$folder/run.log" --in-process "$ranks"
rm -rf "$folder"
