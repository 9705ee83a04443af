#!/bin/sh
# Usage: ci/sanitize.sh [FOLDER]
# Builds the mesher and its unit tests in FOLDER/build-asan with the address and undefined-behaviour sanitizers and in
# FOLDER/build-tsan with the thread sanitizer (FOLDER: the repository). Under each, the tests run, then four threads
# mesh a phantom and their log must replay to the same mesh. Stops at the first program with a finding, with exit code
# 1.
set -eu
cd "$(dirname "$0")/.."
folder=${1:-.}
tests="mesh_image_tests algorithms_tests fault_tests communication_tests rounds_tests workers_tests refine_tests
delaunay_tests octree_tests isosurface_tests files_tests mesh_io_tests image_io_tests runtime_tests"
export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1 ASAN_OPTIONS=detect_stack_use_after_return=1
export LSAN_OPTIONS="suppressions=$PWD/ci/leaks_of_libraries.txt:print_suppressions=0"
image=phantom:spheres@48

run() {
  echo "== $*"
  "$@" || exit 1
}

for sanitizer in asan tsan; do
  build=$folder/build-$sanitizer
  cmake --preset "$sanitizer" -B "$build" -G Ninja
  # shellcheck disable=SC2086  # a list of words
  cmake --build "$build" --target podm $tests
  for test in $tests; do
    run "$build/bin/$test" --gtest_brief=1
  done
  run "$build/bin/podm" mesh "$image" --threads 4 --oversubscribe --radius 4 --log "$build/run.log" -o "$build/run.vtu"
  run "$build/bin/podm" replay "$image" "$build/run.log"
done
