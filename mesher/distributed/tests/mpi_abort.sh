#!/bin/sh
# Usage: mpi_abort.sh MPIRUN PROGRAM
# A rank that throws while others wait ends all ranks with its exit code and prints its number.
set -u
output=$("$1" -n 3 "$2" --throw-on-rank 1 2>&1)
code=$?
echo "$output"
[ "$code" = 2 ] || { echo "exit code $code, not 2"; exit 1; }
echo "$output" | grep -q "^rank 1 of 3: planted$"
