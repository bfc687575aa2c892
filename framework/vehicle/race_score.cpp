// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/race_score.h"

#include <cmath>

#include "framework/trajectory/gate_passage.h"

namespace lapwing {
namespace {

constexpr double kGateTolerance = 1e-3;  // m, as the verifier's

std::string name_of(const std::vector<GateTask>& gates, std::size_t g) {
  return gates[g].name.empty() ? "gate " + std::to_string(g + 1) : gates[g].name;
}

// When the course itself passes each gate, s of the plan; the best it has where it does not.
std::vector<double> planned_at(const Trajectory& course, const std::vector<GateTask>& gates) {
  std::vector<PathPoint> path;
  for (const Sample& sample : course.samples) path.push_back({sample.time, sample.position});
  std::vector<double> times;
  GatePassage before;
  for (const GateTask& gate : gates) {
    const GatePassage passage =
        gate_passage(gate, path, before.after, kGateTolerance, before.share);
    if (std::isfinite(passage.outside)) before = passage;
    times.push_back(path.empty() ? 0 : path[before.after].time);
  }
  return times;
}

// When each gate was passed; NaN where it was not.
std::vector<double> passed_at(const RaceFlight& flight, const Trajectory& course,
                              const std::vector<GateTask>& gates) {
  const std::vector<double> planned = planned_at(course, gates);
  std::vector<PathPoint> path;
  for (const RaceSample& sample : flight.samples)
    path.push_back({sample.time, sample.state.position});
  std::vector<double> times;
  for (std::size_t g = 0; g < gates.size(); ++g) {
    // The part of the flight on which no other gate is due.
    const double after = g > 0 ? (planned[g - 1] + planned[g]) / 2 : -HUGE_VAL;
    const double before = g + 1 < gates.size() ? (planned[g] + planned[g + 1]) / 2 : HUGE_VAL;
    std::size_t first = 0, last = path.size();
    while (first < last && flight.samples[first].progress < after) ++first;
    while (last > first && flight.samples[last - 1].progress > before) --last;
    const std::span<const PathPoint> part(path.data() + first, last - first);
    const GatePassage passage = gate_passage(gates[g], part, 0, kGateTolerance);
    const bool passed = passage.outside <= kGateTolerance;
    times.push_back(passed ? part[passage.after].time : std::nan(""));
  }
  return times;
}

}  // namespace

RaceFlightLimits race_limits(const Trajectory& course, const std::vector<GateTask>& gates) {
  RaceFlightLimits limits;
  if (gates.empty() || gates.back().ball() || course.samples.empty()) return limits;
  const GateTask& gate = gates.back();
  const double beyond =
      (course.samples.back().position - gate.position).dot(gate.direction) - gate.tunnel_length / 2;
  if (std::abs(beyond) <= kGateTolerance) limits.finish_direction = gate.direction;
  return limits;
}

RaceScore score_of(const RaceFlight& flight, const Trajectory& course,
                   const std::vector<GateTask>& gates, double handicap, const RaceRules& rules) {
  RaceScore score;
  score.finished = flight.end == RaceEnd::finished;
  score.time = flight.time;
  score.straying = rules.deviation_price * flight.deviation_mean;
  score.handicap = handicap;
  const std::vector<double> passed = passed_at(flight, course, gates);
  for (std::size_t g = 0; g < gates.size(); ++g)
    if (std::isnan(passed[g])) score.missed.push_back(name_of(gates, g));
  score.gates = rules.gate_price * static_cast<double>(score.missed.size());
  return score;
}

std::vector<double> score_over_time(const RaceFlight& flight, const Trajectory& course,
                                    const std::vector<GateTask>& gates, double handicap,
                                    const RaceRules& rules, bool under_way) {
  const std::vector<double> passed = passed_at(flight, course, gates);
  // A missed gate is paid for when the next one is passed.
  std::vector<double> paid(gates.size(), flight.time);
  double next = under_way ? HUGE_VAL : flight.time;
  for (std::size_t g = gates.size(); g-- > 0;) {
    paid[g] = next;
    if (!std::isnan(passed[g])) next = passed[g];
  }
  std::vector<double> scores;
  double sum = 0, last = 0;
  for (const RaceSample& sample : flight.samples) {
    sum += (sample.time - last) * sample.deviation;
    last = sample.time;
    double score = sample.time + handicap;
    if (sample.time > 0) score += rules.deviation_price * sum / sample.time;
    for (std::size_t g = 0; g < gates.size(); ++g)
      if (std::isnan(passed[g]) && paid[g] <= sample.time) score += rules.gate_price;
    scores.push_back(score);
  }
  return scores;
}

}  // namespace lapwing
