#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A machine that never saw the project: makes a bare Debian 12, types both commands of the README
# there, as root and as a user with sudo, installs what was built and writes the plugin of
# plugins/README.md against it. README.md beside this file says more.
#   tests/fresh_machine/run.sh [--keep]
# Exit status: 0 all of it works, 1 something does not or takes longer than 20 minutes, 77 it cannot
# run here (the reason is printed). LAPWING_FRESH_SECONDS is another limit, for a slow machine.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
cd "$root"
. tests/fresh_machine/machine.sh

keep=false
case "${1:-}" in
  '') ;;
  --keep) keep=true ;;
  *) echo "run.sh: unknown option '$1'; it knows --keep" >&2; exit 2 ;;
esac
reason=$(why_not) && { echo "fresh_machine: skipped: $reason"; exit 77; }

mkdir -p build
readonly log="$root/build/fresh_machine.log" most=${LAPWING_FRESH_SECONDS:-1200}  # s
[[ "$most" =~ ^[1-9][0-9]*$ ]] ||
  { echo "run.sh: LAPWING_FRESH_SECONDS: expected whole seconds, not '$most'" >&2; exit 2; }
: >"$log"
machine=$(mktemp -d "${LAPWING_FRESH_FOLDER:-/var/tmp}/lapwing_fresh.XXXXXX")
export machine log root
inner= watch=
cleanup() {
  trap - EXIT INT TERM HUP
  # The mounts live in the name space of this process alone, and end with it.
  [ -z "$inner" ] || { kill -KILL "$inner" 2>/dev/null; wait "$inner" 2>/dev/null; } || true
  [ -z "$watch" ] || kill "$watch" 2>/dev/null || true
  if $keep; then echo "fresh_machine: kept in $machine"; else rm -rf --one-file-system "$machine"; fi
}
trap cleanup EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

began=$SECONDS
# `unshare` heeds no TERM; whatever runs in there ends with it.
unshare --mount --pid --fork --kill-child bash tests/fresh_machine/steps.sh &
inner=$!
# Whoever reads our output waits for everyone who holds it: the clock holds none of it, and is ended.
sleep "$most" </dev/null >/dev/null 2>&1 &
watch=$!
status=0 ended=
wait -n -p ended "$inner" "$watch" || status=$?
took=$((SECONDS - began))
if [ "${ended:-}" = "$watch" ]; then
  tail -n 20 "$log" >&2
  echo "fresh_machine: stopped after $took s: its limit is $most s; all of it is in $log" >&2
  exit 1
fi
inner=
if [ "$status" -ne 0 ]; then
  tail -n 60 "$log" >&2
  echo "fresh_machine: failed after $took s; all of it is in $log" >&2
  exit 1
fi
echo "fresh_machine: all of it works, in $took s of the $most s that it may take"
