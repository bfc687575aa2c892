#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the studio's page and drives it in a browser: scripts/page_test.sh [--only WORDS]
# [--shots DIR]. See tests/studio_page/README.md. Exit status 1 if something fails, 77 without
# Chromium.
set -euo pipefail
cd "$(dirname "$0")/.."

# Node from another source than Debian brings its own npm, and excludes Debian's.
command -v node >/dev/null && command -v npm >/dev/null || scripts/setup.sh --yes --for judge
page=framework/studio/page tests=tests/studio_page
for folder in "$page" "$tests"; do
  if [ ! -e "$folder/node_modules/.package-lock.json" ] ||
    [ "$folder/package-lock.json" -nt "$folder/node_modules/.package-lock.json" ]; then
    npm ci --prefix "$folder" --no-audit --no-fund
  fi
done
npm run --silent --prefix "$page" build
npm test --silent --prefix "$page"
node "$tests/run.mjs" "$@"
