#!/bin/sh
# Keeps the arrows between the rooms of the tree: prints file:line of each include that breaks one; exits 1 then.
set -euf  # no file name patterns: those of may_include are for `case`
cd "$(dirname "$0")/.."

# Rooms whose files a file of room $1 may include besides its own. include/ holds podm/*.h; those of a whole run are a
# room of their own, podm: the rooms below the algorithms need small headers of the public API alone.
ground="mesher/geometry mesher/runtime mesher/include"
label_function="mesher/smoothing mesher/isosurface mesher/image $ground"
store="mesher/workers mesher/refine mesher/delaunay mesher/octree mesher/sizing $label_function podm"
may_include() {
  case $1 in
    mesher/geometry | mesher/runtime | mesher/include) ;;
    podm | mesher/files) echo mesher/include ;;
    mesher/phantoms | mesher/octree | mesher/delaunay) echo "$ground" ;;
    mesher/image) echo mesher/files "$ground" ;;
    mesher/isosurface) echo mesher/image "$ground" ;;
    mesher/smoothing) echo mesher/isosurface mesher/image "$ground" ;;
    mesher/sizing) echo mesher/isosurface mesher/image "$ground" podm ;;
    mesher/refine) echo mesher/delaunay mesher/sizing mesher/isosurface mesher/image "$ground" ;;
    mesher/workers) echo mesher/refine mesher/delaunay mesher/runtime mesher/include ;;
    mesher/io) echo mesher/files mesher/runtime mesher/include ;;
    mesher/algorithms) echo "$store" ;;
    mesher/run) echo mesher/prediction mesher/replay mesher/optimize mesher/algorithms mesher/io mesher/files "$store" ;;
    mesher/distributed) echo mesher/run mesher/prediction mesher/replay mesher/algorithms mesher/io mesher/files "$store" ;;
    mesher/cli/foreign_mesh) echo mesher/cli mesher/io mesher/geometry mesher/include verifiers ;;  # podm convert
    mesher/*) echo "mesher/* podm" ;;  # the command line, whole-mesher tests
    examples/*) echo mesher/include podm ;;
    harness/ground) echo mesher/runtime ;;  # it asks the system as the mesher does, whom it knows as a program
    harness/process) echo harness/ground mesher/runtime ;;
    harness/options) echo harness/process harness/ground mesher/runtime ;;
    harness/rows) echo harness/options harness/process harness/ground ;;
    harness/machine) echo harness/rows harness/options harness/process harness/ground mesher/runtime ;;
    harness/trials) echo harness/machine harness/rows harness/options harness/process harness/ground mesher/runtime ;;
    harness/experiments | harness/gate) echo harness/trials harness/machine harness/rows harness/options harness/process \
      harness/ground mesher/runtime ;;
    harness/*) echo "harness/* mesher/runtime" ;;  # the program, tests
    verifiers) ;;  # they know the mesher by its files alone
  esac
}

# Sets `part` to the room of a file. Tests and benchmarks see all of their program.
set_part_of() {
  part=${1#*/}
  part=${1%%/*}/${part%%/*}  # its first two folders
  case $1 in
    mesher/include/podm/mesh_image.h | mesher/include/podm/meshing_*.h) part=podm ;;
    mesher/*/tests/*) part=mesher/tests ;;
    harness/*/tests/*) part=harness/tests ;;
    mesher/main*.cpp) part=mesher/cli ;;
    mesher/cli/commands/foreign_mesh.cpp) part=mesher/cli/foreign_mesh ;;  # alone reads with the verifier's readers
    harness/errors.h) part=harness/ground ;;
    mesher/*/* | harness/* | examples/*) ;;
    *) part=${1%%/*} ;;
  esac
}

# Sets `target` to the file of ours that `#include "$2"` or <$2> in file $1 means; to nothing when it is not ours.
set_target_of() {
  for folder in "${1%/*}" "${1%%/*}" mesher mesher/include verifiers harness; do  # its own part's first
    target=$folder/$2
    [ ! -f "$target" ] || return 0
  done
  target=""
}

is_allowed() {  # $1 includes $2, both rooms
  [ "$1" != "$2" ] || return 0
  for pattern in $(may_include "$1"); do
    # shellcheck disable=SC2254  # a pattern
    case $2 in $pattern) return 0 ;; esac
  done
  return 1
}

includes=$(git grep -nE '^[[:space:]]*#[[:space:]]*include[[:space:]]*["<]' -- '*.h' '*.cpp')
violations=$(echo "$includes" | while IFS=: read -r file line text; do
  name=${text#*[\"<]}
  name=${name%%[\">]*}
  case $name in ../* | */../*) echo "$file:$line: a path that goes up: $name" ;; esac
  set_target_of "$file" "$name"
  [ -n "$target" ] || continue
  set_part_of "$file"
  from=$part
  set_part_of "$target"
  is_allowed "$from" "$part" || echo "$file:$line: $from may not include $target"
done)
[ -z "$violations" ] || { echo "$violations"; exit 1; }
