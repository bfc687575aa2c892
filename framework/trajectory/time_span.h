// SPDX-License-Identifier: Apache-2.0
// A span of time.
#pragma once

namespace lapwing {

struct TimeSpan {
  double start = 0, finish = 0;  // s, both included
};

}  // namespace lapwing
