#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Names the tests that were skipped, by reason, and those that failed, with what they said:
# scripts/test_summary.sh LastTest.log, the log of ctest in BUILD/Testing/Temporary. The output of the
# tests counts: a long log that is cut off to its end still says which test failed, and why.
set -euo pipefail
[ $# -eq 1 ] && [ -f "$1" ] || { echo "usage: scripts/test_summary.sh LastTest.log" >&2; exit 2; }
awk '
  function note(name, reason) {
    if (name in seen) return  # a test that ctest runs in several parts
    seen[name] = 1
    if (!(reason in names)) reasons[++count_of_reasons] = reason
    names[reason] = names[reason] "\n    " name
    ++total
  }
  function failed(name, said) {
    failures[++count_of_failures] = "  " name (said == "" ? "\n    no message" : said)
    ++named
  }
  function last_lines(   k, text) {
    for (k = printed > 5 ? printed - 4 : 1; k <= printed; ++k) text = text "\n      " output[k]
    return text == "" ? "" : "; its last lines:" text
  }
  # ctest: a heading per test; a test that is no program of GoogleTest is skipped as a whole.
  /^[0-9]+\/[0-9]+ Test(ing)?: / {
    whole = $0
    sub(/^[^:]*: /, "", whole)
    running = said_by_test = ""
    named = printed = inside = 0
  }
  /^Command: ""$/ { failed(whole, "\n    its program is not there") }
  /^Output:$/ { inside = 1; next }
  /^<end of output>/ { inside = complaining = 0 }
  inside && !/^$/ && !/^[-[]/ { output[++printed] = substr($0, 1, 300) }
  /^Test (was )?skipped|^Test Skipped\.?$|^Skipped: / { said = $0; sub(/^[^:]*: /, "", said); note(whole, said) }
  # GoogleTest: the place and the reason, then the name.
  /^\[ RUN      \] / { running = $4; reason = ""; taking = 0; lines = 0; said_by_test = "" }
  /: Skipped$/ { taking = 1; next }
  /^\[  SKIPPED \] [^ ]+ \(/ { taking = 0; running = ""; note($4, reason == "" ? "no reason given" : reason) }
  /^\[       OK \] [^ ]+ \(/ { running = "" }
  /^\[  FAILED  \] .* \([0-9]+ ms\)$/ {
    complaining = 0
    running = ""
    sub(/,$/, "", $4)  # of a parameterised test
    failed($4, said_by_test)
  }
  # A program that crashed, was ended from outside, or is none of GoogleTest names no test that failed.
  /^Test (Failed|Timeout)/ {
    if (running != "")
      failed(running, said_by_test "\n    " whole " ended in this test" last_lines())
    else if (named == 0)
      failed(whole, "\n    it failed" last_lines())
    running = ""
  }
  /: Failure$/ { complaining = 1 }
  /^$/ { taking = 0 }
  taking { reason = reason (reason == "" ? "" : " ") $0 }
  complaining && !/^$/ && ++lines <= 12 { said_by_test = said_by_test "\n    " substr($0, 1, 300) }
  END {
    if (total == 0) print "No test was skipped"
    else printf "%d test%s skipped:\n", total, total == 1 ? " was" : "s were"
    for (i = 1; i <= count_of_reasons; ++i) printf "  %s%s\n", reasons[i], names[reasons[i]]
    if (count_of_failures > 0)
      printf "%d test%s failed:\n", count_of_failures, count_of_failures == 1 ? "" : "s"
    for (i = 1; i <= count_of_failures; ++i) print failures[i]
  }' "$1"
