#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs the Debian packages that building, testing, benchmarking and so on need.
#   scripts/setup.sh [--yes] [--for build|test|bench|fuzz|learn|fresh|judge|studio|check|package|sites|cluster]...
# Prints the packages to install. Asks first on a terminal, unless --yes. Default: build and test.
# `fuzz` is for scripts/fuzz.sh, `learn` for the preset `learn`, `fresh` for tests/fresh_machine,
# `judge` for scripts/judge.sh, `studio` for scripts/studio.sh, `check` for scripts/format.sh and scripts/tidy.sh, `package` for scripts/package.sh.
# `sites` is for coordinates and rasters of surveyors, `cluster` for many processes by mpirun: build
# again after them.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh

readonly kinds="build, test, bench, fuzz, learn, fresh, judge, studio, check, package, sites or cluster"
yes=false
wanted=()
while [ $# -gt 0 ]; do
  case "$1" in
    --yes) yes=true ;;
    --for)
      [ $# -ge 2 ] || { echo "setup.sh: --for needs $kinds" >&2; exit 2; }
      wanted+=("$2")
      shift
      ;;
    *) echo "setup.sh: unknown option '$1'; expected --yes or --for with $kinds" >&2; exit 2 ;;
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
    fuzz) packages+=("${lapwing_fuzz_packages[@]}") ;;
    learn) packages+=("${lapwing_learn_packages[@]}") ;;
    fresh) packages+=("${lapwing_fresh_packages[@]}") ;;
    judge) packages+=("${lapwing_judge_packages[@]}") ;;
    studio) packages+=("${lapwing_studio_packages[@]}") ;;
    check) packages+=("${lapwing_check_packages[@]}") ;;
    sites) packages+=("${lapwing_sites_packages[@]}") ;;
    cluster) packages+=("${lapwing_cluster_packages[@]}") ;;
    package) packages+=("${lapwing_package_packages[@]}") ;;
    *) echo "setup.sh: unknown kind '$what'; --for needs $kinds" >&2; exit 2 ;;
  esac
done

if ! command -v dpkg-query >/dev/null; then
  echo "setup.sh: this is not Debian; install by hand: ${packages[*]}" >&2
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
  echo "setup.sh: apt-get failed; its output is in $log" >&2
  exit 1
fi
rm -f "$log"
