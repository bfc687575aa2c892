# SPDX-License-Identifier: Apache-2.0
# Flights are planned and flown by the program, as a user does.
if(TARGET test_fly)
  get_property(plugins GLOBAL PROPERTY LAPWING_PLUGINS)
  add_dependencies(test_fly lapwing_app ${plugins})
endif()
