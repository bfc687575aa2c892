#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the studio's page into framework/studio/page/dist: scripts/page.sh. Needs Node 18 or newer.
# Packages are installed by their lock file into build/node, outside of the sources.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/node_packages.sh
install_node_packages framework/studio/page
npm run --silent --prefix framework/studio/page build
