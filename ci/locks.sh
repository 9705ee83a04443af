#!/bin/sh
# Usage: ci/locks.sh [FOLDER]
# Builds the parallel tests of the mesher in FOLDER/build-locks (default: ./build-locks) and runs them. The lock
# contract is asserted at every access to a cell (mesher/delaunay/lock_contract.h). The tests cover the kernel, workers,
# meshes by podm, pdr and pdr-podm on threads and in virtual time, optimised meshes, and meshes on ranks. They include
# the contract's own tests and planted faults of the protocol, which the contract must detect. Stops at the first test
# that fails, with exit code 1.
set -eu
cd "$(dirname "$0")/.."
build=${1:-.}/build-locks
tests="lock_contract_tests delaunay_tests workers_tests algorithms_tests optimize_tests rounds_tests"

cmake --preset locks -B "$build" -G Ninja
# shellcheck disable=SC2086  # a list of words
cmake --build "$build" --target $tests
for test in $tests; do
  echo "== $test"
  "$build/bin/$test" --gtest_brief=1 || exit 1
done
