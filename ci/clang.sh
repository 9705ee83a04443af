#!/bin/sh
# Usage: ci/clang.sh [FOLDER]
# Builds all programs and tests with Clang in FOLDER/build-clang (default: ./build-clang), with warnings as errors. Runs
# the unit tests, then makes the meshes of results/reference/canonical_hashes.json, which must equal those of GCC.
# Exits with 1 at the first warning, test that fails or mesh that differs.
set -eu
cd "$(dirname "$0")/.."
build=${1:-.}/build-clang

cmake -S . -B "$build" -G Ninja -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ \
  -DCMAKE_CXX_FLAGS="-include $PWD/ci/itk_with_clang.h" -DPODM_UNITE=ON -DPODM_BUILD_TESTS=ON
cmake --build "$build" --target all tests
for test in "$build"/bin/*_tests; do
  case $test in */mpi_communication_tests | */verify_mpi_tests) continue ;; esac  # run by mpirun
  echo "== ${test##*/}"
  "$test" --gtest_brief=1 || exit 1
done
scripts/canonical_hashes --podm "$build/bin/podm"
