#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Prints how many times slower this machine compiles now than a machine with two free cores, on
# which a cold build takes 300 s. It runs two compilers at a time on a fixed source. At least 1.
#   scripts/machine_speed.sh
set -euo pipefail
readonly reference=2.5  # s, of this source on such a machine

compile() {
  g++ -std=c++20 -O2 -x c++ -c -o /dev/null - <<'SOURCE'
#include <map>
#include <regex>
#include <string>
int main(int argc, char** argv) {
  std::map<std::string, int> found;
  for (int i = 0; i < argc; ++i)
    if (std::regex_match(argv[i], std::regex("[a-z]+([0-9]*)"))) ++found[argv[i]];
  return static_cast<int>(found.size());
}
SOURCE
}
began=${EPOCHREALTIME/[.,]/}
compile &
compile
wait
ended=${EPOCHREALTIME/[.,]/}
awk -v took="$((ended - began))" -v reference="$reference" \
  'BEGIN { slower = took / 1e6 / reference; printf "%.1f\n", slower < 1 ? 1 : slower }'
