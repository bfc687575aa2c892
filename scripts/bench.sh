#!/usr/bin/env bash
# Builds and runs the benchmarks, each against its named opponent: scripts/bench.sh [options of the
# benchmark program, such as --benchmark_filter=REGEX]. Prints medians and ratios.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh
. scripts/build.sh
scripts/setup.sh --yes --for build --for bench
lapwing_build bench all
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
exec build/bench/bin/lapwing_bench "$@"
