#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds everything and runs the tests: scripts/test.sh [--long] [--sources] [ctest options]. Checks
# the time budgets: cold build 10 minutes, tests 5 minutes, on two free cores. With --sources, and
# with --long, check_sources.sh checks the sources too, which takes minutes.
# --long also has judge.sh judge exported files, and page_test.sh drive the studio's page.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh
. scripts/build.sh
readonly build_budget=600 test_budget=300

# within_budget WHAT SECONDS BUDGET: prints what is beyond the budget. Who only wants to know whether
# the tests pass has other programs on the machine, or a slower one: with LAPWING_BUDGETS=enforced
# it fails. The budget is larger then on a machine that is slower than one with two free cores.
within_budget() {
  local slower
  [ "$2" -gt "$3" ] || return 0
  slower=$(bash scripts/machine_speed.sh)
  echo "test.sh: the $1 took $2 s; the budget is $3 s, and this machine is $slower times slower now" \
    "than one with two free cores" >&2
  [ "${LAPWING_BUDGETS:-}" != enforced ] ||
    awk -v took="$2" -v budget="$3" -v slower="$slower" 'BEGIN { exit !(took <= budget * slower) }'
}

labels=(-LE long) sources=false
while true; do
  case "${1:-}" in
    --long) labels=() sources=true ;;
    --sources) sources=true ;;
    *) break ;;
  esac
  shift
done
scripts/setup.sh --yes --for build --for test --for sites --for cluster
if [ -z "${LAPWING_DATA:-}" ] && [ -d ../shared/data ]; then
  LAPWING_DATA=$(cd ../shared/data && pwd)
  export LAPWING_DATA
fi

cold=false
[ -f build/release/.ninja_log ] || cold=true
lapwing_configure release -DLAPWING_TESTS=ON
lapwing_build release all
echo "Built in ${lapwing_build_seconds} s"
! $cold || within_budget "cold build" "$lapwing_build_seconds" "$build_budget"
if $sources; then
  $cold || [ ${#labels[@]} -eq 0 ] && alone=(--alone) || alone=()
  bash scripts/check_sources.sh "${alone[@]}"
fi

began=$SECONDS status=0
ctest --test-dir build/release --output-on-failure --no-tests=error -j 2 "${labels[@]}" "$@" ||
  status=$?
took=$((SECONDS - began))
echo "Tests ran in $took s"
bash scripts/test_summary.sh build/release/Testing/Temporary/LastTest.log
[ "$status" -eq 0 ] || exit "$status"
[ ${#labels[@]} -gt 0 ] || bash scripts/judge.sh
[ ${#labels[@]} -gt 0 ] || bash scripts/page_test.sh || [ $? -eq 77 ]
[ ${#labels[@]} -eq 0 ] || within_budget tests "$took" "$test_budget"
