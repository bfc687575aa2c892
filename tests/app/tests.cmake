# SPDX-License-Identifier: Apache-2.0
# The program and its plugins are run as a user runs them.
if(TARGET test_app)
  get_property(plugins GLOBAL PROPERTY LAPWING_PLUGINS)
  add_dependencies(test_app lapwing_app lapwing_manual ${plugins})
  add_dependencies(test_mission ${plugins})
  # The longest program begins first; with another one last, a core would idle.
  set_tests_properties(app PROPERTIES COST 2000)
  lapwing_slow_tests(app "Slow*")
endif()
