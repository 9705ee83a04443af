#!/bin/sh
# How often the gate's answer about seconds errs on this machine: records $1 (300) more rounds of the mesher of build
# folder $2 (build) with planted slowdowns, and tries the gate's own rule on all recorded rounds. Prints the counts and
# keeps rounds and counts in folder $3 (results/runs/gate). $1 = 0 tries the rule again on the rounds that are there.
set -eu
cd "$(dirname "$0")/.."
rounds=${1:-300}
build=${2:-build}
folder=${3:-results/runs/gate}

mkdir -p "$folder"
"$build/bin/podm-bench" gate-evidence "$folder/rounds.jsonl" --rounds "$rounds" --json "$folder/tries.jsonl"
