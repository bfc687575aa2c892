#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Formats the C++ sources by .clang-format: scripts/format.sh [--check] [FILE...]
# With --check it changes nothing, names the files that differ, and exits with 1 if there are any.
set -euo pipefail
cd "$(dirname "$0")/.."
readonly version=14  # Debian 12's; others format a few lines differently

check=false
case "${1:-}" in
  --check) check=true; shift ;;
  --*) echo "format.sh: unknown option '$1'; it knows --check" >&2; exit 2 ;;
esac
command -v clang-format >/dev/null ||
  { echo "format.sh: no clang-format; scripts/setup.sh --for check installs it" >&2; exit 2; }
[[ "$(clang-format --version)" =~ version\ $version\. ]] ||
  { echo "format.sh: expected clang-format $version, not: $(clang-format --version)" >&2; exit 2; }

if [ $# -gt 0 ]; then files=("$@"); else mapfile -t files < <(git ls-files '*.h' '*.cpp'); fi
if ! $check; then
  printf '%s\0' "${files[@]}" | xargs -0 -n 50 -P 2 clang-format -i
  exit
fi
differing=$(printf '%s\0' "${files[@]}" |
  xargs -0 -n 1 -P 2 bash -c 'clang-format "$0" | cmp -s - "$0" || echo "  $0"' | sort)
[ -z "$differing" ] && exit 0
printf 'format.sh: these files differ from .clang-format; scripts/format.sh formats them:\n%s\n' \
  "$differing" >&2
exit 1
