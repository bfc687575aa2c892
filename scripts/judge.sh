#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Exports an example of each kind of mission, and has programs from elsewhere judge the files:
# scripts/judge.sh. See tests/judges/README.md. Exit status 1 if a judge finds something.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh
. scripts/build.sh
readonly examples=(
  filming/castle_flyover filming/two_actors racing/seven_gates light_painting/hello
  "scan/church --config scan/small" "explore/office"
)
# Each format with its parameters; the judge of NAME is tests/judges/NAME.js.
readonly formats=(gltf kml gpx:heights=ground geojson:heights=ground)
# Where the examples are flown: z = 0 is the ground.
readonly origin=46.5191,6.5668,0,ground

scripts/setup.sh --yes --for build
command -v ogr2ogr >/dev/null && command -v gpsbabel >/dev/null ||
  scripts/setup.sh --yes --for judge
# Node from another source than Debian brings its own npm, and excludes Debian's.
command -v node >/dev/null && command -v npm >/dev/null || scripts/setup.sh --yes --for judge
lapwing_build release lapwing_app lapwing_all_plugins
judges=build/judges
mkdir -p "$judges"
cp tests/judges/*.js tests/judges/package.json tests/judges/package-lock.json "$judges"
npm ci --prefix "$judges" --no-audit --no-fund >"$judges/npm.log" 2>&1 ||
  { tail -n 20 "$judges/npm.log" >&2; exit 1; }

lapwing=build/release/bin/lapwing failed=0
printf '%-28s %-10s %s\n' example format verdict
for example in "${examples[@]}"; do
  read -r -a words <<<"$example"
  name=${words[0]} out=$judges/plans/${words[0]}
  # A plan that is not certified has a file to judge too.
  status=0
  "$lapwing" run "examples/$name.lua" "${words[@]:1}" -o "$out" --quiet >"$judges/run.log" 2>&1 ||
    status=$?
  if [ "$status" -gt 1 ]; then
    printf '%-28s %-10s %s\n' "$name" - "not planned: $(tail -n 1 "$judges/run.log")"
    failed=1
    continue
  fi
  for format in "${formats[@]}"; do
    short=${format%%:*}
    file=$out/plan.$short verdict=good
    if ! "$lapwing" export "$out/plan.json" --format "$format" -o "$file" --uncertified \
      --origin "$origin" >"$judges/export.log" 2>&1; then
      verdict="not written: $(tail -n 1 "$judges/export.log")"
    elif ! found=$(node "$judges/$short.js" "$file" "$out/plan.json" "$origin" 2>&1); then
      verdict="BAD: $(head -n 1 <<<"$found")"
    fi
    [ "$verdict" = good ] || failed=1
    printf '%-28s %-10s %s\n' "$name" "$short" "$verdict"
  done
done
exit "$failed"
