#!/usr/bin/env bash
# Builds the fuzz targets and runs each for a while, two at a time.
#
#   scripts/fuzz.sh [TARGET...]        all targets, or the named ones (gltf, image_exr, ...)
#
# SIGHTLINE_FUZZ_SECONDS (60) is the time for each, SIGHTLINE_FUZZ_JOBS (2) how many run at once. New inputs are kept in
# build/fuzz/corpus/TARGET, crashes in build/fuzz/crashes; to replay one: build/fuzz/tests/fuzz/fuzz_TARGET FILE.
set -euo pipefail
cd "$(dirname "$0")/.."

seconds=${SIGHTLINE_FUZZ_SECONDS:-60}
jobs=${SIGHTLINE_FUZZ_JOBS:-2}
build=build/fuzz

cmake --preset fuzz >/dev/null
cmake --build --preset fuzz --target fuzz_targets
python3 tests/fuzz/make_corpus.py "$build/seeds"

names=("$@")
if ((${#names[@]} == 0)); then
  for program in "$build"/tests/fuzz/fuzz_*; do
    if [[ -f $program && -x $program ]]; then names+=("${program##*/fuzz_}"); fi
  done
fi
mkdir -p "$build/crashes" "$build/logs"

fuzz_one() {
  local name=$1 limit_mib=2048
  mkdir -p "$build/corpus/$name" "$build/seeds/$name"
  # A reader may take a small multiple of its input; with inputs below 64 KiB, 2 GiB with the sanitizers' own is far beyond that. One input
  # may take 30 s under the sanitizers on a loaded machine; the seed is fixed so that runs start alike.
  if "$build/tests/fuzz/fuzz_$name" -max_total_time="$seconds" -timeout=30 -seed=1 -rss_limit_mb=$limit_mib -malloc_limit_mb=512 -max_len=65536 \
    -artifact_prefix="$build/crashes/$name-" -print_final_stats=1 "$build/corpus/$name" "$build/seeds/$name" >"$build/logs/$name.log" 2>&1; then
    echo "fuzz $name: $(grep -o 'number_of_executed_units: .*' "$build/logs/$name.log" | cut -d' ' -f2) inputs, no failure"
  else
    echo "fuzz $name: FAILED; the end of $build/logs/$name.log:"
    tail -n 40 "$build/logs/$name.log"
    return 1
  fi
}
export -f fuzz_one
export build seconds

if ((${#names[@]} == 0)); then
  echo "fuzz: there are no targets" >&2
  exit 1
fi
printf '%s\n' "${names[@]}" | xargs -P "$jobs" -I{} bash -euo pipefail -c 'fuzz_one {}'
