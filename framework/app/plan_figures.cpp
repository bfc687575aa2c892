// SPDX-License-Identifier: Apache-2.0
#include "framework/app/plan_figures.h"

#include <cmath>

#include "framework/verify/certificate.h"

namespace lapwing {

namespace {

namespace fs = std::filesystem;

std::optional<double> used_share(const Check& check) {
  if (!check.required || !check.skipped.empty() || !check.worst) return {};
  const double worst = *check.worst, limit = check.limit;
  if (check.at_least && check.unit.empty() && limit > 0 && limit < 1)
    return (1 - worst) / (1 - limit);
  if (!(limit > 0)) return {};
  if (!check.at_least) return worst / limit;
  return worst > 0 ? limit / worst : std::numeric_limits<double>::infinity();
}

double number_in(const Value& map, const char* key) {
  const Value* found = map.find(key);
  return found && found->is_number() ? found->as_number() : PlanFigures::kNone;
}

void read_certificate(const Plan& plan, PlanFigures& figures) {
  if (plan.certificate.is_null()) return;
  const Certificate certificate = Certificate::from_value(plan.certificate);
  figures.verdict = certificate.feasible() ? "certified" : "not certified";
  for (const Check& check : certificate.checks) {
    const std::optional<double> share = used_share(check);
    if (share && (!figures.nearest || *share > figures.nearest->share))
      figures.nearest = NearestLimit{check.name, *share};
    if (check.name == "clearance" && check.skipped.empty() && check.worst)
      figures.clearance = *check.worst;
  }
  for (const Check& check : certificate.failures()) figures.reasons.push_back(to_line(check));
}

void read_solver(const Plan& plan, PlanFigures& figures) {
  figures.cost = number_in(plan.solver, "cost");
  if (const Value* terms = plan.solver.find("terms"); terms && terms->is_map())
    for (const auto& [name, cost] : terms->as_map())
      figures.terms.emplace_back(name, cost.is_number() ? cost.as_number() : PlanFigures::kNone);
  const Value* message = plan.solver.find("message");
  if (figures.verdict != "certified" && message && message->is_text() &&
      !message->as_text().empty())
    figures.reasons.push_back(message->as_text());
  figures.reasons = said_once(figures.reasons);
}

}  // namespace

std::vector<std::string> said_once(const std::vector<std::string>& sentences) {
  std::vector<std::string> kept;
  for (std::size_t i = 0; i < sentences.size(); ++i) {
    bool said = sentences[i].empty();
    for (std::size_t j = 0; j < sentences.size() && !said; ++j)
      said = j != i && sentences[j].find(sentences[i]) != std::string::npos &&
             (j < i || sentences[j].size() > sentences[i].size());
    if (!said) kept.push_back(sentences[i]);
  }
  return kept;
}

PlanFigures figures_of(const Plan& plan) {
  PlanFigures figures;
  const std::vector<Sample>& samples = plan.trajectory.samples;
  figures.duration = plan.trajectory.duration();
  for (std::size_t i = 1; i < samples.size(); ++i)
    figures.path_length += (samples[i].position - samples[i - 1].position).norm();
  if (plan.trajectory.motion.moves) {
    figures.top_speed = 0;
    for (const Sample& sample : samples)
      figures.top_speed = std::max(figures.top_speed, sample.velocity.norm());
  }
  read_certificate(plan, figures);
  read_solver(plan, figures);
  return figures;
}

Value to_value(const PlanFigures& figures) {
  const auto number = [](double value) { return std::isfinite(value) ? Value(value) : Value(); };
  Value value = Value::map();
  value.set("verdict", figures.verdict);
  value.set("duration", figures.duration);
  value.set("path_length", figures.path_length);
  value.set("top_speed", number(figures.top_speed));
  value.set("clearance", number(figures.clearance));
  value.set("cost", number(figures.cost));
  Value& terms = value.set("terms", Value::map());
  for (const auto& [name, cost] : figures.terms) terms.set(name, number(cost));
  if (figures.nearest) {
    Value& nearest = value.set("nearest_limit", Value::map());
    nearest.set("check", figures.nearest->check);
    nearest.set("share", number(figures.nearest->share));
  }
  Value& reasons = value.set("reasons", Value::list());
  for (const std::string& reason : figures.reasons) reasons.push_back(reason);
  return value;
}

fs::path plan_file(const fs::path& given) {
  std::error_code code;
  fs::path file = given;
  if (fs::is_directory(given, code)) file = given / "plan.json";
  if (given.filename() == "report.html") file = given.parent_path() / "plan.json";
  if (!fs::exists(file, code))
    throw InputError(file == given
                         ? "there is no plan '" + given.string() + "'"
                         : "'" + given.string() + "': there is no plan '" + file.string() + "'");
  return file;
}

}  // namespace lapwing
