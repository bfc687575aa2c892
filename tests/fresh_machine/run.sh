#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes a bare Debian 12 and runs both commands of the README there, as root and as a user with
# sudo. Then installs the build and builds the plugin of plugins/README.md against it. See README.md
# here.
#   tests/fresh_machine/run.sh [--keep]
# Exit status: 0 all steps pass, 1 a step fails or all take longer than 20 minutes, 77 it cannot run
# here (the reason is printed). LAPWING_FRESH_SECONDS sets another limit, for a slow machine.
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
  # The mounts exist in the name space of this process only, and end with it.
  [ -z "$inner" ] || { kill -KILL "$inner" 2>/dev/null; wait "$inner" 2>/dev/null; } || true
  [ -z "$watch" ] || kill "$watch" 2>/dev/null || true
  if $keep; then echo "fresh_machine: kept in $machine"; else rm -rf --one-file-system "$machine"; fi
}
trap cleanup EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

began=$SECONDS
# `unshare` ignores TERM. All processes of its name space end with it.
unshare --mount --pid --fork --kill-child bash tests/fresh_machine/steps.sh &
inner=$!
# A reader of our output waits for every process that has it open. So the timer closes it, and is
# ended.
sleep "$most" </dev/null >/dev/null 2>&1 &
watch=$!
status=0 ended=
wait -n -p ended "$inner" "$watch" || status=$?
took=$((SECONDS - began))
if [ "${ended:-}" = "$watch" ]; then
  tail -n 20 "$log" >&2
  echo "fresh_machine: stopped after $took s: its limit is $most s; the log is $log" >&2
  exit 1
fi
inner=
if [ "$status" -ne 0 ]; then
  tail -n 60 "$log" >&2
  echo "fresh_machine: failed after $took s; the log is $log" >&2
  exit 1
fi
echo "fresh_machine: all steps pass, in $took s of at most $most s"
