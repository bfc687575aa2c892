# SPDX-License-Identifier: Apache-2.0
# Copies the derivative term into a new folder under another name, configures and builds it with the
# plugins' own list, which finds it by itself, and checks what the registry then offers.
set(root ${LAPWING_BUILD_DIR}/tests/copied_term)
set(name copied_smoothness)
set(folder ${root}/source/plugins/cost_terms/${name})
file(REMOVE_RECURSE ${root})
file(MAKE_DIRECTORY ${folder})

# The tree: the kernel's headers as they are, the plugins' list as it is, and the new folder.
file(CREATE_LINK ${LAPWING_SOURCE_DIR}/framework ${root}/source/framework SYMBOLIC)
file(COPY ${LAPWING_SOURCE_DIR}/plugins/CMakeLists.txt
     DESTINATION ${root}/source/plugins)
file(COPY ${LAPWING_SOURCE_DIR}/tests/plugins/copied_term/CMakeLists.txt DESTINATION ${root}/source)
file(READ ${LAPWING_SOURCE_DIR}/plugins/cost_terms/derivative/derivative.cpp text)
string(REPLACE "derivative" "${name}" text "${text}")
file(WRITE ${folder}/${name}.cpp "${text}")
file(WRITE ${folder}/CMakeLists.txt "lapwing_add_plugin(cost_term ${name})\n")

function(run what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output
                  ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${what} failed:\n${output}")
  endif()
  message(STATUS "${what}: done\n${output}")
endfunction()
run("Configuring" ${CMAKE_COMMAND} -S ${root}/source -B ${root}/build -G ${GENERATOR}
    -DCMAKE_BUILD_TYPE=${BUILD_TYPE} -DCMAKE_CXX_COMPILER=${COMPILER}
    -DLAPWING_SANITIZE=${SANITIZE} -DLAPWING_BUILD_DIR=${LAPWING_BUILD_DIR})
run("Building" ${CMAKE_COMMAND} --build ${root}/build)
run("Checking" ${CHECK} ${root}/build/lib/plugins cost_term ${name})
