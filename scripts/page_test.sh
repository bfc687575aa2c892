#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the studio's page, tests its logic and drives it in a browser: scripts/page_test.sh
# [--only WORDS] [--shots DIR]. See tests/studio_page/README.md. Exit status 1 if something fails,
# 77 without Chromium.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/node_packages.sh
scripts/page.sh
install_node_packages tests/studio_page
npm test --silent --prefix framework/studio/page
node tests/studio_page/run.mjs "$@"
