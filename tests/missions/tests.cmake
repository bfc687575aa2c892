# SPDX-License-Identifier: Apache-2.0
# The shipped missions end to end, through the program; every designer's shot under label `long`.
get_property(plugins GLOBAL PROPERTY LAPWING_PLUGINS)
foreach(name missions missions_long)
  string(REPLACE missions_ missions/ folder ${name})
  lapwing_add_test_program(${name} ${CMAKE_CURRENT_LIST_DIR}/../${folder})
  add_dependencies(test_${name} lapwing_app ${plugins})
endforeach()
set_tests_properties(missions_long PROPERTIES LABELS long TIMEOUT 2700)  # a whole font among them
lapwing_slow_tests(missions "Slow*")
# The longest program, in two halves that may run at once; the longest begins first.
add_test(NAME missions_too COMMAND test_missions)
set(shard 0)
foreach(half missions missions_too)
  set_tests_properties(${half} PROPERTIES COST 1000 ENVIRONMENT
    "GTEST_FILTER=-Slow*;GTEST_TOTAL_SHARDS=2;GTEST_SHARD_INDEX=${shard}")
  math(EXPR shard "${shard} + 1")
endforeach()
