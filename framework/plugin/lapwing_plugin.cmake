# SPDX-License-Identifier: Apache-2.0
# lapwing_add_plugin(KIND NAME [FAMILY name...] [SOURCES file...] [LIBRARIES target...]
#                    [OUTPUT folder])
#
# Builds lib/plugins/KINDs/NAME.so (or folder/NAME.so) from NAME.cpp with one exported symbol,
# undefined symbols as link errors, and the sidecar NAME.json beside it. A family is one library with
# several plugins, which are listed; NAME is then that of the library alone. It is installed to
# lib/lapwing/plugins, unless a folder was given.
#
# The same function serves Lapwing's own tree and projects that found it by find_package(lapwing);
# there it also adds the test check_NAME, which is `lapwing plugins check`.
include(GNUInstallDirs)
set(LAPWING_PLUGIN_EXPORTS ${CMAKE_CURRENT_LIST_DIR}/plugin_exports.map)

function(lapwing_add_plugin kind name)
  cmake_parse_arguments(PLUGIN "" "OUTPUT" "FAMILY;SOURCES;LIBRARIES" ${ARGN})
  if(PLUGIN_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "lapwing_add_plugin(${kind} ${name}): unknown ${PLUGIN_UNPARSED_ARGUMENTS}")
  endif()
  if(NOT PLUGIN_SOURCES)
    set(PLUGIN_SOURCES ${name}.cpp)
  endif()
  set(installed "")
  if(NOT PLUGIN_OUTPUT)
    set(folder ${kind}s)
    string(REGEX REPLACE "^utilitys$" "utilities" folder ${folder})
    string(REGEX REPLACE "^informations$" "information" folder ${folder})
    set(PLUGIN_OUTPUT ${CMAKE_BINARY_DIR}/lib/plugins/${folder})
    set(installed ${CMAKE_INSTALL_LIBDIR}/lapwing/plugins/${folder})
  endif()
  set(target lapwing_${kind}_${name})
  add_library(${target} MODULE ${PLUGIN_SOURCES})
  target_link_libraries(${target} PRIVATE lapwing::lapwing ${PLUGIN_LIBRARIES})
  # The export list also hides what the visibility flags cannot: instances of library templates.
  set_target_properties(${target} PROPERTIES
    CXX_STANDARD 20 CXX_EXTENSIONS OFF
    PREFIX "" SUFFIX ".so" OUTPUT_NAME ${name}
    LIBRARY_OUTPUT_DIRECTORY ${PLUGIN_OUTPUT}
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
    INSTALL_RPATH "$ORIGIN/../../.."
    LINK_DEPENDS ${LAPWING_PLUGIN_EXPORTS})
  target_link_options(${target} PRIVATE -Wl,--version-script=${LAPWING_PLUGIN_EXPORTS})
  if(NOT LAPWING_SANITIZE)
    target_link_options(${target} PRIVATE -Wl,--no-undefined)
  endif()
  if(TARGET lapwing_precompiled)  # not where lapwing is installed
    target_precompile_headers(${target} REUSE_FROM lapwing_precompiled)
  endif()
  add_custom_command(TARGET ${target} POST_BUILD
    COMMAND lapwing::lapwing_sidecar $<TARGET_FILE:${target}> ${PLUGIN_OUTPUT}/${name}.json
    BYPRODUCTS ${PLUGIN_OUTPUT}/${name}.json
    COMMENT "Describing ${kind} ${name}" VERBATIM)
  if(TARGET lapwing_sidecar)
    add_dependencies(${target} lapwing_sidecar)
  elseif(BUILD_TESTING)
    add_test(NAME check_${name} COMMAND lapwing::lapwing_app plugins check $<TARGET_FILE:${target}>)
  endif()
  if(installed)
    install(TARGETS ${target} LIBRARY DESTINATION ${installed})
    install(FILES ${PLUGIN_OUTPUT}/${name}.json DESTINATION ${installed})
  endif()
  set_property(GLOBAL APPEND PROPERTY LAPWING_PLUGINS ${target})
endfunction()
