#!/bin/sh
# Usage: ci/locks.sh [FOLDER]
# Builds the parallel tests of the mesher in FOLDER/build-locks (FOLDER: here) with the lock contract asserted at every
# access to a cell (mesher/delaunay/lock_contract.h), and runs them: the kernel, workers, meshes by podm, pdr and
# pdr-podm on threads and in virtual time, optimised meshes, and meshes on ranks. The contract's own tests are among
# them, and faults planted in the protocol, which it must notice. The first test that fails ends it, with exit code 1.
set -eu
cd "$(dirname "$0")/.."
build=${1:-.}/build-locks
tests="delaunay_tests workers_tests algorithms_tests optimize_tests rounds_tests"

cmake --preset locks -B "$build" -G Ninja
# shellcheck disable=SC2086  # a list of words
cmake --build "$build" --target $tests
for test in $tests; do
  echo "== $test"
  "$build/bin/$test" --gtest_brief=1 || exit 1
done
