#!/bin/sh
# Keeps the arrows between the parts of the tree: prints file:line of each include that breaks one; exits 1 then.
set -euf  # no file name patterns: those of may_include are for `case`
cd "$(dirname "$0")/.."

# Folders whose files a file of folder $1 may include besides its own. include/ holds podm/*.h; those of a whole run are
# a part of their own, podm: what layers below the algorithms need of the public API stands in small headers.
may_include() {
  case $1 in
    mesher/geometry | mesher/runtime | mesher/include) ;;
    mesher/files) echo mesher/include ;;
    mesher/image) echo mesher/files mesher/geometry mesher/runtime mesher/include ;;
    mesher/octree) echo mesher/geometry mesher/runtime mesher/include ;;
    mesher/delaunay) echo mesher/geometry mesher/runtime mesher/include ;;
    mesher/refine) echo mesher/delaunay mesher/image mesher/geometry mesher/runtime mesher/include ;;
    mesher/workers) echo mesher/refine mesher/delaunay mesher/runtime mesher/include ;;
    mesher/io) echo mesher/files mesher/runtime mesher/include ;;
    mesher/algorithms) echo mesher/workers mesher/refine mesher/delaunay mesher/octree mesher/image mesher/geometry \
      mesher/runtime mesher/include podm ;;
    mesher/optimize) echo mesher/algorithms mesher/workers mesher/refine mesher/delaunay mesher/geometry \
      mesher/runtime mesher/include podm ;;
    mesher/distributed) echo mesher mesher/algorithms mesher/workers mesher/refine mesher/delaunay mesher/octree \
      mesher/image mesher/io mesher/files mesher/geometry mesher/runtime mesher/include podm ;;
    podm) echo mesher/include ;;
    examples/*) echo mesher/include podm ;;
    mesher) echo mesher/optimize mesher/algorithms mesher/workers mesher/refine mesher/delaunay mesher/octree \
      mesher/image mesher/io mesher/files mesher/geometry mesher/runtime mesher/include podm ;;  # the phases of a run
    mesher/cli/foreign_mesh) echo mesher/cli mesher/io mesher/geometry mesher/include verifiers ;;  # podm convert
    mesher/*) echo "mesher mesher/* podm" ;;  # the command line, whole-mesher tests
    harness) echo mesher/runtime ;;  # asks the system as the mesher does, whom it knows as a program and by its files
    verifiers) ;;                    # they know it by its files alone
  esac
}

# Sets `part` to the part of the tree that a file belongs to. Tests and benchmarks of the mesher see all of it.
set_part_of() {
  part=${1#*/}
  part=${1%%/*}/${part%%/*}  # its first two folders
  case $1 in
    mesher/include/podm/mesh_image.h | mesher/include/podm/meshing_*.h) part=podm ;;
    mesher/*/tests/*) part=mesher/tests ;;
    mesher/main*.cpp) part=mesher/cli ;;
    mesher/cli/foreign_mesh.cpp) part=mesher/cli/foreign_mesh ;;  # alone reads with the verifier's readers
    mesher/*/* | examples/*) ;;
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

is_allowed() {  # $1 includes $2, both parts of the tree
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
