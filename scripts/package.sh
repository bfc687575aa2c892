#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the program and its plugins and writes a Debian package, build/lapwing_VERSION_ARCH.deb:
#   scripts/package.sh
# `apt install ./build/lapwing_*.deb` then puts `lapwing` on the PATH of Debian 12.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/build.sh
scripts/setup.sh --yes --for build --for package
lapwing_build release lapwing_app lapwing_all_plugins lapwing_sidecar lapwing_manual
rm -f build/lapwing_*.deb
(cd build/release && cpack -G DEB -B "$PWD/..") >build/package.log 2>&1 ||
  { tail -n 20 build/package.log >&2; exit 1; }
rm -rf build/_CPack_Packages
ls build/lapwing_*.deb
