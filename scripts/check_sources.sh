#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Checks the sources of build/release, which must be built: scripts/check_sources.sh [--alone].
# No source takes longer than 15 s to compile. With --alone, every source must compile separately.
set -euo pipefail
cd "$(dirname "$0")/.."
readonly source_budget=15
alone=false
case "${1:-}" in
  '') ;;
  --alone) alone=true ;;
  *) echo "check_sources.sh: unknown option '$1'; it knows --alone" >&2; exit 2 ;;
esac
[ -f build/release/.ninja_log ] ||
  { echo "check_sources.sh: build/release is not built; scripts/test.sh builds it" >&2; exit 2; }

# Objects over the budget in the log are compiled again, each source of a unity build separately,
# and their processor time counts: first two at a time, then those over the budget alone.
# .ninja_log: start, end (ms), time stamp, output, command hash.
mapfile -t candidates < <(awk -v limit=$((source_budget * 1000)) \
  '$4 ~ /\.c(pp|xx)\.o$/ { took[$4] = $2 - $1 } END { for (o in took) if (took[o] > limit) print o }' \
  build/release/.ninja_log)
# Processor seconds of a compile command; "does not compile" if it fails.
compile_seconds() {
  local TIMEFORMAT=%U seconds
  seconds=$({ time (cd build/release && CCACHE_DISABLE=1 bash -c "$1" >/dev/null 2>&1); } 2>&1) ||
    seconds="does not compile by itself"
  echo "$seconds"
}
export -f compile_seconds
over_budget() { awk -v s="$1" -v limit="$source_budget" 'BEGIN { exit !(s + 0 != s || s > limit) }'; }
# The sources of an object, each with the command that compiles it separately, after a tab.
sources_of() {
  local command joined source
  command=$(ninja -C build/release -t commands "$1" 2>/dev/null | tail -n 1)
  [[ "$command" == *" -c "* ]] || return 0  # a deleted source
  joined=${command##* -c }
  if [[ "$joined" != *_cxx.cxx ]]; then
    printf '%s\t%s\n' "$joined" "$command"
    return
  fi
  while read -r source; do
    printf '%s\t%s\n' "$source" "${command%% -MD *} -o /dev/null -c $source"
  done < <(cd build/release && sed -n 's/^#include "\(.*\)"$/\1/p' "$joined")
}
# In a unity build a source may lack an include that a neighbour has. Here each source is compiled
# separately.
if $alone; then
  echo "Compiling every source separately ..."
  missing=$(ninja -C build/release -t targets all |
    sed -n 's/^\([^:]*_cxx\.cxx\.o\):.*/\1/p' | sort -u |
    while read -r object; do sources_of "$object"; done |
    while IFS=$'\t' read -r source command; do
      printf '%s\0%s -fsyntax-only\0' "$source" "$command"
    done |
    (cd build/release && CCACHE_DISABLE=1 xargs -0 -r -n 2 -P 2 \
       bash -c 'bash -c "$1" >/dev/null 2>&1 || echo "  $0"'))
  if [ -n "$missing" ]; then
    printf 'check_sources.sh: sources that do not compile separately:\n%s\n' "$missing" >&2
    exit 1
  fi
fi
checks=()  # source, command
for object in "${candidates[@]}"; do
  while IFS=$'\t' read -r source command; do checks+=("$source" "$command"); done < <(sources_of "$object")
done
echo "Timing $((${#checks[@]} / 2)) sources separately ..."
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
  printf 'check_sources.sh: sources that compile longer than %s s:\n' "$source_budget" >&2
  printf '  %s\n' "${slow[@]}" >&2
  exit 1
fi
