# Opens generated reports in a headless browser.
find_program(LAPWING_CHROMIUM NAMES chromium chromium-browser google-chrome)
lapwing_add_test_program(report_browser ${CMAKE_CURRENT_LIST_DIR}/browser)
target_compile_definitions(test_report_browser PRIVATE
  LAPWING_CHROMIUM="$<IF:$<BOOL:${LAPWING_CHROMIUM}>,${LAPWING_CHROMIUM},>")
set_tests_properties(report_browser PROPERTIES LABELS browser TIMEOUT 60)
