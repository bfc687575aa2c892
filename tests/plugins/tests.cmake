# SPDX-License-Identifier: Apache-2.0
# Tests of plugins create them through the registry.
get_property(all_plugins GLOBAL PROPERTY LAPWING_PLUGINS)
add_dependencies(test_cost_terms ${all_plugins})
add_dependencies(test_constraints ${all_plugins})
add_dependencies(test_vehicle_models ${all_plugins})
foreach(room shapes verify export problem trajectory)
  add_dependencies(test_${room} ${all_plugins})
endforeach()

# A cost term copied into a new folder is picked up with one CMake line and no kernel edit.
add_executable(check_plugin_folder ${CMAKE_CURRENT_LIST_DIR}/copied_term/check_plugin_folder.cpp)
target_link_libraries(check_plugin_folder PRIVATE lapwing)
target_precompile_headers(check_plugin_folder REUSE_FROM lapwing_precompiled)
add_test(NAME copied_term COMMAND ${CMAKE_COMMAND}
  -DLAPWING_SOURCE_DIR=${PROJECT_SOURCE_DIR} -DLAPWING_BUILD_DIR=${CMAKE_BINARY_DIR}
  -DBUILD_TYPE=${CMAKE_BUILD_TYPE} -DSANITIZE=${LAPWING_SANITIZE} -DGENERATOR=${CMAKE_GENERATOR}
  -DCOMPILER=${CMAKE_CXX_COMPILER} -DCHECK=$<TARGET_FILE:check_plugin_folder>
  -P ${CMAKE_CURRENT_LIST_DIR}/copied_term/copied_term.cmake)

# How long executors take for an item, alone or under mpirun.
add_executable(executor_pace ${CMAKE_CURRENT_LIST_DIR}/executors/pace/executor_pace.cpp)
target_link_libraries(executor_pace PRIVATE lapwing)
target_compile_definitions(executor_pace PRIVATE LAPWING_BUILD_DIR="${CMAKE_BINARY_DIR}")
target_precompile_headers(executor_pace REUSE_FROM lapwing_precompiled)
add_dependencies(test_app executor_pace)

# The example plugin, built and run against an install tree; and a new plugin of every kind.
foreach(name installed_plugin new_plugins)
  add_test(NAME ${name} COMMAND ${CMAKE_COMMAND}
    -DLAPWING_SOURCE_DIR=${PROJECT_SOURCE_DIR} -DLAPWING_BUILD_DIR=${CMAKE_BINARY_DIR}
    -DGENERATOR=${CMAKE_GENERATOR} -DCOMPILER=${CMAKE_CXX_COMPILER}
    -P ${CMAKE_CURRENT_LIST_DIR}/installed/${name}.cmake)
endforeach()
set_tests_properties(new_plugins PROPERTIES LABELS long)

foreach(reader ulog dataflash gpx csv mcap tlog)
  add_dependencies(test_flight_logs lapwing_flight_log_${reader})
  add_dependencies(test_flight_review lapwing_flight_log_${reader})
endforeach()
add_dependencies(test_flight_logs lapwing_exporter_csv lapwing_exporter_mcap)
target_link_libraries(test_flight_logs PRIVATE zstd lz4)

find_package(octomap REQUIRED)
target_link_libraries(test_maps PRIVATE octomap octomath)
add_dependencies(test_maps lapwing_map_octomap lapwing_map_brick)
add_dependencies(test_path_planners lapwing_path_planner_ompl)
foreach(solver greedy cost_benefit recursive_greedy local_search milp)
  add_dependencies(test_tour_solvers lapwing_tour_solver_${solver})
endforeach()
foreach(controller thesis geometric tvlqr predictive)
  add_dependencies(test_controllers lapwing_controller_${controller})
endforeach()
target_sources(test_controllers PRIVATE
  ${PROJECT_SOURCE_DIR}/plugins/controllers/tvlqr/error_dynamics.cpp
  ${PROJECT_SOURCE_DIR}/plugins/controllers/predictive/horizon.cpp
  ${PROJECT_SOURCE_DIR}/plugins/controllers/predictive/observer.cpp)
add_dependencies(test_path lapwing_map_brick)
add_dependencies(test_explore lapwing_map_brick)
get_filename_component(learned ${PROJECT_SOURCE_DIR}/plugins/utilities/learned ABSOLUTE)
target_sources(test_utilities PRIVATE ${learned}/network.cpp ${learned}/kernels.cpp
  ${learned}/backpropagation.cpp ${learned}/ray_network.cpp ${learned}/grid_trainee.cpp
  ${learned}/ray_trainee.cpp ${learned}/without_torch.cpp ${learned}/model_file.cpp
  ${learned}/fit.cpp)
foreach(utility frontier average_entropy proximity_count oracle learned)
  add_dependencies(test_utilities lapwing_utility_${utility})
endforeach()

# The published orienteering instances with as much work as the README speaks of.
add_test(NAME orienteering_long
         COMMAND test_tour_solvers --gtest_filter=Orienteering.RoutesOfPublished*)
set_tests_properties(orienteering_long PROPERTIES LABELS long
                                                  ENVIRONMENT "LAPWING_LONG=1")

# The networks of the learned utilities against libtorch: one source, which takes longer than all
# others.
if(LAPWING_LEARN)
  add_executable(test_learned_torch ${CMAKE_CURRENT_LIST_DIR}/learned_torch/learned_torch_test.cpp
    ${learned}/network.cpp ${learned}/kernels.cpp ${learned}/backpropagation.cpp
    ${learned}/ray_network.cpp ${learned}/grid_trainee.cpp ${learned}/ray_trainee.cpp
    ${learned}/torch_trainee.cpp ${learned}/torch_networks.cpp ${learned}/model_file.cpp
    ${learned}/fit.cpp)
  target_compile_definitions(test_learned_torch PRIVATE ${test_definitions})
  target_link_libraries(test_learned_torch PRIVATE lapwing GTest::gtest GTest::gtest_main
    lapwing_torch)
  add_test(NAME learned_torch COMMAND test_learned_torch)
endif()
