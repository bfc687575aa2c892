# The published orienteering instances with as much work as the README speaks of.
add_test(NAME orienteering_long
         COMMAND test_tour_solvers --gtest_filter=Orienteering.RoutesOfPublished*)
set_tests_properties(orienteering_long PROPERTIES LABELS long TIMEOUT 600
                                                  ENVIRONMENT "LAPWING_LONG=1")
