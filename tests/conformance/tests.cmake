# Every plugin of the build tree is checked, so all of them must be there.
get_property(all_plugins GLOBAL PROPERTY LAPWING_PLUGINS)
add_dependencies(test_conformance ${all_plugins})
target_sources(test_conformance PRIVATE ${PROJECT_SOURCE_DIR}/framework/app/allocation_counter.cpp)
# What takes half a minute by itself runs with the long tests.
set(slow_solvers "Registered/EveryPlugin.Conforms/tour_solver_recursive_greedy:Registered/EveryPlugin.Conforms/tour_solver_milp")
set_tests_properties(conformance PROPERTIES ENVIRONMENT "GTEST_FILTER=-${slow_solvers}")
add_test(NAME conformance_long COMMAND test_conformance)
set_tests_properties(conformance_long PROPERTIES LABELS long TIMEOUT 240
                     ENVIRONMENT "GTEST_FILTER=${slow_solvers}")
