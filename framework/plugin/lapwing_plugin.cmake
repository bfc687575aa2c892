# lapwing_add_plugin(KIND NAME [SOURCES file...] [LIBRARIES target...])
#
# Builds lib/plugins/KINDs/NAME.so from NAME.cpp with one exported symbol, undefined symbols as link
# errors, and the sidecar NAME.json beside it.
function(lapwing_add_plugin kind name)
  cmake_parse_arguments(PLUGIN "" "" "SOURCES;LIBRARIES" ${ARGN})
  if(NOT PLUGIN_SOURCES)
    set(PLUGIN_SOURCES ${name}.cpp)
  endif()
  set(target lapwing_${kind}_${name})
  add_library(${target} MODULE ${PLUGIN_SOURCES})
  target_link_libraries(${target} PRIVATE lapwing ${PLUGIN_LIBRARIES})
  set_target_properties(${target} PROPERTIES
    PREFIX "" OUTPUT_NAME ${name}
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib/plugins/${kind}s
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  if(NOT LAPWING_SANITIZE)
    target_link_options(${target} PRIVATE -Wl,--no-undefined)
  endif()
  if(TARGET lapwing_plugin_precompiled)
    target_precompile_headers(${target} REUSE_FROM lapwing_plugin_precompiled)
  endif()
  add_custom_command(TARGET ${target} POST_BUILD
    COMMAND lapwing_sidecar $<TARGET_FILE:${target}>
            ${CMAKE_BINARY_DIR}/lib/plugins/${kind}s/${name}.json
    COMMENT "Describing ${kind} ${name}" VERBATIM)
  add_dependencies(${target} lapwing_sidecar)
  set_property(GLOBAL APPEND PROPERTY LAPWING_PLUGINS ${target})
endfunction()
