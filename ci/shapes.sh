#!/bin/sh
# Usage: ci/shapes.sh [OPTIONS...]
# Builds the programs in build/ and makes SHAPES_RUNS (100) random runs with each of --lines, --box flat, both of
# them, and --thin keep, or with each of the given options, for example '--box flat'. The seeds from SHAPES_FIRST (1)
# on draw the image (polycrystals of 3 to 300 grains, blocks cut through phantoms, shells one voxel thick, plates with
# holes), sizes, smoothing, algorithm and one or two threads or more virtual ones (mesher/tests/random_shapes.py).
# podm-verify must prove all that each file promises, and podm replay must make the mesh again. If a run fails, its
# seed and its command are printed and the exit code is 1.
set -eu
cd "$(dirname "$0")/.."

[ $# -gt 0 ] || set -- "--lines" "--box flat" "--lines --box flat" "--thin keep"
cmake -S . -B build -G Ninja > /dev/null
cmake --build build --target podm podm-verify > /dev/null
PODM_PROGRAM=$PWD/build/bin/podm
export PODM_PROGRAM

failed=0
for options; do
  echo "== $options"
  # shellcheck disable=SC2086  # an option and its value are two words
  /usr/bin/python3 -B mesher/tests/stress.py $options --first "${SHAPES_FIRST:-1}" --runs "${SHAPES_RUNS:-100}" ||
    failed=1
done
exit $failed
