// SPDX-License-Identifier: Apache-2.0
#include "framework/study/scan_row.h"

#include <cmath>
#include <limits>

#include "framework/config/overrides.h"
#include "framework/core/error.h"
#include "framework/view/pattern_tour.h"
#include "framework/view/tour_solver.h"

namespace lapwing {
namespace {

std::vector<std::string> parts_of(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (;;) {
    const std::size_t end = text.find(separator, begin);
    parts.push_back(text.substr(begin, end - begin));
    if (end == text.npos) return parts;
    begin = end + 1;
  }
}

bool names_pattern(const std::string& text) {
  const std::string kind = text.substr(0, text.find('_'));
  return kind == "circle" || kind == "ellipse" || kind == "meander" || kind == "hemisphere";
}

ScanMethod::Solver solver_from(const std::string& text, const Registry& registry) {
  const std::size_t colon = text.find(':');
  ScanMethod::Solver solver{.name = text.substr(0, colon)};
  if (colon != text.npos) {
    std::vector<std::string> overrides = parts_of(text.substr(colon + 1), ',');
    solver.parameters = Value::map();
    for (const std::string& entry : overrides) apply_override(solver.parameters, entry);
  }
  registry.create<TourSolver>(solver.name, solver.parameters, "method " + text);
  return solver;
}

Value to_value(const ReconstructionScore& score) {
  Value value = Value::map();
  value.set("precision", score.precision);
  value.set("recall", score.recall);
  value.set("f", score.f);
  value.set("points", score.points);
  value.set("surface_points", score.surface_points);
  return value;
}

ReconstructionScore reconstruction_from(const Value& value) {
  ReconstructionScore score;
  score.precision = value.at("precision").as_number();
  score.recall = value.at("recall").as_number();
  score.f = value.at("f").as_number();
  score.points = value.at("points").as_integer();
  score.surface_points = value.at("surface_points").as_integer();
  return score;
}

}  // namespace

ScanMethod scan_method(const std::string& text, const Registry& registry) {
  ScanMethod method{.name = text};
  if (names_pattern(text)) {
    pattern_named(text, 1);
    method.pattern = true;
    return method;
  }
  for (const std::string& part : parts_of(text, '+')) {
    method.solvers.push_back(solver_from(part, registry));
  }
  return method;
}

Value to_value(const ScanRow& row) {
  Value value = Value::map();
  value.set("mission", row.mission);
  value.set("seed", static_cast<std::int64_t>(row.seed));
  value.set("budget", row.budget);
  value.set("method", row.method);
  value.set("status", row.status);
  value.set("message", row.message);
  value.set("found", row.found);
  value.set("reproducible", row.reproducible);
  value.set("counts", row.counts);
  if (std::isfinite(row.score)) {
    value.set("score", row.score);
    value.set("score_share", row.score_share);
  }
  if (row.upper_bound) value.set("upper_bound", *row.upper_bound);
  value.set("seconds", row.seconds);
  value.set("images", row.images);
  value.set("first_images", row.first_images);
  value.set("candidates", row.candidates);
  value.set("evaluations", row.evaluations);
  value.set("surface_share", row.surface_share);
  value.set("with_first", to_value(row.with_first));
  value.set("alone", to_value(row.alone));
  return value;
}

ScanRow scan_row_from(const Value& value) {
  ScanRow row;
  row.mission = value.at("mission").as_text();
  row.seed = static_cast<std::uint64_t>(value.at("seed").as_integer());
  row.budget = value.at("budget").as_number();
  row.method = value.at("method").as_text();
  row.status = value.at("status").as_text();
  row.message = value.at("message").as_text();
  row.found = value.at("found").as_boolean();
  row.reproducible = value.at("reproducible").as_boolean();
  row.counts = value.at("counts").as_boolean();
  const Value* score = value.find("score");
  constexpr double kNoScore = std::numeric_limits<double>::quiet_NaN();
  row.score = score ? score->as_number() : kNoScore;
  row.score_share = score ? value.at("score_share").as_number() : kNoScore;
  if (const Value* bound = value.find("upper_bound")) row.upper_bound = bound->as_number();
  row.seconds = value.at("seconds").as_number();
  row.images = static_cast<int>(value.at("images").as_integer());
  row.first_images = static_cast<int>(value.at("first_images").as_integer());
  row.candidates = static_cast<int>(value.at("candidates").as_integer());
  row.evaluations = value.at("evaluations").as_integer();
  row.surface_share = value.at("surface_share").as_number();
  row.with_first = reconstruction_from(value.at("with_first"));
  row.alone = reconstruction_from(value.at("alone"));
  return row;
}

}  // namespace lapwing
