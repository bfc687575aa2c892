#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds everything with sanitizers and runs the tests:
#   scripts/sanitize.sh address [ctest options]   the whole suite, with AddressSanitizer and
#                                                 UndefinedBehaviorSanitizer (preset asan)
#   scripts/sanitize.sh thread [ctest options]    the tests of threaded code, with ThreadSanitizer
#                                                 (preset tsan)
# Tests labelled `long` and `browser` are left out.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh
. scripts/build.sh

which=${1:-}
shift || true
options=()
case "$which" in
  address)
    preset=asan
    export ASAN_OPTIONS=detect_leaks=1:strict_string_checks=1:detect_stack_use_after_return=1
    export UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1
    ;;
  thread)
    preset=tsan
    export TSAN_OPTIONS="halt_on_error=1:suppressions=$PWD/tests/tsan.supp"
    options=(-R '^(core|geometry|picture|map|path|view|explore|problem|symbolic|solve|conformance|app|tour_solvers|utilities)$')
    ;;
  *) echo "usage: scripts/sanitize.sh address|thread [ctest options]" >&2; exit 2 ;;
esac
scripts/setup.sh --yes --for build --for test
if [ -z "${LAPWING_DATA:-}" ] && [ -d ../shared/data ]; then
  LAPWING_DATA=$(cd ../shared/data && pwd)
  export LAPWING_DATA
fi
lapwing_configure "$preset" -DLAPWING_TESTS=ON
lapwing_build "$preset" all
echo "Built ($preset) in ${lapwing_build_seconds} s"
began=$SECONDS status=0
ctest --test-dir "build/$preset" --output-on-failure --no-tests=error -j 2 -LE 'long|browser' \
  "${options[@]}" "$@" || status=$?
echo "Tests ($preset) ran in $((SECONDS - began)) s"
exit "$status"
