#!/bin/sh
# Checks that clang-format would not change any tracked C++ file (to repair: clang-format -i FILES), and that lines of
# Markdown (except tables), Python and scripts have at most 120 columns.
set -eu
cd "$(dirname "$0")/.."
git ls-files -z -- '*.h' '*.cpp' | xargs -0 -r clang-format --dry-run -Werror

too_long=$({ git ls-files -- '*.md' '*.py' '*.pyi'; git grep -lI '^#!' -- ':!third_party'; } | sort -u |
  LC_ALL=C.UTF-8 xargs -d '\n' grep -HnE '^[^|].{120,}$' || true)
[ -z "$too_long" ] || { printf '%s\n' "$too_long" "ci/format.sh: lines longer than 120 columns" >&2; exit 1; }
