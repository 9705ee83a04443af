#!/bin/sh
# Builds the libFuzzer targets and runs each for FUZZ_SECONDS (15) from its seeds, the folder corpus/TARGET beside
# its source where there is one. A finding exits 1; the input that shows it stays in build-fuzz/findings/.
set -eu
cd "$(dirname "$0")/.."

cmake -S . -B build-fuzz -G Ninja -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ \
  -DCMAKE_CXX_FLAGS="-include $PWD/ci/itk_with_clang.h" -DCMAKE_BUILD_TYPE=RelWithDebInfo \
  -DPODM_BUILD_FUZZERS=ON -DPODM_SANITIZE=address,undefined
sources=$(git ls-files -- '*/fuzz_*.cpp')
targets=$(for source in $sources; do basename "$source" .cpp; done)
# shellcheck disable=SC2086  # lists of words, here and below
cmake --build build-fuzz --target $targets

mkdir -p build-fuzz/findings
for source in $sources; do
  target=$(basename "$source" .cpp)
  corpus=build-fuzz/corpus/$target
  mkdir -p "$corpus"  # what the fuzzer learns stays here, the seeds are read only
  seeds=$(dirname "$source")/corpus/$target
  [ -d "$seeds" ] || seeds=""
  echo "== $target"
  # shellcheck disable=SC2086
  "build-fuzz/bin/$target" "$corpus" $seeds -max_total_time="${FUZZ_SECONDS:-15}" -timeout=10 -rss_limit_mb=4096 \
    -artifact_prefix="build-fuzz/findings/$target-" -print_final_stats=0 -verbosity=0
done
