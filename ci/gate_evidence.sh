#!/bin/sh
# Measures how often the gate's answer about seconds is wrong on this machine. Records $1 (300) more rounds of the
# mesher in build folder $2 (build) with planted slowdowns, then applies the gate's own rule to all recorded rounds.
# Prints the counts and keeps rounds and counts in folder $3 (results/runs/gate). $1 = 0 only applies the rule to the
# rounds recorded so far.
set -eu
cd "$(dirname "$0")/.."
rounds=${1:-300}
build=${2:-build}
folder=${3:-results/runs/gate}

mkdir -p "$folder"
"$build/bin/podm-bench" gate-evidence "$folder/rounds.jsonl" --rounds "$rounds" --json "$folder/tries.jsonl"
