#!/usr/bin/env bash
# Builds everything and runs the tests: scripts/test.sh [--long] [ctest options].
# Checks the budgets on the way: cold build 10 minutes, tests 5 minutes, no source above 15 s; after
# a cold build, and with --long, that every source compiles by itself.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh
. scripts/build.sh
readonly build_budget=600 test_budget=300 source_budget=15

labels=(-LE long)
if [ "${1:-}" = --long ]; then labels=(); shift; fi
scripts/setup.sh --yes --for build --for test
if [ -z "${LAPWING_DATA:-}" ] && [ -d ../shared/data ]; then
  LAPWING_DATA=$(cd ../shared/data && pwd)
  export LAPWING_DATA
fi

cold=false
[ -f build/release/.ninja_log ] || cold=true
lapwing_configure release -DLAPWING_TESTS=ON
lapwing_build release all
echo "Built in ${lapwing_build_seconds} s"
if $cold && [ "$lapwing_build_seconds" -gt "$build_budget" ]; then
  echo "test.sh: the cold build took ${lapwing_build_seconds} s, its budget is ${build_budget} s" >&2
  exit 1
fi
# What took longer than the budget beside other work is compiled once more by itself, and its
# processor time counts; of several sources that were joined, each by itself: two at a time, and what
# is over the budget then, alone. .ninja_log: start, end (ms), time stamp, output, command hash.
mapfile -t candidates < <(awk -v limit=$((source_budget * 1000)) \
  '$4 ~ /\.c(pp|xx)\.o$/ { took[$4] = $2 - $1 } END { for (o in took) if (took[o] > limit) print o }' \
  build/release/.ninja_log)
# Processor seconds of a compiler's command; "does not compile" where it fails.
compile_seconds() {
  local TIMEFORMAT=%U seconds
  seconds=$({ time (cd build/release && CCACHE_DISABLE=1 bash -c "$1" >/dev/null 2>&1); } 2>&1) ||
    seconds="does not compile by itself"
  echo "$seconds"
}
export -f compile_seconds
over_budget() { awk -v s="$1" -v limit="$source_budget" 'BEGIN { exit !(s + 0 != s || s > limit) }'; }
# An object's sources, each with the command that compiles it by itself (tab between).
alone() {
  local command joined source
  command=$(ninja -C build/release -t commands "$1" 2>/dev/null | tail -n 1)
  [[ "$command" == *" -c "* ]] || return 0  # a source that is gone
  joined=${command##* -c }
  if [[ "$joined" != *_cxx.cxx ]]; then
    printf '%s\t%s\n' "$joined" "$command"
    return
  fi
  while read -r source; do
    printf '%s\t%s\n' "$source" "${command%% -MD *} -o /dev/null -c $source"
  done < <(cd build/release && sed -n 's/^#include "\(.*\)"$/\1/p' "$joined")
}
# What a joined source takes from its neighbours is missing one day: each compiles by itself.
if $cold || [ ${#labels[@]} -eq 0 ]; then
  echo "Compiling every source by itself ..."
  missing=$(ninja -C build/release -t targets all |
    sed -n 's/^\([^:]*_cxx\.cxx\.o\):.*/\1/p' | sort -u |
    while read -r object; do alone "$object"; done |
    while IFS=$'\t' read -r source command; do
      printf '%s\0%s -fsyntax-only\0' "$source" "$command"
    done |
    (cd build/release && CCACHE_DISABLE=1 xargs -0 -r -n 2 -P 2 \
       bash -c 'bash -c "$1" >/dev/null 2>&1 || echo "  $0"'))
  if [ -n "$missing" ]; then
    printf 'test.sh: sources that do not compile by themselves:\n%s\n' "$missing" >&2
    exit 1
  fi
fi
checks=()  # source, command
for object in "${candidates[@]}"; do
  while IFS=$'\t' read -r source command; do checks+=("$source" "$command"); done < <(alone "$object")
done
echo "Timing $((${#checks[@]} / 2)) sources by themselves ..."
slow=()
if [ ${#checks[@]} -gt 0 ]; then
  while IFS=$'\t' read -r seconds source command; do
    over_budget "$seconds" || continue
    seconds=$(compile_seconds "$command")
    over_budget "$seconds" && slow+=("$seconds  $source")
  done < <(printf '%s\0' "${checks[@]}" | xargs -0 -n 2 -P 2 bash -c \
             'printf "%s\t%s\t%s\n" "$(compile_seconds "$2")" "$1" "$2"' _)
fi
if [ ${#slow[@]} -gt 0 ]; then
  printf 'test.sh: sources that compile longer than %s s:\n' "$source_budget" >&2
  printf '  %s\n' "${slow[@]}" >&2
  exit 1
fi

began=$SECONDS status=0
ctest --test-dir build/release --output-on-failure --no-tests=error -j 2 "${labels[@]}" "$@" ||
  status=$?
took=$((SECONDS - began))
echo "Tests ran in $took s"
bash scripts/skipped_tests.sh build/release/Testing/Temporary/LastTest.log
[ "$status" -eq 0 ] || exit "$status"
if [ ${#labels[@]} -gt 0 ] && [ "$took" -gt "$test_budget" ]; then
  echo "test.sh: the tests took $took s, their budget is $test_budget s" >&2
  exit 1
fi
