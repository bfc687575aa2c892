// SPDX-License-Identifier: Apache-2.0
#include "framework/explore/view_utility.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/number_text.h"

namespace lapwing {

namespace {
constexpr std::size_t kViewsAtOnce = 64;
}

void ViewUtility::score(const EpisodeView& known, std::span<const Viewpoint> views,
                        std::span<double> values) const {
  if (views.size() != values.size()) throw Error("as many values as views are needed");
  if (!known.map || !known.means) throw Error("a utility needs a map and its means");
  if (views.empty()) return;
  // One call values a few views, so that what hangs can be told from what has much to do.
  for (std::size_t first = 0; first < views.size(); first += kViewsAtOnce) {
    const std::size_t count = std::min(kViewsAtOnce, views.size() - first);
    in_plugin(*this, "values_of",
              [&] { values_of(known, views.subspan(first, count), values.subspan(first, count)); });
  }
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (std::isfinite(values[i])) continue;
    const Viewpoint& view = views[i];
    const std::string wrong = "the utility of the view from (" + plain_number(view.position.x()) +
                              ", " + plain_number(view.position.y()) + ", " +
                              plain_number(view.position.z()) + ") with yaw " +
                              plain_number(view.yaw) + " is " + plain_number(values[i]) +
                              ", which is not a finite number";
    if (!plugin_name()) throw Error(wrong);
    throw plugin_failure(plugin_name(), "values_of", wrong);
  }
}

}  // namespace lapwing
