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
readonly -A endings=([gltf]=glb)

scripts/setup.sh --yes --for build
# Node from another source than Debian brings its own npm, and excludes Debian's.
command -v node >/dev/null && command -v npm >/dev/null || scripts/setup.sh --yes --for judge
lapwing_build release lapwing_app lapwing_all_plugins
judges=build/judges
mkdir -p "$judges"
cp tests/judges/*.js tests/judges/package.json tests/judges/package-lock.json "$judges"
npm ci --prefix "$judges" --no-audit --no-fund >"$judges/npm.log" 2>&1 ||
  { tail -n 20 "$judges/npm.log" >&2; exit 1; }

lapwing=build/release/bin/lapwing failed=0
printf '%-28s %-6s %s\n' example format verdict
for example in "${examples[@]}"; do
  read -r -a words <<<"$example"
  name=${words[0]} out=$judges/plans/${words[0]}
  # A plan that is not certified has a file to judge too.
  status=0
  "$lapwing" run "examples/$name.lua" "${words[@]:1}" -o "$out" --quiet >"$judges/run.log" 2>&1 ||
    status=$?
  if [ "$status" -gt 1 ]; then
    printf '%-28s %-6s %s\n' "$name" - "not planned: $(tail -n 1 "$judges/run.log")"
    failed=1
    continue
  fi
  for format in "${!endings[@]}"; do
    file=$out/plan.${endings[$format]} verdict=good
    if ! "$lapwing" export "$out/plan.json" --format "$format" -o "$file" --uncertified \
      >"$judges/export.log" 2>&1; then
      verdict="not written: $(tail -n 1 "$judges/export.log")"
    elif ! found=$(node "$judges/$format.js" "$file" 2>&1); then
      verdict="BAD: $(head -n 1 <<<"$found")"
    fi
    [ "$verdict" = good ] || failed=1
    printf '%-28s %-6s %s\n' "$name" "$format" "$verdict"
  done
done
exit "$failed"
