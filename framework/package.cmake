# SPDX-License-Identifier: Apache-2.0
# The Debian package that scripts/package.sh writes: what `cmake --install` lays down, under /usr. dpkg-shlibdeps finds the packages that it needs.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME lapwing)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_PACKAGE_DESCRIPTION "Lua missions are planned, certified by an independent verifier and \
exported: films, races, light paintings, scan tours, maps and explorations. Cost terms, \
constraints, solvers, maps, utilities and exporters are plugins.")
set(CPACK_PACKAGE_CONTACT "The Lapwing developers")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_THREADS 0)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# Where plugins and programs find the kernel before it is installed.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})
# Who writes plugins compiles against the kernel's headers, which include Eigen's.
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "cmake, g++, libeigen3-dev")
# What is not installed, as the tests, need not be built for it.
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY TRUE)
include(CPack)
