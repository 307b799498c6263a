#!/usr/bin/env bash
# Installs what is missing, builds, and runs all tests; the last lines are the test runner's own summary.
#
#   scripts/test.sh                   everything, as users get it (preset release)
#   scripts/test.sh --tier unit       only tests of one label: unit, statistical, conformance, image, robustness, cli, package, browser
#   scripts/test.sh --preset asan     with another preset (dev, asan, tsan)
#   scripts/test.sh --match REGEX     only tests whose names match
#   scripts/test.sh --no-install      leave the machine's packages alone
set -euo pipefail
cd "$(dirname "$0")/.."

preset=release
install=true
filter=()
while (($#)); do
  case "$1" in
    --tier) filter+=(--label-regex "^${2:?--tier needs a name}\$"); shift 2 ;;
    --preset) preset=${2:?--preset needs a name}; shift 2 ;;
    --match) filter+=(--tests-regex "${2:?--match needs an expression}"); shift 2 ;;
    --no-install) install=false; shift ;;
    -h | --help) sed -n '2,8s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) echo "test.sh: unknown option $1 (known: --tier, --preset, --match, --no-install)" >&2; exit 2 ;;
  esac
done

if $install; then scripts/install-deps.sh; fi
started=$SECONDS
cmake --preset "$preset" >/dev/null
cmake --build --preset "$preset" -- --quiet
echo "built preset $preset in $((SECONDS - started)) s"
export ASAN_OPTIONS=${ASAN_OPTIONS:-detect_leaks=1:strict_string_checks=1:allocator_may_return_null=1}
export UBSAN_OPTIONS=${UBSAN_OPTIONS:-print_stacktrace=1}
export TSAN_OPTIONS=${TSAN_OPTIONS:-halt_on_error=1:second_deadlock_stack=1}
ctest --test-dir "build/$preset" --parallel "$(nproc)" --output-on-failure --no-tests=error "${filter[@]}"
