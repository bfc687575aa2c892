#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds what is needed, then runs a mission: scripts/run.sh MISSION.lua [options of `lapwing run`].
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
if [ $# -lt 1 ]; then
  echo "usage: scripts/run.sh MISSION.lua [options], for example" >&2
  echo "       scripts/run.sh examples/filming/castle_flyover.lua" >&2
  exit 2
fi
(
  cd "$root"
  . scripts/packages.sh
  . scripts/build.sh
  scripts/setup.sh --for build || exit 2
  # Tests are not needed here. A build folder with tests keeps them.
  [ -f build/release/build.ninja ] || lapwing_configure release -DLAPWING_TESTS=OFF
  lapwing_build release lapwing_app lapwing_all_plugins
)
[ -z "${LAPWING_DATA:-}" ] && [ -d "$root/../shared/data" ] && export LAPWING_DATA="$root/../shared/data"
exec "$root/build/release/bin/lapwing" run "$@"
