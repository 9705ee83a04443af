#!/bin/sh
# Builds everything with address and undefined-behaviour sanitizers and runs the fast tests.
set -eu
cd "$(dirname "$0")/.."
cmake --preset asan -G Ninja
cmake --build build-asan
ctest --test-dir build-asan -j2 --output-on-failure
