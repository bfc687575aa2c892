# SPDX-License-Identifier: Apache-2.0
# Opens generated reports in a headless browser.
lapwing_add_test_program(report_browser ${CMAKE_CURRENT_LIST_DIR}/browser)
set_tests_properties(report_browser PROPERTIES LABELS browser)
