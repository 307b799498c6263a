#!/usr/bin/env bash
# Installs the Debian 12 packages that Sightline needs. Quick and silent when all of them are there.
#
#   scripts/install-deps.sh          everything: build, tests, sanitizers, fuzzing, checks, headless browser
#   scripts/install-deps.sh --demo   only what building and running the program needs
#   scripts/install-deps.sh --list   print the package names and stop
set -euo pipefail

build_packages=(
  g++ cmake ninja-build ccache pkg-config python3
  libembree-dev libtbb-dev libhwy-dev                                        # rays, tasks, vectors
  libopenexr-dev libpng-dev libjpeg62-turbo-dev libstb-dev zlib1g-dev        # pictures
  libglm-dev libeigen3-dev                                                   # mathematics
  libfast-float-dev                                                          # scene files
  nlohmann-json3-dev libcli11-dev libfmt-dev libspdlog-dev                   # text in and out
  libzstd-dev libxxhash-dev                                                  # compression, hashing
)
test_packages=(libgtest-dev librapidcheck-dev libbenchmark-dev chromium)
check_packages=(clang-19 clang-tidy-19 clang-format-19 libclang-rt-19-dev git)

mode=all
list=false
for argument in "$@"; do
  case "$argument" in
    --demo) mode=demo ;;
    --list) list=true ;;
    -h | --help) sed -n '2,6s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) echo "install-deps.sh: unknown option $argument (known: --demo, --list)" >&2; exit 2 ;;
  esac
done

packages=("${build_packages[@]}")
if [[ $mode == all ]]; then packages+=("${test_packages[@]}" "${check_packages[@]}"); fi
if $list; then
  printf '%s\n' "${packages[@]}"
  exit 0
fi
if ! command -v dpkg-query >/dev/null; then
  echo "install-deps.sh: this is not a Debian system; install the equivalents of: ${packages[*]}" >&2
  exit 1
fi

missing=()
for package in "${packages[@]}"; do
  [[ $(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true) == installed ]] || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
  exit 0
fi

as_root=()
if ((EUID != 0)); then
  command -v sudo >/dev/null || { echo "install-deps.sh: run this as root, or install sudo; missing: ${missing[*]}" >&2; exit 1; }
  as_root=(sudo)
fi
echo "installing ${#missing[@]} packages: ${missing[*]}" >&2
apt_options=(-qq -y --no-install-recommends -o Dpkg::Use-Pty=0 -o DPkg::Lock::Timeout=120)
# The lists on the machine may be fresh enough; they are renewed only when they turn out not to be.
if ! "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install "${apt_options[@]}" "${missing[@]}" >/dev/null 2>&1; then
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install "${apt_options[@]}" "${missing[@]}" >/dev/null
fi
