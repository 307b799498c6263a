#!/usr/bin/env bash
# Formats all C++ files in place; with --check only lists those that are not formatted, and fails if there are any.
set -euo pipefail
cd "$(dirname "$0")/.."

formatter=$(command -v clang-format-19 || command -v clang-format)
mapfile -t files < <(find src include apps tests benchmarks templates -type f \( -name '*.h' -o -name '*.cpp' \) 2>/dev/null | sort)
case "${1:-}" in
  "") "$formatter" -i "${files[@]}" ;;
  --check) "$formatter" --dry-run --Werror "${files[@]}" && echo "${#files[@]} files are formatted" ;;
  *) echo "format.sh: unknown option $1 (known: --check)" >&2; exit 2 ;;
esac
