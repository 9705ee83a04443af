#!/bin/sh
# Usage: ci/arm64.sh [FOLDER]
# Compiles podm and its unit tests for arm64 with Debian's cross compiler and runs them with qemu. Unpacks the libraries
# of Debian's arm64 into FOLDER/build-arm64/sysroot (default: ./build-arm64/sysroot), where nothing of this machine
# changes, and builds in FOLDER/build-arm64. The tests cover geometry, the kernel, rules, workers, algorithms, files and
# mesh files. Then podm makes the meshes of results/reference/canonical_hashes.json, which must equal those of x86-64.
# One test of affinity is left out. Prints the tests and seconds of each program. Exits with 1 if a test fails or a
# mesh differs.
#
# qemu does not reorder memory accesses as an arm64 processor may. ci/race.sh proves the memory orders.
set -eu
cd "$(dirname "$0")/.."
scripts/setup cross
mkdir -p "${1:-.}/build-arm64"
build=$(realpath "${1:-.}/build-arm64")
sysroot=$build/sysroot
tests="geometry_tests runtime_tests octree_tests delaunay_tests memory_order_tests refine_tests workers_tests
algorithms_tests mesh_io_tests"

# Debian has no ITK for arm64. The tests need no MPI.
packages="libc6-dev libstdc++-12-dev $(scripts/setup --print build test |
  grep '^lib.*-dev$\|^zlib\|^nlohmann' | grep -v 'insighttoolkit\|openmpi')"
if [ "$(cat "$build/packages" 2> /dev/null)" != "$packages" ]; then
  rm -rf "$sysroot" "$build/packages"
  mmdebstrap --variant=extract --architectures=arm64 --include="$(echo "$packages" | tr ' \n' ',,')" bookworm "$sysroot"
  # Absolute links would lead out of the sysroot.
  find "$sysroot" -type l -lname '/*' | while read -r link; do
    ln -sfnr "$sysroot$(readlink "$link")" "$link"
  done
  echo "$packages" > "$build/packages"
fi

cmake -S . -B "$build" -G Ninja --toolchain cmake/arm64.cmake -DPODM_SYSROOT="$sysroot" -DPODM_ITK=OFF -DPODM_UNITE=ON \
  -DPODM_BUILD_TESTS=ON
# shellcheck disable=SC2086  # a list of words
cmake --build "$build" --target podm $tests

on_arm64="qemu-aarch64-static -L $sysroot"
# The topology is that of the processors of all threads of the process. qemu has a thread that the test does not pin.
left_out=Topology.OfThisMachineHeedsTheAffinity
table=""
for test in $tests; do
  echo "== $test"
  start=$(date +%s)
  # shellcheck disable=SC2086  # a list of words
  $on_arm64 "$build/bin/$test" --gtest_brief=1 --gtest_filter=-$left_out \
    > "$build/tests.txt" 2>&1 || { cat "$build/tests.txt"; exit 1; }
  passed=$(sed -n 's/^\[  PASSED  \] \([0-9]*\) tests\?\.$/\1/p' "$build/tests.txt")
  skipped=$(sed -n 's/^\[  SKIPPED \] \([0-9]*\) tests\?.*/\1/p' "$build/tests.txt")
  table="$table$(printf '%-20s %6s %7s %7s' "$test" "$passed" "${skipped:-0}" $(($(date +%s) - start)))
"
done
printf '%-20s %6s %7s %7s\n%s' program passed skipped seconds "$table"
printf '%s' "$table" | awk '{ p += $2; s += $3; t += $4 } END { printf "%-20s %6d %7d %7d\n", "all", p, s, t }'

printf '#!/bin/sh\nexec %s %s "$@"\n' "$on_arm64" "$build/bin/podm" > "$build/podm"
chmod +x "$build/podm"
scripts/canonical_hashes --podm "$build/podm"
echo "the meshes of results/reference/canonical_hashes.json are the same on arm64"
