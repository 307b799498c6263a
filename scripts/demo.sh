#!/usr/bin/env bash
# From a fresh clone to pictures: installs what building needs, builds, renders built-in scenes with every method, writes out/index.html.
#
#   scripts/demo.sh                 about ten minutes on two cores, most of it compiling; again: under two
#   scripts/demo.sh --no-install    leave the machine's packages alone
set -euo pipefail
cd "$(dirname "$0")/.."

install=true
for argument in "$@"; do
  case "$argument" in
    --no-install) install=false ;;
    -h | --help) sed -n '2,5s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) echo "demo.sh: unknown option $argument (known: --no-install)" >&2; exit 2 ;;
  esac
done

if $install; then scripts/install-deps.sh --demo; fi
started=$SECONDS
cmake --preset demo >/dev/null
cmake --build --preset demo
echo "demo: built in $((SECONDS - started)) s"

sightline=build/demo/apps/sightline/sightline
out=out
mkdir -p "$out"
# The methods come from the program itself, so that a new one joins the demo by being registered.
list_methods() {
  "$sightline" methods --json | python3 -c 'import json, sys
for method in json.load(sys.stdin)["methods"]:
    if sys.argv[1] == "all" or not method["needs_bake"]: print(method["name"])' "$1"
}
mapfile -t all_methods < <(list_methods all)
# What is precomputed for every vertex is for models of some ten thousand of them.
mapfile -t without_bakes < <(list_methods without-bakes)
methods=("${all_methods[@]}")

pictures=()
# show NAME SCENE SPP OPTION...: a picture with few samples by every method, beside the reference with many, and a report on each pair.
show() {
  local name=$1 scene=$2 spp=$3 method
  shift 3
  local truth="$out/$name-truth.exr" others=()
  "$sightline" render "$scene" "$@" --size 640x480 --spp "$((spp * 8))" --aov surface -o "$truth" -o "$out/$name-truth.png"
  for method in "${methods[@]}"; do
    # A method may refuse a scene that it does not suit; it says so, and the demo goes on.
    if "$sightline" render "$scene" "$@" --size 640x480 --spp "$spp" --bake-dir "$out/bakes" --method "$method" -o "$out/$name-$method.exr" -o "$out/$name-$method.png"; then
      others+=("$out/$name-$method.exr")
    fi
  done
  "$sightline" compare "$truth" "${others[@]}" --html "$out/$name-truth.html" --json "$out/$name-metrics.json"
  pictures+=("$truth" "${others[@]}")
}

show cornell builtin:cornell 16
show pair builtin:pair 4 --frame 10 --fps 30
methods=("${without_bakes[@]}")
show hairball builtin:room,content=builtin:hairball 4
show isosurface builtin:isosurface 8
show plant builtin:plant 8

"$sightline" gallery "${pictures[@]}" --title "Sightline: built-in scenes, every method" -o "$out/index.html"
echo "demo: done in $SECONDS s; open $out/index.html"
