#include "framework/vehicle/race_score.h"

#include <cmath>

#include "framework/trajectory/gate_passage.h"

namespace lapwing {
namespace {

constexpr double kGateTolerance = 1e-3;  // m, as the verifier's

std::string name_of(const std::vector<GateTask>& gates, std::size_t g) {
  return gates[g].name.empty() ? "gate " + std::to_string(g + 1) : gates[g].name;
}

// When each gate was passed; NaN where it was not.
std::vector<double> passed_at(const RaceFlight& flight, const std::vector<GateTask>& gates) {
  std::vector<PathPoint> path;
  for (const RaceSample& sample : flight.samples)
    path.push_back({sample.time, sample.state.position});
  std::vector<double> times;
  std::size_t from = 0;
  for (const GateTask& gate : gates) {
    const GatePassage passage = gate_passage(gate, path, from, kGateTolerance);
    const bool passed = passage.outside <= kGateTolerance;
    times.push_back(passed ? path[passage.after].time : std::nan(""));
    if (passed) from = passage.after;
  }
  return times;
}

}  // namespace

RaceScore score_of(const RaceFlight& flight, const std::vector<GateTask>& gates, double handicap,
                   const RaceRules& rules) {
  RaceScore score;
  score.finished = flight.end == RaceEnd::finished;
  score.time = flight.time;
  score.straying = rules.deviation_price * flight.deviation_mean;
  score.handicap = handicap;
  const std::vector<double> passed = passed_at(flight, gates);
  for (std::size_t g = 0; g < gates.size(); ++g)
    if (std::isnan(passed[g])) score.missed.push_back(name_of(gates, g));
  score.gates = rules.gate_price * static_cast<double>(score.missed.size());
  return score;
}

std::vector<double> score_over_time(const RaceFlight& flight, const std::vector<GateTask>& gates,
                                    double handicap, const RaceRules& rules) {
  const std::vector<double> passed = passed_at(flight, gates);
  // A missed gate is paid for when the next one is passed.
  std::vector<double> paid(gates.size(), flight.time);
  double next = flight.time;
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
