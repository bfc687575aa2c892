// SPDX-License-Identifier: Apache-2.0
// In what two plans differ: options, task, figures, certificates, paths.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/app/plan_figures.h"
#include "framework/verify/certificate.h"

namespace lapwing {

struct ComparedPlan {
  std::filesystem::path file;
  Plan plan;
  Value document;  // as written
  PlanFigures figures;
  Certificate certificate;  // without checks where the plan has none
};

struct ValueDifference {
  std::string key;                     // "keyframes[2].time", as --set names it
  std::optional<Value> first, second;  // none: it is not there
};

struct PlanComparison {
  ComparedPlan first, second;
  bool same = false;                     // the documents say the same
  std::vector<ValueDifference> options;  // of the configurations
  std::vector<ValueDifference> task;     // of all else that was stated: vehicle, obstacles, task
  double distance = 0;                   // m, the largest between both at the same time
  double distance_at = 0;                // s
};

// Each a plan document, a run's folder or its report.html. InputError where one holds no plan.
PlanComparison compare_plans(const std::filesystem::path& first,
                             const std::filesystem::path& second);

// One row for each figure of either plan: what, unit, first, second. NaN: it has none.
struct FigureRow {
  std::string name, unit;
  double first, second;
};
std::vector<FigureRow> figure_rows(const PlanComparison& compared);
// The same for the terms of the cost.
std::vector<FigureRow> term_rows(const PlanComparison& compared);

// Checks whose results differ; null: that certificate has no such check.
struct CheckRow {
  const Check* first;
  const Check* second;
};
std::vector<CheckRow> check_rows(const PlanComparison& compared);

}  // namespace lapwing
