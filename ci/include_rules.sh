#!/bin/sh
# Checks which folders of the tree may include which, and which may include headers of the operating system and of the
# processor or read the system's files. Prints file:line of each forbidden include and exits with 1 then.
set -euf  # no expansion of file names: the patterns of may_include are for `case`
cd "$(dirname "$0")/.."

# Prints the rooms (folders) that a file of room $1 may include besides its own. include/ holds podm/*.h. Its headers
# about a whole run form the room podm, because the rooms below the algorithms need only the small public headers.
ground="mesher/geometry mesher/runtime mesher/include"
label_function="mesher/lines mesher/smoothing mesher/isosurface mesher/image $ground"
store="mesher/workers mesher/refine mesher/topology mesher/delaunay mesher/octree mesher/sizing $label_function podm"
may_include() {
  case $1 in
    mesher/geometry | mesher/runtime | mesher/include) ;;
    podm | mesher/files) echo mesher/include ;;
    mesher/phantoms | mesher/octree | mesher/delaunay) echo "$ground" ;;
    mesher/image) echo mesher/files "$ground" ;;
    mesher/isosurface) echo mesher/image "$ground" ;;
    mesher/smoothing) echo mesher/isosurface mesher/image "$ground" ;;
    mesher/lines) echo mesher/isosurface mesher/image "$ground" ;;
    mesher/sizing) echo mesher/isosurface mesher/image "$ground" podm ;;
    mesher/refine) echo mesher/delaunay mesher/sizing mesher/lines mesher/isosurface mesher/image "$ground" ;;
    mesher/topology) echo mesher/delaunay mesher/image "$ground" ;;
    mesher/workers) echo mesher/refine mesher/delaunay mesher/runtime mesher/include ;;
    mesher/values) echo mesher/image "$ground" ;;
    mesher/io) echo mesher/files mesher/runtime mesher/include ;;
    mesher/algorithms) echo "$store" ;;
    mesher/run) echo mesher/prediction mesher/replay mesher/optimize mesher/algorithms mesher/io mesher/files \
      "$store" ;;
    mesher/distributed) echo mesher/run mesher/prediction mesher/replay mesher/algorithms mesher/io mesher/files \
      "$store" ;;
    mesher/cli/foreign_mesh) echo mesher/cli mesher/io mesher/geometry mesher/include verifiers ;;  # podm convert
    mesher/*) echo "mesher/* podm" ;;  # the command line, tests of the whole mesher
    examples/*) echo mesher/include podm ;;
    harness/ground) echo mesher/runtime ;;  # it queries the system with the mesher's code
    harness/process) echo harness/ground mesher/runtime ;;
    harness/options) echo harness/process harness/ground mesher/runtime ;;
    harness/rows) echo harness/options harness/process harness/ground ;;
    harness/machine) echo harness/rows harness/options harness/process harness/ground mesher/runtime ;;
    harness/trials) echo harness/machine harness/rows harness/options harness/process harness/ground mesher/runtime ;;
    harness/experiments | harness/gate) echo harness/trials harness/machine harness/rows harness/options \
      harness/process harness/ground mesher/runtime ;;
    harness/submissions) echo harness/experiments harness/trials harness/machine harness/rows harness/options \
      harness/process harness/ground mesher/runtime ;;
    harness/*) echo "harness/* mesher/runtime" ;;  # the program, tests
    verifiers) ;;  # the verifiers know the mesher only by its files
  esac
}

# Sets `part` to the room of a file. Tests may include all of their program.
set_part_of() {
  part=${1#*/}
  part=${1%%/*}/${part%%/*}  # the first two folders
  case $1 in
    mesher/include/podm/mesh_image.h | mesher/include/podm/meshing_*.h) part=podm ;;
    mesher/*/tests/*) part=mesher/tests ;;
    harness/*/tests/*) part=harness/tests ;;
    mesher/main*.cpp) part=mesher/cli ;;
    mesher/cli/commands/foreign_mesh.cpp) part=mesher/cli/foreign_mesh ;;  # it alone uses the verifier's readers
    harness/errors.h) part=harness/ground ;;
    mesher/*/* | harness/* | examples/*) ;;
    *) part=${1%%/*} ;;
  esac
}

# Sets `target` to the project's file that `#include "$2"` or <$2> in file $1 means, or to "" if it is not the
# project's.
set_target_of() {
  for folder in "${1%/*}" "${1%%/*}" mesher mesher/include verifiers harness; do  # the file's own part first
    target=$folder/$2
    [ ! -f "$target" ] || return 0
  done
  target=""
}

is_allowed() {  # $1 may include $2; both are rooms
  [ "$1" != "$2" ] || return 0
  for pattern in $(may_include "$1"); do
    # shellcheck disable=SC2254  # a pattern
    case $2 in $pattern) return 0 ;; esac
  done
  return 1
}

# Sets `of_system` to what a port to another system or processor has to replace in a file that includes <$1>: "system",
# "processor" or "".
set_of_system() {
  case $1 in
    sys/* | linux/* | net/* | netinet/* | arpa/* | asm/*) of_system=system ;;
    dirent.h | dlfcn.h | fcntl.h | malloc.h | poll.h | pthread.h | sched.h | signal.h) of_system=system ;;
    spawn.h | syscall.h | termios.h | ucontext.h | unistd.h | hwloc.h | hwloc/* | numa*.h) of_system=system ;;
    *intrin.h | arm_*.h) of_system=processor ;;
    *) of_system="" ;;
  esac
}

# docs/reference/porting.md lists these folders. Tests and fuzz targets test the system's behaviour, too.
may_include_system() {  # file $1 may include headers of the kind $2
  case $2:$1 in
    processor:mesher/runtime/*) ;;
    processor:*) return 1 ;;
    *:*/tests/* | *:*/fuzz/* | *:ci/*) ;;
    *:mesher/runtime/* | *:mesher/files/* | *:mesher/cli/processes/* | *:mesher/cli/reports/*) ;;
    *:harness/* | *:verifiers/readers/* | *:verifiers/report/* | *:verifiers/main.cpp) ;;
    *:cmake/required_processor.cpp) ;;
    *) return 1 ;;
  esac
}

includes=$(git grep -nE '^[[:space:]]*#[[:space:]]*include[[:space:]]*["<]' -- '*.h' '*.cpp')
violations=$(echo "$includes" | while IFS=: read -r file line text; do
  name=${text#*[\"<]}
  name=${name%%[\">]*}
  case $name in ../* | */../*) echo "$file:$line: a path that goes up: $name" ;; esac
  set_of_system "$name"
  [ -z "$of_system" ] || may_include_system "$file" $of_system ||
    echo "$file:$line: a header of the $of_system: $name; docs/reference/porting.md lists who may include it"
  set_target_of "$file" "$name"
  [ -n "$target" ] || continue
  set_part_of "$file"
  from=$part
  set_part_of "$target"
  is_allowed "$from" "$part" || echo "$file:$line: $from may not include $target"
done
git grep -nE '"/(proc|sys)/' -- 'mesher/*.h' 'mesher/*.cpp' ':!*/tests/*' ':!mesher/runtime' ':!mesher/cli/processes' |
  sed -E 's/^([^:]*:[^:]*:).*/\1 a file of the system: docs\/reference\/porting.md lists who may read it/')
[ -z "$violations" ] || { echo "$violations"; exit 1; }
