# SPDX-License-Identifier: Apache-2.0
# Installs Lapwing into a folder of its own, builds the example plugin against that, checks it with the
# installed program, installs it too, and flies with it.
set(root ${LAPWING_BUILD_DIR}/tests/installed_plugin)
set(prefix ${root}/prefix)
file(REMOVE_RECURSE ${root})
file(COPY ${LAPWING_SOURCE_DIR}/examples/plugin/ DESTINATION ${root}/source)

function(run what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output
                  ERROR_VARIABLE output WORKING_DIRECTORY ${root}/source)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${what} failed (${result}):\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()
set(ENV{LAPWING_HOME} "")
set(ENV{LAPWING_PLUGIN_PATH} "")
set(ENV{XDG_DATA_HOME} ${root}/nothing)
run("Installing" ${CMAKE_COMMAND} --install ${LAPWING_BUILD_DIR} --prefix ${prefix})
run("Configuring" ${CMAKE_COMMAND} -B ${root}/build -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${COMPILER}
    -DCMAKE_PREFIX_PATH=${prefix})
run("Building" ${CMAKE_COMMAND} --build ${root}/build)
run("Checking" ${CMAKE_CTEST_COMMAND} --test-dir ${root}/build --output-on-failure)
if(NOT output MATCHES "100% tests passed, 0 tests failed out of 1")
  message(FATAL_ERROR "The check did not run:\n${output}")
endif()
run("Flying" ${prefix}/bin/lapwing --plugin-path ${root}/build/lib/plugins run nose_first.lua)
# To the letter of the guides, which name no prefix.
run("Installing the plugin" ${CMAKE_COMMAND} --install ${root}/build)
run("Listing" ${prefix}/bin/lapwing plugins show cost_term/nose_first)
if(NOT output MATCHES "${prefix}/lib[^\n]*/lapwing/plugins/cost_terms/nose_first.so")
  message(FATAL_ERROR "The plugin is not found where it was installed:\n${output}")
endif()
run("Flying again" ${prefix}/bin/lapwing run nose_first.lua --quiet)
file(REMOVE_RECURSE ${root})
