# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` lays down, and what find_package(lapwing) finds: in an install, or in a build
# tree by -Dlapwing_DIR=BUILD.
include(CMakePackageConfigHelpers)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/lapwing)

set_target_properties(lapwing_app lapwing_sidecar PROPERTIES
  INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
install(TARGETS lapwing lapwing_app lapwing_sidecar EXPORT lapwing_targets)
if(TARGET lapwing_projection)
  install(TARGETS lapwing_projection LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/lapwing)
endif()
foreach(program lapwing_raster lapwing_city)
  if(TARGET ${program})
    install(TARGETS ${program} RUNTIME DESTINATION ${CMAKE_INSTALL_LIBDIR}/lapwing)
  endif()
endforeach()
install(EXPORT lapwing_targets NAMESPACE lapwing:: DESTINATION ${package})
export(EXPORT lapwing_targets NAMESPACE lapwing:: FILE ${CMAKE_BINARY_DIR}/lapwing_targets.cmake)

# Plugins see the kernel's headers; Lua, studies and the command line stay inside.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/framework
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lapwing FILES_MATCHING PATTERN "*.h"
  PATTERN "framework/mission" EXCLUDE PATTERN "framework/study" EXCLUDE PATTERN "framework/studio" EXCLUDE
  PATTERN "framework/app" EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/configs ${PROJECT_SOURCE_DIR}/scripts
  ${PROJECT_SOURCE_DIR}/examples DESTINATION ${CMAKE_INSTALL_DATADIR}/lapwing)
install(FILES plugin/lapwing_plugin.cmake plugin/plugin_exports.map DESTINATION ${package})

foreach(place build install)
  set(LAPWING_PLUGIN_CMAKE "\${CMAKE_CURRENT_LIST_DIR}/lapwing_plugin.cmake")
  set(config ${CMAKE_CURRENT_BINARY_DIR}/installed/lapwing-config.cmake)
  file(RELATIVE_PATH LAPWING_PREFIX /prefix/${package} /prefix)
  if(place STREQUAL build)
    set(LAPWING_PLUGIN_CMAKE ${CMAKE_CURRENT_SOURCE_DIR}/plugin/lapwing_plugin.cmake)
    set(config ${CMAKE_BINARY_DIR}/lapwing-config.cmake)
    set(LAPWING_PREFIX "")  # plugins are not installed into a build tree
  endif()
  configure_file(lapwing-config.cmake.in ${config} @ONLY)
endforeach()
write_basic_package_version_file(${CMAKE_BINARY_DIR}/lapwing-config-version.cmake
  VERSION ${PROJECT_VERSION} COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/installed/lapwing-config.cmake
  ${CMAKE_BINARY_DIR}/lapwing-config-version.cmake DESTINATION ${package})

# The manual and the completions are written by the program itself, from the commands that it has.
include(GNUInstallDirs)
set(manual ${CMAKE_BINARY_DIR}/share)
set(manual_files ${manual}/man/man1/lapwing.1)
set(write_manual COMMAND ${CMAKE_COMMAND} -E make_directory ${manual}/man/man1
                 COMMAND lapwing_app man > ${manual}/man/man1/lapwing.1)
foreach(shell bash:bash-completion/completions/lapwing zsh:zsh/site-functions/_lapwing
        fish:fish/vendor_completions.d/lapwing.fish)
  string(REPLACE ":" ";" shell ${shell})
  list(GET shell 0 name)
  list(GET shell 1 file)
  get_filename_component(folder ${file} DIRECTORY)
  list(APPEND manual_files ${manual}/${file})
  list(APPEND write_manual COMMAND ${CMAKE_COMMAND} -E make_directory ${manual}/${folder}
                           COMMAND lapwing_app completion ${name} > ${manual}/${file})
  install(FILES ${manual}/${file} DESTINATION ${CMAKE_INSTALL_DATADIR}/${folder})
endforeach()
add_custom_command(OUTPUT ${manual_files} ${write_manual} DEPENDS lapwing_app VERBATIM)
add_custom_target(lapwing_manual ALL DEPENDS ${manual_files})
install(FILES ${manual}/man/man1/lapwing.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
