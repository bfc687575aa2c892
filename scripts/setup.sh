#!/usr/bin/env bash
# Installs the Debian packages that building, testing and benchmarking need.
#   scripts/setup.sh [--yes] [--for build|test|bench|learn]...
# Prints what it would install; asks first on a terminal unless --yes. Default: build and test.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh

yes=false
wanted=()
while [ $# -gt 0 ]; do
  case "$1" in
    --yes) yes=true ;;
    --for)
      [ $# -ge 2 ] || { echo "setup.sh: --for needs build, test, bench or learn" >&2; exit 2; }
      wanted+=("$2")
      shift
      ;;
    *) echo "setup.sh: unknown option '$1'; it knows --yes and --for build|test|bench|learn" >&2; exit 2 ;;
  esac
  shift
done
[ ${#wanted[@]} -gt 0 ] || wanted=(build test)

packages=()
for what in "${wanted[@]}"; do
  case "$what" in
    build) packages+=("${lapwing_packages[@]}") ;;
    test) packages+=("${lapwing_test_packages[@]}") ;;
    bench) packages+=("${lapwing_bench_packages[@]}") ;;
    learn) packages+=("${lapwing_learn_packages[@]}") ;;
    *) echo "setup.sh: --for knows build, test, bench and learn, not '$what'" >&2; exit 2 ;;
  esac
done

if ! command -v dpkg-query >/dev/null; then
  echo "setup.sh: this is no Debian; install by hand: ${packages[*]}" >&2
  exit 2
fi
mapfile -t missing < <(lapwing_missing "${packages[@]}")
[ ${#missing[@]} -gt 0 ] || exit 0

as_root=()
if [ "$(id -u)" != 0 ]; then
  as_root=(sudo)
  if ! command -v sudo >/dev/null; then
    echo "setup.sh: there is no sudo; as root: apt-get install ${missing[*]}" >&2
    exit 2
  fi
fi
echo "To install with apt-get: ${missing[*]}" >&2
if ! $yes && [ -t 0 ] && [ -t 2 ]; then
  read -r -p "Install them now? [Y/n] " answer
  case "$answer" in '' | y | Y | yes) ;; *) echo "setup.sh: nothing was installed" >&2; exit 1 ;; esac
fi
log=$(mktemp)
if ! { "${as_root[@]}" apt-get update -q &&
       "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q \
         --no-install-recommends "${missing[@]}"; } >"$log" 2>&1; then
  tail -n 20 "$log" >&2
  echo "setup.sh: apt-get failed; its whole output is in $log" >&2
  exit 1
fi
rm -f "$log"
