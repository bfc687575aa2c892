# The shipped missions end to end, through the program; every designer's shot under label `long`.
get_property(plugins GLOBAL PROPERTY LAPWING_PLUGINS)
foreach(name missions missions_long)
  string(REPLACE missions_ missions/ folder ${name})
  lapwing_add_test_program(${name} ${CMAKE_CURRENT_LIST_DIR}/../${folder})
  add_dependencies(test_${name} lapwing_app ${plugins})
endforeach()
set_tests_properties(missions_long PROPERTIES LABELS long TIMEOUT 900)
set_tests_properties(missions PROPERTIES COST 1000)  # the longest begins first
