#!/bin/sh
# The performance gate: compares the mesher of the working tree with the mesher of the commit where the tree left the
# branch or commit $1 (main). Exits with 1 if the change may not be merged. Both are built in build-gate/.
set -eu
cd "$(dirname "$0")/.."

since=${1:-main}
base=$(git merge-base HEAD "$since") || { echo "ci/gate.sh: no commit of '$since' that HEAD began at" >&2; exit 2; }
rm -rf build-gate/base-sources
mkdir -p build-gate/base-sources
git archive "$base" | tar -x -C build-gate/base-sources

build() {  # sources, folder, targets
  sources=$1
  folder=$2
  shift 2
  cmake -S "$sources" -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE=Release
  cmake --build "$folder" --target "$@"
}
build build-gate/base-sources build-gate/base podm
build . build-gate/head podm podm-verify podm-bench

echo "== head against $base"
build-gate/head/bin/podm-bench gate --base build-gate/base/bin/podm
