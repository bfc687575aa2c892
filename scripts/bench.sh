#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds and runs the benchmarks, each with the method that it is compared with: scripts/bench.sh
# [options of the benchmark program, such as --benchmark_filter=REGEX]. Prints medians and ratios.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh
. scripts/build.sh
scripts/setup.sh --yes --for build --for bench
if [ -z "${LAPWING_DATA:-}" ] && [ -d ../shared/data ]; then
  LAPWING_DATA=$(cd ../shared/data && pwd)
  export LAPWING_DATA
fi
lapwing_configure release -DLAPWING_BENCH=ON
lapwing_build release lapwing_bench lapwing_all_plugins
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
exec build/release/bin/lapwing_bench "$@"
