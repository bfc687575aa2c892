#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# From a shot to a rehearsed flight: rehearse.sh [SHOT.lua [FOLDER]]. LAPWING names the program.
# Plans the shot, writes the mission for a ground station, and flies the plan against the simulated
# vehicle: once as it should be, once with a bad link. Each flight is compared with the plan. Ends with
# the status of the first flight that is not flown, or not as planned.
set -euo pipefail
lapwing=${LAPWING:-lapwing}
shot=${1:-$(dirname "$0")/shot.lua} folder=${2:-out/flying}

"$lapwing" run "$shot" -o "$folder/run" --quiet
plan=$folder/run/plan.json
"$lapwing" export "$plan" --format qgc_plan -o "$folder/shot.plan"

# rehearse NAME OPTION...: one flight; the options are those of the vehicle.
rehearse() {
  local name=$1 vehicle said=$folder/$1.err port=""
  shift
  "$lapwing" autopilot "$plan" --port 0 --pilot fly --lockstep --once "$@" \
    >"$folder/$name.txt" 2>"$said" &
  vehicle=$!
  until port=$(grep -so '127.0.0.1:[0-9]*' "$said"); do
    kill -0 "$vehicle" 2>/dev/null || { cat "$said" >&2; return 2; }
    sleep 0.05
  done
  echo "rehearsal: $name"
  "$lapwing" fly "$plan" --to "udp:$port" --lockstep --quiet -o "$folder/$name"
  wait "$vehicle"
  cat "$folder/$name.txt"
  "$lapwing" compare "$plan" "$folder/$name.tlog" -o "$folder/$name.html"
}
rm -f "$folder"/{calm,bad_link}.{tlog,json,html}
rehearse calm
rehearse bad_link --fault lost=0.2 --fault noise=0.05
