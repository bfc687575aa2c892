# SPDX-License-Identifier: Apache-2.0
# Plugins for the tests of room plugin, kept out of the folder where plugins are looked for.
set(fixtures ${CMAKE_CURRENT_LIST_DIR}/fixtures)
set(fixture_output ${CMAKE_BINARY_DIR}/tests/plugin_fixtures)

# Whole plugins, built as every plugin is.
lapwing_add_plugin(fixture good SOURCES ${fixtures}/good.cpp OUTPUT ${fixture_output}/whole)
lapwing_add_plugin(fixture throwing SOURCES ${fixtures}/throwing.cpp OUTPUT ${fixture_output}/whole)
lapwing_add_plugin(fixture duplicate SOURCES ${fixtures}/duplicate.cpp
                   OUTPUT ${fixture_output}/duplicate)
# Terms with one mistake each, for `lapwing plugins check`.
lapwing_add_plugin(cost_term broken_term SOURCES ${fixtures}/broken_term.cpp
                   OUTPUT ${fixture_output}/broken_terms)
# Plugins of the other kinds, likewise: without a mistake, and with one each.
foreach(name broken_motion broken_views broken_logs broken_executor)
  lapwing_add_plugin(fixture ${name} SOURCES ${fixtures}/${name}.cpp
                     OUTPUT ${fixture_output}/broken_kinds)
  add_dependencies(test_app lapwing_fixture_${name})
endforeach()
# Plugins of every kind that misbehave in a call.
lapwing_add_plugin(fixture rogue SOURCES ${fixtures}/rogue.cpp OUTPUT ${fixture_output}/rogue)
add_dependencies(test_app lapwing_cost_term_broken_term lapwing_fixture_rogue)
add_dependencies(test_plugin lapwing_fixture_good lapwing_fixture_throwing
                 lapwing_fixture_duplicate)

# Broken ones, which lapwing_add_plugin would refuse to build: they have no sidecar.
foreach(name other_abi no_symbol undefined_symbol throwing_library bad_preset)
  add_library(fixture_${name} MODULE ${fixtures}/${name}.cpp)
  target_link_libraries(fixture_${name} PRIVATE lapwing)
  set_target_properties(fixture_${name} PROPERTIES PREFIX "" OUTPUT_NAME ${name}
    LIBRARY_OUTPUT_DIRECTORY ${fixture_output}/broken CXX_VISIBILITY_PRESET hidden)
  add_dependencies(test_plugin fixture_${name})
  add_dependencies(test_app fixture_${name})
endforeach()
foreach(name undefined_symbol throwing_library bad_preset)
  target_precompile_headers(fixture_${name} REUSE_FROM lapwing_precompiled)
endforeach()
# The tests compare every plugin with its sidecar, so all of them must be there.
get_property(all_plugins GLOBAL PROPERTY LAPWING_PLUGINS)
add_dependencies(test_plugin ${all_plugins})
