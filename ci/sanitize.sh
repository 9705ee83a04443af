#!/bin/sh
# Builds everything with address and undefined-behaviour sanitizers and runs the unit tests; the tests of whole
# programs, too slow here, carry lower-case names such as podm.mesh.
set -eu
cd "$(dirname "$0")/.."
cmake --preset asan -G Ninja
cmake --build build-asan
ctest --test-dir build-asan -j2 --output-on-failure --exclude-regex '^[a-z]'
