#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds what is needed, the page included, then opens a mission in the studio:
#   scripts/studio.sh MISSION.lua [options of `lapwing studio`]
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
if [ $# -lt 1 ]; then
  echo "usage: scripts/studio.sh MISSION.lua [options], for example" >&2
  echo "       scripts/studio.sh examples/filming/castle_flyover.lua" >&2
  exit 2
fi
(
  cd "$root"
  . scripts/packages.sh
  . scripts/build.sh
  page=framework/studio/page
  option=-DLAPWING_STUDIO=OFF
  if [ -f $page/package.json ]; then
    scripts/setup.sh --for build --for studio || exit 2
    mkdir -p build
    echo "Building the page, log in build/page.log ..." >&2
    bash scripts/page.sh >build/page.log 2>&1 || { tail -n 30 build/page.log >&2; exit 1; }
    option=-DLAPWING_STUDIO=ON
  else
    scripts/setup.sh --for build || exit 2
  fi
  # Tests are not needed here. A build folder with tests keeps them.
  [ -f build/release/build.ninja ] || lapwing_configure release -DLAPWING_TESTS=OFF
  lapwing_configure release $option
  lapwing_build release lapwing_app lapwing_all_plugins
)
[ -z "${LAPWING_DATA:-}" ] && [ -d "$root/../shared/data" ] && export LAPWING_DATA="$root/../shared/data"
exec "$root/build/release/bin/lapwing" studio "$@"
