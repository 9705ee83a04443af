#!/bin/sh
# Usage: ci/fuzz.sh [--merge] [TARGET...]
# Builds the libFuzzer targets and runs each target (all, or those given) for FUZZ_SECONDS (15), or for FUZZ_RUNS
# executions. A run starts from the folder corpus/TARGET beside the target's source and from the inputs that earlier
# runs learnt. Prints a table of executions at the end. On a finding the script exits with 1; the input stays in
# build-fuzz/findings/. FUZZ_SEED (1) seeds the inputs, therefore a change that finds nothing new gives the same result
# tomorrow. FUZZ_SEED=0 draws a new seed each time.
#
# New inputs that take new branches stay in build-fuzz/corpus/. With --merge nothing is fuzzed: the corpora of the tree
# are rebuilt from their own inputs and from build-fuzz/corpus/. ci/choose_inputs keeps the named inputs and, up to
# MOST_INPUTS (30) in all, the inputs that take most branches. The other inputs stay in build-fuzz/corpus/.
set -eu
cd "$(dirname "$0")/.."
is_merge=""
[ "${1-}" != --merge ] || { is_merge=1; shift; }

build="build-fuzz"
longest=4096  # largest input, bytes
sources=$(git ls-files -- '*/fuzz_*.cpp')
targets=$(for source in $sources; do basename "$source" .cpp; done)
for asked; do
  # shellcheck disable=SC2086  # a list of words, here and below
  echo "$targets" | grep -qx "$asked" || { echo "ci/fuzz.sh: no target '$asked':" $targets >&2; exit 2; }
done
# shellcheck disable=SC2086
[ $# -gt 0 ] || set -- $targets

cmake -S . -B $build -G Ninja -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ \
  -DCMAKE_CXX_FLAGS="-include $PWD/ci/itk_with_clang.h -O1 -gline-tables-only -DNDEBUG" -DCMAKE_BUILD_TYPE=None \
  -DPODM_BUILD_FUZZERS=ON -DPODM_UNITE=ON -DPODM_SANITIZE=address,undefined
cmake --build $build --target "$@"

# The readers' files are kept in memory. Allocation stacks keep few frames, which is faster.
TMPDIR=$(mktemp -d "$([ -w /dev/shm ] && echo /dev/shm || echo "${TMPDIR:-/tmp}")/podm-fuzz-XXXXXX")
trap 'rm -rf "$TMPDIR"' EXIT
trap 'exit 130' INT TERM
export TMPDIR
export ASAN_OPTIONS=malloc_context_size=6:quarantine_size_mb=16:"${ASAN_OPTIONS-}"
export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1:"${UBSAN_OPTIONS-}"

corpus_of() { echo "$(dirname "$(echo "$sources" | grep "/$1\.cpp$")")/corpus/$1"; }
files_in() { find "$1" -type f | wc -l; }
bytes_in() { find "$1" -type f -printf '%s\n' | awk '{ sum += $1 } END { print sum + 0 }'; }
statistic() { sed -n "s/^stat::$1: *//p" "$2"; }

# Lists the branches that each input takes. libFuzzer would add its own choice to the first folder, which is scratch.
merge() {
  target=$1 seeds=$(corpus_of "$1") learnt=$build/corpus/$1 control=$build/log/$1.control
  mkdir -p "$seeds" "$learnt" "$TMPDIR/merged/$1"
  rm -f "$control"
  $build/bin/"$target" -set_cover_merge=1 -merge_control_file="$control" -use_counters=0 -print_funcs=0 \
    -max_len=$longest -timeout=30 "$TMPDIR/merged/$1" "$seeds" "$learnt" \
    > $build/log/merge 2>&1 || { tail -n 30 $build/log/merge; exit 1; }
  find "$seeds" -type f -exec cp -n -t "$learnt" {} +
  ci/choose_inputs "$control" "$seeds" --most "${MOST_INPUTS:-30}"
}

fuzz() {
  target=$1 seeds=$(corpus_of "$1") found=$build/corpus/$1 log=$build/log/$1
  mkdir -p "$seeds" "$found"
  start=$(date +%s)
  if [ -n "${FUZZ_RUNS-}" ]; then set -- -runs="$FUZZ_RUNS" -max_total_time="${FUZZ_SECONDS:-0}"
  else set -- -max_total_time="${FUZZ_SECONDS:-15}"; fi
  $build/bin/"$target" "$found" "$seeds" "$@" -seed="${FUZZ_SEED:-1}" -max_len=$longest -timeout=30 \
    -rss_limit_mb=4096 -artifact_prefix=$build/findings/"$target"- -print_final_stats=1 -verbosity=0 -print_funcs=0 \
    > "$log" 2>&1 ||
    { tail -n 60 "$log"; echo "ci/fuzz.sh: $target found something, see $log and $build/findings/" >&2; exit 1; }
  runs=$(statistic number_of_executed_units "$log")
  printf '%s %s %s\n' "$target" "$runs" $(($(date +%s) - start)) >> $build/log/table
}

mkdir -p $build/findings $build/log
: > $build/log/table
for target; do
  echo "== $target"
  if [ -n "$is_merge" ]; then merge "$target"; echo "$target - -" >> $build/log/table; else fuzz "$target"; fi
done

printf '\n%-26s %12s %8s %9s %8s %8s\n' reader executions seconds per_s corpus bytes
while read -r target runs seconds; do
  corpus=$(corpus_of "$target")
  per_second=-
  [ "$runs" = - ] || per_second=$((runs / (seconds > 0 ? seconds : 1)))
  printf '%-26s %12s %8s %9s %8s %8s\n' "$target" "$runs" "$seconds" "$per_second" "$(files_in "$corpus")" \
    "$(bytes_in "$corpus")"
done < $build/log/table
awk '{ runs += $2; seconds += $3 } END { printf "%-26s %12d %8d\n", "all", runs, seconds }' $build/log/table
