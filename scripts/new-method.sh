#!/usr/bin/env bash
# Starts a method from templates/method: scripts/new-method.sh NAME, with words joined by hyphens, such as visibility-cache.
set -euo pipefail
cd "$(dirname "$0")/.."

name=${1:-}
if [[ ! $name =~ ^[a-z][a-z0-9]*(-[a-z0-9]+)*$ || $# -ne 1 ]]; then
  echo "usage: scripts/new-method.sh NAME (lower-case words joined by hyphens)" >&2
  exit 2
fi
folder=${name//-/_}
if [[ -e src/methods/$folder ]]; then
  echo "new-method.sh: src/methods/$folder exists already" >&2
  exit 1
fi
type=$(sed -E 's/(^|-)([a-z0-9])/\U\2/g' <<<"$name")

cp -r templates/method "src/methods/$folder"
# The name appears as ExampleMethod, methods/example/, build_example_bake, and in words.
sed -i -e "s/Example/$type/g" -e "s/build_example_bake/build_${folder}_bake/g" -e "s#methods/example/#methods/$folder/#g" \
  -e "s/\"example\"/\"$name\"/g" -e "s/the example method/the method $name/gI" -e "s/# $type method/# $name/" "src/methods/$folder"/*

python3 - "$name" "$folder" "$type" <<'PYTHON'
import pathlib
import re
import sys

name, folder, kind = sys.argv[1:]
listing = pathlib.Path("src/methods/CMakeLists.txt")
text = listing.read_text()
sources = "".join(f"    {folder}/{file}.cpp\n" for file in ("bake", "kernel", "method"))
listing.write_text(text.replace("  PRIVATE_LIBS", sources + "  PRIVATE_LIBS", 1))

registry = pathlib.Path("src/methods/registry.cpp")
text = registry.read_text()
text = text.replace('#include "methods/reference/method.h"\n', f'#include "methods/reference/method.h"\n#include "methods/{folder}/method.h"\n', 1)
text = text.replace("  static const ReferenceMethod reference;\n", f"  static const ReferenceMethod reference;\n  static const {kind}Method {folder};\n", 1)
text = re.sub(r"(static const std::array<const Method\*, )(\d+)(> table = \{)([^}]*)\}", lambda m: f"{m[1]}{int(m[2]) + 1}{m[3]}{m[4]}, &{folder}}}", text, count=1)
registry.write_text(text)
PYTHON
if command -v clang-format-19 >/dev/null; then clang-format-19 -i src/methods/registry.cpp "src/methods/$folder"/*.h "src/methods/$folder"/*.cpp; fi
echo "src/methods/$folder is registered; next: docs/adding-a-method.md"
