// SPDX-License-Identifier: Apache-2.0
// The items of a long command: independent pieces of work, each of which writes one file.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace lapwing {

struct Item {
  std::string file;       // named by the item's inputs, relative to the folder of the results
  std::size_t group = 0;  // items of one group use what is prepared once for the group
  // Kinds of items that take about as long, the most specific first. Expected times come from
  // measured items of the same kind.
  std::vector<std::string> kinds = {};
};

// Wall-clock time in s that one item took; `preparation` is 0 if its group was prepared before.
struct ItemSeconds {
  double item = 0, preparation = 0;
};

}  // namespace lapwing
