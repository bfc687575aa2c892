#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Fuzzes every reader of foreign files with libFuzzer, under AddressSanitizer and
# UndefinedBehaviorSanitizer: scripts/fuzz.sh [--minutes N] [READER...]
# The minutes (10) are for all of them, one after the other. A finding is kept as a file in
# tests/fuzz/READER, where an ordinary test replays it from then on. Prints the inputs tried per
# reader, in this run and in all since build/fuzz was made. Exit status 1 if something was found.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh
. scripts/build.sh

usage() { echo "fuzz.sh: $1; usage: scripts/fuzz.sh [--minutes N] [READER...]" >&2; exit 2; }
minutes=10 readers=()
while [ $# -gt 0 ]; do
  case "$1" in
    --minutes) [ $# -ge 2 ] || usage "--minutes needs a number"; minutes=$2; shift ;;
    -*) usage "unknown option '$1'" ;;
    *) readers+=("$1") ;;
  esac
  shift
done
[[ "$minutes" =~ ^[0-9]+(\.[0-9]+)?$ ]] || usage "--minutes needs a number, not '$minutes'"
mapfile -t known < <(sed -n 's/^lapwing_add_fuzzer(\([a-z_]*\).*/\1/p' tests/fuzz/CMakeLists.txt)
[ ${#readers[@]} -gt 0 ] || readers=("${known[@]}")
for reader in "${readers[@]}"; do
  [[ " ${known[*]} " == *" $reader "* ]] || usage "no reader '$reader'; there are ${known[*]}"
done
seconds=$(awk -v m="$minutes" -v n=${#readers[@]} 'BEGIN { s = int(60 * m / n); print s < 1 ? 1 : s }')

scripts/setup.sh --yes --for build --for fuzz
lapwing_build fuzz "${readers[@]/#/fuzz_}"

# Longer inputs are slow and find little more, unless an initial input is longer.
longest_input() {
  local longest
  longest=$(find "tests/fuzz/$1" -type f -printf '%s\n' | sort -n | tail -n 1)
  [ "${longest:-0}" -gt 512 ] && echo "$longest" || echo 512
}
# fuzz READER: sets `tried` and `found`.
fuzz() {
  local reader=$1 made=build/fuzz/corpus/$1 artifacts=build/fuzz/found/$1 log=build/fuzz/$1.log file
  mkdir -p "$made" "$artifacts"
  # Continues from the inputs of earlier runs. Leaks are findings too.
  ASAN_OPTIONS=detect_leaks=1 "build/fuzz/bin/fuzz_$reader" -max_total_time="$seconds" \
    -max_len="$(longest_input "$reader")" -rss_limit_mb=4096 -timeout=60 -print_final_stats=1 \
    -artifact_prefix="$artifacts/" "$made" "tests/fuzz/$reader" >"$log" 2>&1 || true
  tried=$(grep -a -o 'number_of_executed_units: *[0-9]*' "$log" | grep -o '[0-9]*$' || echo 0)
  found=()
  for file in "$artifacts"/{crash,leak,oom,timeout}-*; do
    [ -f "$file" ] || continue
    mv "$file" "tests/fuzz/$reader/"
    found+=("tests/fuzz/$reader/$(basename "$file")")
  done
  # It must have ended regularly: a crash on an input of the folder leaves no file.
  grep -a -q '^Done [0-9]* runs' "$log" || [ ${#found[@]} -gt 0 ] ||
    found+=("one of the inputs that are there already: $log")
}

all_found=() sum=0 sum_ever=0
printf '%-22s %14s %14s  %s\n' reader inputs 'in all' found
for reader in "${readers[@]}"; do
  fuzz "$reader"
  echo "$tried" >>"build/fuzz/$reader.tried"
  ever=$(awk '{ s += $1 } END { printf "%d", s }' "build/fuzz/$reader.tried")
  sum=$((sum + tried)) sum_ever=$((sum_ever + ever))
  printf '%-22s %14d %14d  %d\n' "$reader" "$tried" "$ever" ${#found[@]}
  all_found+=("${found[@]}")
done
printf '%-22s %14d %14d  %d\n' all "$sum" "$sum_ever" ${#all_found[@]}
[ ${#all_found[@]} -gt 0 ] || exit 0
printf 'fuzz.sh: found, to be fixed: %s\n' "${all_found[@]}" >&2
exit 1
