#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Counts and names the tests that were skipped, by reason: scripts/skipped_tests.sh LastTest.log,
# the log of ctest in BUILD/Testing/Temporary. The output of the tests counts.
set -euo pipefail
[ $# -eq 1 ] && [ -f "$1" ] || { echo "usage: scripts/skipped_tests.sh LastTest.log" >&2; exit 2; }
awk '
  function note(name, reason) {
    if (name in seen) return  # a test that ctest runs in several parts
    seen[name] = 1
    if (!(reason in names)) reasons[++count_of_reasons] = reason
    names[reason] = names[reason] "\n    " name
    ++total
  }
  # ctest: a heading per test; a test that is no program of GoogleTest is skipped as a whole.
  /^[0-9]+\/[0-9]+ Test(ing)?: / { whole = $0; sub(/^[^:]*: /, "", whole) }
  /^Test (was )?skipped|^Test Skipped\.?$|^Skipped: / { said = $0; sub(/^[^:]*: /, "", said); note(whole, said) }
  # GoogleTest: the place and the reason, then the name.
  /^\[ RUN      \] / { reason = ""; taking = 0 }
  /: Skipped$/ { taking = 1; next }
  /^\[  SKIPPED \] [^ ]+ \(/ { taking = 0; note($4, reason == "" ? "no reason given" : reason) }
  /^$/ { taking = 0 }
  taking { reason = reason (reason == "" ? "" : " ") $0 }
  END {
    if (total == 0) { print "No test was skipped"; exit }
    printf "%d test%s skipped:\n", total, total == 1 ? " was" : "s were"
    for (i = 1; i <= count_of_reasons; ++i) printf "  %s%s\n", reasons[i], names[reasons[i]]
  }' "$1"
