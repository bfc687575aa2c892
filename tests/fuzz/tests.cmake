# SPDX-License-Identifier: Apache-2.0
# The corpus, replayed by an ordinary test: every NAME_fuzz.cpp of this folder with the inputs in the
# folder NAME. With clang (preset fuzz) CMakeLists.txt beside this file makes the fuzzers themselves;
# here it sees that they would link.
add_subdirectory(${CMAKE_CURRENT_LIST_DIR} fuzz)
file(GLOB fuzzers CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/*_fuzz.cpp)
set(entries "")
set(readers "")
foreach(source ${fuzzers})
  get_filename_component(reader ${source} NAME_WE)
  string(REGEX REPLACE "_fuzz$" "" reader ${reader})
  string(APPEND entries "extern \"C\" int fuzz_${reader}(const std::uint8_t*, std::size_t);\n")
  string(APPEND readers "{\"${reader}\", fuzz_${reader}}, ")
  set_source_files_properties(${source} PROPERTIES
    COMPILE_DEFINITIONS LLVMFuzzerTestOneInput=fuzz_${reader})
endforeach()
set(reader_list ${CMAKE_CURRENT_BINARY_DIR}/fuzzed_readers.cpp)
file(CONFIGURE OUTPUT ${reader_list} @ONLY CONTENT "#include \"tests/fuzz/reader_list.h\"
${entries}
std::vector<lapwing::FuzzedReader> lapwing::fuzzed_readers() { return {${readers}}; }
")

add_executable(test_fuzz_corpus ${CMAKE_CURRENT_LIST_DIR}/corpus_test.cpp ${fuzzers} ${reader_list})
# Readers of flight logs are plugins: the fuzzers call their sources.
file(GLOB log_readers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/plugins/flight_logs/*/*_*.cpp)
target_sources(test_fuzz_corpus PRIVATE ${log_readers})
target_link_libraries(test_fuzz_corpus PRIVATE expat zstd lz4)
target_link_libraries(test_fuzz_corpus PRIVATE lapwing_studio lapwing GTest::gtest GTest::gtest_main)
target_compile_definitions(test_fuzz_corpus PRIVATE ${test_definitions})
target_compile_options(test_fuzz_corpus PRIVATE ${test_options})
target_precompile_headers(test_fuzz_corpus REUSE_FROM lapwing_test_precompiled)
add_test(NAME fuzz_corpus COMMAND test_fuzz_corpus)
