#!/bin/sh
# Every tracked C++ file is as clang-format makes it. Mend with: clang-format -i FILES
set -eu
cd "$(dirname "$0")/.."
git ls-files -z -- '*.h' '*.cpp' | xargs -0 -r clang-format --dry-run -Werror
