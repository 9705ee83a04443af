#!/bin/sh
# How often the gate's seconds err here: $2 (20) tries of mesher $1 against itself, and as many against itself made to
# take 1.10 times its processor seconds. Prints the answers and counts them; ci/README.md keeps them.
set -eu
cd "$(dirname "$0")/.."
podm=$(realpath "$1")
tries=${2:-20}
bench=$(dirname "$podm")/podm-bench

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
printf '#!/bin/sh\nexec %s/ci/gate_planted_slowdown.py 1.10 %s "$@"\n' "$PWD" "$podm" > "$folder/slower"
chmod +x "$folder/slower"

grep -m1 "model name" /proc/cpuinfo
for head in "$podm" "$folder/slower"; do
  blocks=0
  for try in $(seq "$tries"); do
    code=0
    "$bench" gate --tier 2 --base "$podm" --head "$head" --order-seed "$try" > "$folder/said" || code=$?
    [ "$code" -le 1 ] || exit "$code"
    blocks=$((blocks + code))
    grep head/base "$folder/said"
  done
  echo "$(basename "$head"): $blocks of $tries tries blocked; load $(cut -d' ' -f1-3 /proc/loadavg)"
done
