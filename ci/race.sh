#!/bin/sh
# Usage: ci/race.sh [FOLDER]
# Builds podm, the tests of memory orders and those of in-process ranks in FOLDER/build-race (default: ./build-race),
# with the thread sanitizer, with threads that yield in the middle of operations (mesher/delaunay/step.h) and with the
# lock contract (mesher/delaunay/lock_contract.h), without ITK, which phantoms do not need. Runs the tests. Those of
# the contract require that it finds planted faults of the lock protocol. Four threads then mesh phantoms for
# RACE_SECONDS (120), by podm, pdr, pdr-podm and podm-home in turn. Stops with exit code 1 at the first finding, at a
# mesh that podm-verify rejects, or at a mesh that differs from the replay of its log. Each mesh is made once more with
# --lines, and once more and optimised.
#
# Without the contract, the sanitizer must also find each planted fault (mesher/delaunay/planted_fault.h). If it does
# not, it would not detect a broken protocol, and the script exits with 1. The tests of memory orders find each order
# of the kernel that is planted as relaxed. The tests of the threads of a rank that learn vertices find one lock or no
# lock to walk, three locks instead of four to replace a cell, and relaxed locks. The meshes find, within two minutes:
# one lock instead of two or no lock to read a cell; three locks instead of four to replace it, by refinement or by
# optimisation; a lock that is taken or released with the relaxed order. A mesh of many lines finds two locks instead of
# four to look up edges on lines.
set -eu
cd "$(dirname "$0")/.."
build=${1:-.}/build-race
seconds=${RACE_SECONDS:-120}
most_seconds_to_find=120
finding=66
export TSAN_OPTIONS="halt_on_error=1:exitcode=$finding"

make build  # verification and replay need no sanitizer
cmake --preset race -B "$build" -G Ninja
cmake --build "$build" --target podm communication_tests rounds_tests memory_order_tests lock_contract_tests
cp build/bin/podm-verify "$build/bin/"  # podm looks for it here

"$build/bin/communication_tests" --gtest_brief=1 --gtest_filter="-*/64*:*Hundreds*"  # races also show with few ranks
# One-thread ranks that compute one at a time cannot race.
"$build/bin/rounds_tests" --gtest_brief=1 --gtest_filter='*at_once*:*leaves_on_3*:RanksOfOneProcess*:Learners*'

"$build/bin/lock_contract_tests" --gtest_brief=1

# Requires that a test program, run with a planted fault, ends with a finding of the sanitizer.
expect_found() {
  fault=$1 program=$2 filter=$3
  PODM_NO_LOCK_CONTRACT=1 PODM_PLANTED_FAULT=$fault timeout $most_seconds_to_find "$build/bin/$program" \
    --gtest_brief=1 --gtest_filter="$filter" > "$build/$fault.txt" 2>&1 && status=0 || status=$?
  [ $status = $finding ] || { echo "$fault: not found, exit $status: $build/$fault.txt"; exit 1; }
  echo "== $fault: found by $program"
}

"$build/bin/memory_order_tests" --gtest_brief=1
for fault in relaxed_lock relaxed_unlock relaxed_peek_point relaxed_place relaxed_peek_cell relaxed_renew; do
  expect_found $fault memory_order_tests "*"
done
for fault in one_lock no_lock three_locks relaxed_lock relaxed_unlock; do
  expect_found $fault rounds_tests "Learners.*"
done

seconds_since() { echo $(($(date +%s) - $1)); }

# Makes the mesh of run number $1; the settings cycle with the number. Further arguments go to `podm mesh`.
mesh() {
  run=$1
  shift
  case $((run % 4)) in
    0) algorithm="podm" ;;
    1) algorithm="pdr" ;;
    2) algorithm="pdr-podm --nodes 2" ;;
    3) algorithm="podm-home --nodes 2" ;;
  esac
  case $((run / 4 % 3)) in
    0) image=phantom:spheres@24 radius=7 ;;
    1) image=phantom:torus@24 radius=6 ;;
    2) image=phantom:abdomen@24 radius=22 ;;
  esac
  case $((run / 12 % 4)) in
    0) contention=local ;;
    1) contention=aggressive ;;
    2) contention=global ;;
    3) contention=random ;;
  esac
  case $((run % 3)) in
    0) angles="" ;;
    *) angles="--min-dihedral 15" ;;
  esac
  # shellcheck disable=SC2086  # a list of words
  timeout $most_seconds_to_find "$build/bin/podm" mesh "$image" --radius "$radius" $angles --algorithm $algorithm \
    --threads 4 --oversubscribe --contention $contention --seed "$run" --quiet -o "$build/run.vtu" "$@"
}

start=$(date +%s)
count=0
while [ "$(seconds_since "$start")" -lt "$seconds" ]; do
  for lines in "" "--lines"; do
    # shellcheck disable=SC2086  # no word or one
    mesh "$count" $lines --log "$build/run.log" --verify || { echo "run $count $lines failed: exit $?"; exit 1; }
    build/bin/podm replay "$image" "$build/run.log" 2> "$build/replay.txt" || { cat "$build/replay.txt"; exit 1; }
  done
  mesh "$count" --optimize --verify || { echo "run $count, optimised, failed: exit $?"; exit 1; }
  count=$((count + 1))
done
echo "== $count runs without a finding"

export PODM_NO_LOCK_CONTRACT=1  # the contract would abort first
# Makes a mesh in which many of the operations look up edges on lines.
mesh_of_lines() {
  timeout $most_seconds_to_find "$build/bin/podm" mesh phantom:crystal@16 --radius 14 --delta 7 --lines --threads 4 \
    --oversubscribe --seed "$1" --quiet -o "$build/run.vtu"
}
for fault in one_lock no_lock three_locks three_in_cavity relaxed_lock relaxed_unlock two_to_look_up; do
  export PODM_PLANTED_FAULT=$fault
  start=$(date +%s)
  count=0
  until if [ $fault = two_to_look_up ]; then mesh_of_lines "$count"; else mesh "$count" --optimize; fi \
          > "$build/$fault.txt" 2>&1; [ $? = $finding ]; do
    count=$((count + 1))
    [ "$(seconds_since "$start")" -lt $most_seconds_to_find ] || { echo "$fault: not found in $count runs"; exit 1; }
  done
  echo "== $fault: found in run $((count + 1)), after $(seconds_since "$start") s"
done
