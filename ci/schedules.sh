#!/bin/sh
# Usage: ci/schedules.sh [NUMBER]
# Runs NUMBER (10000) seeded schedules that interleave workers within operations (schedule_tests). Runs as many with
# each planted fault of the lock protocol and counts how often it shows. Exits with 1 if a mesh is wrong or a fault
# never shows. To run one seed: PODM_SCHEDULE=SEED build/bin/schedule_tests --gtest_filter='*AllMake*'
set -eu
cd "$(dirname "$0")/.."
cmake -S . -B build -G Ninja -DPODM_BUILD_TESTS=ON
cmake --build build --target schedule_tests
PODM_SCHEDULES=${1:-10000} build/bin/schedule_tests
