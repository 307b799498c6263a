#!/usr/bin/env python3
"""Checks the house rules that a compiler does not: run without arguments from anywhere; exit code 1 and one line a finding if any is broken.

  layers      an #include in src/ names the same layer or an earlier one of SIGHTLINE_LAYERS; methods do not include each other
  headers     src/ headers have #pragma once; public headers include only the standard library and sightline/
  sources     every .cpp of src/ is listed in a CMakeLists.txt
  citations   every key cited in a comment as [Key2007, ...] has an entry in docs/references.bib or docs/references.d/*.bib
  scripts     every shell script is executable and stops at errors

  --compile-headers   also compiles every header of src/ and include/ alone (slow; needs build/*/compile_commands.json)
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
INCLUDE = re.compile(r'^\s*#\s*include\s+([<"])([^>"]+)[>"]', re.MULTILINE)
# An author and a year make a key: [Walter2007], [Walter2007, Eq. 20], [Heitz2018, §3; Dupuy2023].
CITATION = re.compile(r"\[((?:[A-Z][A-Za-z]+(?:19|20)\d\d[a-z]?)(?:[,;][^\]\n]*)?)\]")
KEY = re.compile(r"\b[A-Z][A-Za-z]+(?:19|20)\d\d[a-z]?\b")
CODE_ENDINGS = {".h", ".cpp", ".md", ".js", ".py"}


def relative(path):
    return path.relative_to(ROOT).as_posix()


def line_of(text, position):
    return text.count("\n", 0, position) + 1


def layer_names():
    match = re.search(r"set\(SIGHTLINE_LAYERS ([^)]*)\)", (ROOT / "src/CMakeLists.txt").read_text())
    return match.group(1).split()


def source_files(*folders):
    for folder in folders:
        for path in sorted((ROOT / folder).rglob("*")):
            if path.is_file() and path.suffix in (".h", ".cpp"):
                yield path


def check_layers():
    layers = layer_names()
    for path in source_files("src"):
        own = path.relative_to(ROOT / "src").parts
        if own[0] not in layers:
            yield f"{relative(path)}: the folder {own[0]} is not in SIGHTLINE_LAYERS"
            continue
        text = path.read_text()
        for match in INCLUDE.finditer(text):
            quote, target = match.groups()
            parts = target.split("/")
            place = f"{relative(path)}:{line_of(text, match.start())}"
            if parts[0] in layers and len(parts) > 1:
                if layers.index(parts[0]) > layers.index(own[0]):
                    yield f"{place}: {own[0]} is below {parts[0]} and may not include {target}"
                if own[0] == parts[0] == "methods" and len(own) > 2 and len(parts) > 2 and own[1] != parts[1]:
                    yield f"{place}: methods do not include each other; what two share moves down"
                if not (ROOT / "src" / target).exists():
                    yield f"{place}: {target} does not exist"
            elif quote == '"' and parts[0] != "sightline" and not target.startswith("hwy/"):
                yield f"{place}: write {target} from the root of src/, or in <> if it is of another library"


def check_headers():
    for path in source_files("src", "include"):
        text = path.read_text()
        # What Highway includes once for each target must not guard itself.
        if path.suffix == ".h" and "#pragma once" not in text and "foreach_target.h" not in text:
            yield f"{relative(path)}: has no #pragma once"
        if path.is_relative_to(ROOT / "include"):
            for match in INCLUDE.finditer(text):
                quote, target = match.groups()
                if not (quote == "<" and re.fullmatch(r"[a-z_]+", target)) and not re.fullmatch(r"sightline/[a-z_]+\.h", target):
                    yield f"{relative(path)}:{line_of(text, match.start())}: a public header may not include {target}"


def check_sources():
    for path in source_files("src"):
        if path.suffix != ".cpp":
            continue
        folder = path.parent
        while folder != ROOT:
            listing = folder / "CMakeLists.txt"
            if listing.exists() and re.search(rf"(?<![\w./-]){re.escape(path.relative_to(folder).as_posix())}(?![\w.-])", listing.read_text()):
                break
            folder = folder.parent
        else:
            # Backends chosen by a variable are listed by name too, so nothing else may be left out.
            yield f"{relative(path)}: is in no CMakeLists.txt"


def known_keys():
    keys = set()
    bibliographies = [ROOT / "docs/references.bib", *sorted((ROOT / "docs/references.d").glob("*.bib"))]
    for path in bibliographies:
        if path.exists():
            keys.update(re.findall(r"^\s*@\w+\s*\{\s*([^,\s]+)\s*,", path.read_text(), re.MULTILINE))
    return keys


def check_citations():
    keys = known_keys()
    for folder in ("src", "include", "apps", "tests", "docs", "benchmarks"):
        for path in sorted((ROOT / folder).rglob("*")):
            if not path.is_file() or path.suffix not in CODE_ENDINGS:
                continue
            text = path.read_text(errors="replace")
            for match in CITATION.finditer(text):
                for key in KEY.findall(match.group(1)):
                    if key not in keys:
                        yield f"{relative(path)}:{line_of(text, match.start())}: [{key}] is not in docs/references.bib"


def check_scripts():
    for path in [*sorted((ROOT / "scripts").iterdir()), ROOT / ".ci/run"]:
        if not path.is_file():
            continue
        text = path.read_text()
        if text.startswith("#!") and not os.access(path, os.X_OK):
            yield f"{relative(path)}: is not executable"
        if text.startswith("#!/usr/bin/env bash") and "set -euo pipefail" not in text:
            yield f"{relative(path)}: lacks set -euo pipefail"


def compile_arguments():
    databases = sorted((ROOT / "build").glob("*/compile_commands.json"), key=lambda path: path.stat().st_mtime)
    if not databases:
        sys.exit("check-layers.py: --compile-headers needs a configured build: cmake --preset dev")
    arguments = {}
    for entry in json.loads(databases[-1].read_text()):
        path = pathlib.Path(entry["file"])
        if path.is_relative_to(ROOT / "src") and path.relative_to(ROOT / "src").parts[0] not in arguments:
            words = shlex.split(entry["command"])
            words = words[1:] if words[0].endswith("ccache") else words
            cut = words.index("-o")
            arguments[path.relative_to(ROOT / "src").parts[0]] = words[:cut] + words[cut + 2:words.index("-c")]
    return arguments


def check_header_compiles(path, arguments):
    layer = path.relative_to(ROOT / "src").parts[0] if path.is_relative_to(ROOT / "src") else "base"
    if layer not in arguments:
        return None
    done = subprocess.run([*arguments[layer], "-Wno-pragma-once-outside-header", "-fsyntax-only", "-x", "c++", str(path)], capture_output=True, check=False)
    if done.returncode == 0:
        return None
    first = next((line for line in done.stderr.decode().splitlines() if "error" in line), "unknown error")
    return f"{relative(path)}: does not compile alone: {first}"


def check_headers_compile():
    arguments = compile_arguments()
    headers = [path for path in source_files("src", "include") if path.suffix == ".h" and "foreach_target.h" not in path.read_text()]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        yield from filter(None, pool.map(lambda path: check_header_compiles(path, arguments), headers))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--compile-headers", action="store_true")
    options = parser.parse_args()
    checks = [check_layers, check_headers, check_sources, check_citations, check_scripts]
    if options.compile_headers:
        checks.append(check_headers_compile)
    findings = [finding for check in checks for finding in check()]
    print("\n".join(findings) if findings else "house rules: all kept")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
