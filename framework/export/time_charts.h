// SPDX-License-Identifier: Apache-2.0
// Charts of one plan over time, with its keyframes as markers and its cuts as spans.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "framework/export/report.h"
#include "framework/trajectory/plan.h"

namespace lapwing {

// The axis that all charts and drawings of a flight share.
Axis time_axis();
// Lines at a limit in both directions.
std::vector<LimitLine> both_ways(double limit);

class TimeCharts {
 public:
  // Keeps a reference.
  explicit TimeCharts(const Plan& plan);

  // One value per sample, `read(sample)`; `stepped` inputs are drawn so where they are held.
  template <class Read>
  Series series(const std::string& name, Read read, bool stepped = false) const {
    Series out{name, times_, {}, stepped && plan_.trajectory.inputs_held};
    for (const Sample& s : plan_.trajectory.samples) out.y.push_back(read(s));
    return out;
  }

  Chart chart(const std::string& title, const std::string& label, const std::string& unit,
              std::vector<Series> series, std::vector<LimitLine> limits = {}) const;

 private:
  const Plan& plan_;
  std::vector<double> times_;
  std::vector<Marker> markers_;
  std::vector<Span> cuts_;
};

}  // namespace lapwing
