# SPDX-License-Identifier: Apache-2.0
# Of scripts/judge.sh alone.
add_executable(mavlink_samples EXCLUDE_FROM_ALL ${CMAKE_CURRENT_SOURCE_DIR}/judges/mavlink_samples.cpp)
target_link_libraries(mavlink_samples PRIVATE lapwing)
