#!/usr/bin/env bash
# Runs clang-tidy on C++ files.
#
#   scripts/tidy.sh             files changed against the branch main, or, on main itself, by the last commit
#   scripts/tidy.sh --all       all files of src/, apps/ and tools/
#   scripts/tidy.sh FILE...     these files
#
# Uses the compile commands of build/dev, which it configures if need be.
set -euo pipefail
cd "$(dirname "$0")/.."

tidy=$(command -v clang-tidy-19 || command -v clang-tidy)
case "${1:-}" in
  --all) mapfile -t files < <(find src apps tools -name '*.cpp' | sort) ;;
  "")
    base=HEAD~1
    if [[ $(git rev-parse --abbrev-ref HEAD) != main ]] && git rev-parse --verify -q main >/dev/null; then base=$(git merge-base main HEAD); fi
    if ! git rev-parse --verify -q "$base" >/dev/null; then
      echo "tidy: no earlier commit to compare with (use --all)"
      exit 0
    fi
    mapfile -t files < <(git diff --name-only --diff-filter=d "$base" -- 'src/*.cpp' 'apps/*.cpp' 'tools/*.cpp')
    ;;
  *) files=("$@") ;;
esac
if ((${#files[@]} == 0)); then
  echo "tidy: nothing changed"
  exit 0
fi
commands=build/dev/compile_commands.json
# Commands older than a list of sources lack what was added since.
if [[ ! -f $commands || -n $(find CMakeLists.txt cmake src apps tests tools \( -name CMakeLists.txt -o -name '*.cmake' \) -newer $commands -print -quit) ]]; then
  cmake --preset dev >/dev/null
fi
# clang does not know GCC's warning options that stand in the compile commands.
printf '%s\0' "${files[@]}" | xargs -0 -P "$(nproc)" -n 4 "$tidy" -p build/dev --quiet --warnings-as-errors='*' \
  --extra-arg=-Wno-unknown-warning-option 2>&1 | { grep -v -E '^[0-9]+ warnings? (generated|treated)|^Suppressed|^Use -header-filter' || true; }
echo "tidy: ${#files[@]} files are clean"
