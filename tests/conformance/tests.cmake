# SPDX-License-Identifier: Apache-2.0
# Every plugin of the build tree is checked, so all of them must be there.
get_property(all_plugins GLOBAL PROPERTY LAPWING_PLUGINS)
add_dependencies(test_conformance ${all_plugins})
target_sources(test_conformance PRIVATE ${PROJECT_SOURCE_DIR}/framework/app/allocation_counter.cpp)
# What takes some ten seconds by itself runs with the long tests.
set(slow_plugins tour_solver_recursive_greedy tour_solver_milp path_planner_rrt_star
    path_planner_informed_rrt_star controller_contouring controller_mpc)
list(TRANSFORM slow_plugins PREPEND Registered/EveryPlugin.Conforms/)
list(JOIN slow_plugins ":" slow_plugins)
lapwing_slow_tests(conformance "${slow_plugins}")
