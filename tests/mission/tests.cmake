# SPDX-License-Identifier: Apache-2.0
# The tests of the mission room look into Lua itself.
find_package(PkgConfig REQUIRED)
pkg_check_modules(LUA REQUIRED IMPORTED_TARGET lua5.4-c++)
target_link_libraries(test_mission PRIVATE PkgConfig::LUA)
