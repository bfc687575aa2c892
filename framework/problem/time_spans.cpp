// SPDX-License-Identifier: Apache-2.0
#include "framework/problem/time_spans.h"

#include <algorithm>

namespace lapwing {
namespace {

constexpr double kOnStage = 1e-9;  // s, nearer to a stage than this is on it

void expect_inside(const std::vector<TimeSpan>& spans, const Horizon& horizon) {
  for (const TimeSpan& span : spans)
    if (span.start > horizon.end() + kOnStage)
      throw InputError("a span begins at " + std::to_string(span.start) + " s, after the end at " +
                       std::to_string(horizon.end()) + " s");
}

}  // namespace

ParameterTable time_span_table() {
  return ParameterTable{}
      .required_number("start", "s", "start of the span", at_least(0))
      .required_number("finish", "s", "end of the span", at_least(0));
}

std::vector<TimeSpan> time_spans(const Parameters& parameters, std::string_view name) {
  std::vector<TimeSpan> result;
  for (const Parameters& given : parameters.tables(name)) {
    result.push_back({given.number("start"), given.number("finish")});
    if (result.back().finish < result.back().start)
      throw InputError(given.origin("finish"), std::string(name) + ": the span from " +
                                                   std::to_string(result.back().start) +
                                                   " s ends before it begins, at " +
                                                   std::to_string(result.back().finish) + " s");
  }
  return result;
}

void ask_within(FunctionShape& shape, const Horizon& horizon, const std::vector<TimeSpan>& only,
                const std::vector<TimeSpan>& except) {
  expect_inside(only, horizon);
  expect_inside(except, horizon);
  if (only.empty() && except.empty()) return;
  shape.stages.clear();
  for (int i = 0; i + shape.window <= horizon.stages; ++i) {
    const double first = horizon.time(i), last = horizon.time(i + shape.window - 1);
    const auto holds = [&](const TimeSpan& span) {
      return span.start <= first + kOnStage && last - kOnStage <= span.finish;
    };
    const auto overlaps = [&](const TimeSpan& span) {
      return span.start <= last + kOnStage && first - kOnStage <= span.finish;
    };
    if (!only.empty() && std::none_of(only.begin(), only.end(), holds)) continue;
    if (std::none_of(except.begin(), except.end(), overlaps)) shape.stages.push_back(i);
  }
  if (!shape.stages.empty()) return;
  shape.rows = 0;
  shape.row_names.clear();
}

}  // namespace lapwing
