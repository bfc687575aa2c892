# SPDX-License-Identifier: Apache-2.0
# Debian packages that Lapwing needs; sourced by the other scripts.
# For building, and for authors of plugins: the default generator of CMake calls make.
lapwing_packages=(
  g++ cmake ninja-build make ccache pkg-config
  libeigen3-dev libyaml-cpp-dev liblua5.4-dev libspdlog-dev libfmt-dev nlohmann-json3-dev
  libcli11-dev libgeographiclib-dev libembree-dev libpng-dev libtbb-dev libassimp-dev
  libcgal-dev liboctomap-dev libopencv-calib3d-dev libompl-dev coinor-libipopt-dev libnlopt-dev
  coinor-libcbc-dev libboost-dev libexpat1-dev libzstd-dev liblz4-dev
)
lapwing_test_packages=(libgtest-dev libgmock-dev chromium binutils groff-base zsh fish gdal-bin)
lapwing_bench_packages=(libbenchmark-dev)
lapwing_fuzz_packages=(clang libclang-rt-14-dev)
lapwing_learn_packages=(libtorch-dev)
# For coordinates, rasters and positions of photographs of surveyors; Lapwing is built with what of
# these is installed.
lapwing_sites_packages=(libproj-dev libgdal-dev libcitygml-dev libexif-dev)
# For many processes and machines; the executor mpi is built where these are installed.
lapwing_cluster_packages=(libopenmpi-dev openmpi-bin)
lapwing_fresh_packages=(debootstrap)
lapwing_judge_packages=(nodejs npm gdal-bin gpsbabel unzip)
lapwing_studio_packages=(nodejs npm)  # for scripts/studio.sh, beside those for building
lapwing_check_packages=(clang-format clang-tidy)  # for scripts/format.sh and scripts/tidy.sh
lapwing_package_packages=(dpkg-dev file)  # dpkg-shlibdeps finds the dependencies of a .deb

# Prints the packages among "$@" that are not installed. A Node from another source than Debian
# brings its own npm, and its package excludes Debian's: there the commands decide.
lapwing_missing() {
  local package
  for package in "$@"; do
    case "$package" in nodejs | npm)
      if command -v node >/dev/null && command -v npm >/dev/null; then continue; fi ;;
    esac
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] ||
      printf '%s\n' "$package"
  done
}
