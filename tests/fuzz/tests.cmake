# The corpus, replayed by an ordinary test; with clang (preset fuzz) the fuzzers themselves.
add_executable(test_fuzz_corpus ${CMAKE_CURRENT_LIST_DIR}/corpus_test.cpp)
foreach(reader map_reader mesh_reader depth_reader)
  set(source ${CMAKE_CURRENT_LIST_DIR}/${reader}_fuzz.cpp)
  target_sources(test_fuzz_corpus PRIVATE ${source})
  set_source_files_properties(${source} PROPERTIES
    COMPILE_DEFINITIONS LLVMFuzzerTestOneInput=fuzz_${reader})
endforeach()
target_link_libraries(test_fuzz_corpus PRIVATE lapwing GTest::gtest GTest::gtest_main)
target_compile_definitions(test_fuzz_corpus PRIVATE ${test_definitions})
target_compile_options(test_fuzz_corpus PRIVATE ${test_options})
target_precompile_headers(test_fuzz_corpus REUSE_FROM lapwing_test_precompiled)
add_test(NAME fuzz_corpus COMMAND test_fuzz_corpus)
