#!/bin/sh
# Usage: ci/mpich.sh [FOLDER]
# Builds podm-mpi and podm-verify-mpi with MPICH in FOLDER/build-mpich (default: ./build-mpich). The other checks use
# the MPI that CMake finds first, which is Open MPI on Debian. Runs the tests of communication and of both programs
# under MPICH's mpiexec. Exits with 1 if one fails or none runs.
set -eu
cd "$(dirname "$0")/.."
build=${1:-.}/build-mpich

cmake -S . -B "$build" -G Ninja -DMPI_C_COMPILER=mpicc.mpich -DMPIEXEC_EXECUTABLE="$(command -v mpiexec.mpich)" \
  -DPODM_BUILD_TESTS=ON
cmake --build "$build" --target podm podm-mpi podm-verify podm-verify-mpi \
  mpi_communication_tests verify_mpi_tests
ldd "$build/bin/podm-mpi" | grep -q libmpich || { echo "podm-mpi is not linked to MPICH"; exit 1; }
ctest --test-dir "$build" --output-on-failure --no-tests=error -R '^(mpi\.|podm\.ranks$|verify\.mpi_|verify\.on_ranks$)'
