#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Exports an example of each kind of mission, and has programs from elsewhere judge the files:
# scripts/judge.sh. See tests/judges/README.md. Exit status 1 if a judge finds something.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh
. scripts/build.sh
# Kind, example and options of its run.
readonly examples=(
  "film filming/castle_flyover" "film filming/two_actors" "race racing/seven_gates"
  "painting light_painting/hello" "scan scan/church --config scan/small" "explore explore/office"
)
# Each format with its parameters. The judge of NAME is tests/judges/NAME.js; a format without one
# is written, and judged by the program itself where vehicles fly it.
readonly formats=(
  csv gltf chan mcap poly4d kml gpx:heights=ground geojson:heights=ground qgc_plan waypoints litchi:part=1 wpml:part=1
  srt edl
)
# What missions of MAVLink need: a race lands on its floor, a reconstructed surface has bumps where
# the take-off is, an exploration is long.
readonly -A flown=(
  [race]=home_z=0.3 [scan]=take_off=false,finish=hover [explore]=angle_tolerance=20,take_off=false,finish=hover,part=1
)
# Where the examples are flown: z = 0 is the ground.
readonly origin=46.5191,6.5668,0,ground

scripts/setup.sh --yes --for build --for judge
lapwing_build release lapwing_app lapwing_all_plugins mavlink_samples
judges=build/judges
mkdir -p "$judges"
cp tests/judges/*.js tests/judges/package.json tests/judges/package-lock.json "$judges"
npm ci --prefix "$judges" --no-audit --no-fund >"$judges/npm.log" 2>&1 ||
  { tail -n 20 "$judges/npm.log" >&2; exit 1; }

lapwing=build/release/bin/lapwing failed=0
declare -A verdicts

# Messages of live flights, both ways, against another implementation.
if ! verdict=$(node "$judges/mavlink.js" build/release/bin/mavlink_samples 2>&1); then
  echo "mavlink: BAD: $(head -n 1 <<<"$verdict")"
  failed=1
else
  echo "mavlink: good: $verdict"
fi

# Verdict of one export: judge_file KIND FORMAT PLAN.
judge_file() {
  local kind=$1 format=$2 plan=$3 short=${2%%:*} file found
  file=${plan%.json}.$short
  [[ $short != qgc_plan && $short != waypoints ]] || format=$short${flown[$kind]:+:${flown[$kind]}}
  if ! "$lapwing" export "$plan" --format "$format" -o "$file" --uncertified \
    --origin "$origin" >"$judges/export.log" 2>&1; then
    found=$(tail -n 1 "$judges/export.log")
    # Refused for good: a camera track of a flight without a camera.
    [[ $found != *"without a camera"* ]] || { echo "no camera"; return; }
    echo "BAD: not written: $found"
  elif [ ! -e "$judges/$short.js" ]; then
    echo written
  elif ! found=$(node "$judges/$short.js" "$file" "$plan" "$origin" 2>&1); then
    echo "BAD: $(head -n 1 <<<"$found")"
  else
    echo good
  fi
}

for example in "${examples[@]}"; do
  read -r -a words <<<"$example"
  kind=${words[0]} name=${words[1]} out=$judges/plans/${words[1]}
  # A plan that is not certified has a file to judge too.
  status=0
  "$lapwing" run "examples/$name.lua" "${words[@]:2}" -o "$out" --quiet >"$judges/run.log" 2>&1 ||
    status=$?
  if [ "$status" -gt 1 ]; then
    echo "$name: not planned: $(tail -n 1 "$judges/run.log")"
    failed=1
    continue
  fi
  for format in "${formats[@]}"; do
    verdict=$(judge_file "$kind" "$format" "$out/plan.json")
    if [[ $verdict == BAD* ]]; then
      echo "$name ${format%%:*}: $verdict"
      failed=1 verdict=BAD
    fi
    verdicts[$name ${format%%:*}]=$verdict
  done
done

printf '%-10s' format
for example in "${examples[@]}"; do read -r _ name _ <<<"$example"; printf ' %-15s' "${name##*/}"; done
echo
for format in "${formats[@]}"; do
  short=${format%%:*}
  printf '%-10s' "$short"
  for example in "${examples[@]}"; do
    read -r _ name _ <<<"$example"
    printf ' %-15s' "${verdicts[$name $short]:--}"
  done
  echo
done

# Logs that nobody here made, read by a program from elsewhere too.
for data in ${LAPWING_DATA:+"$LAPWING_DATA"} ../shared/data; do
  [ -d "$data/flight_logs" ] && break
done
for log in "$data"/flight_logs/*.ulg; do
  [ -e "$log" ] || { echo "ulog: no real logs; LAPWING_DATA names their folder"; break; }
  if "$lapwing" log info "$log" --json >"$judges/log.json" 2>"$judges/log.txt" &&
    found=$(node "$judges/ulog.js" "$log" "$judges/log.json" 2>&1); then
    echo "$(basename "$log"): good, $found"
  else
    echo "$(basename "$log"): BAD: $(cat "$judges/log.txt") ${found:-}"
    failed=1
  fi
done
exit "$failed"
