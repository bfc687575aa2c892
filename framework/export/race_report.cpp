// SPDX-License-Identifier: Apache-2.0
#include "framework/export/race_report.h"

#include "framework/core/units.h"

namespace lapwing {
namespace {

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

Table results(const std::vector<RacedPilot>& pilots, int winner) {
  Table table;
  table.title = "Result";
  table.columns = {{"pilot", ""},      {"flight", ""},    {"time", "s"},
                   {"deviation", "m"}, {"straying", "s"}, {"missed gates", ""},
                   {"for gates", "s"}, {"handicap", "s"}, {"score", "s"}};
  for (std::size_t k = 0; k < pilots.size(); ++k) {
    const RacedPilot& p = pilots[k];
    table.rows.push_back(
        {{p.pilot.name, std::string(to_string(p.flight.end)), p.score.time, p.flight.deviation_mean,
          p.score.straying, listed(p.score.missed), p.score.gates, p.score.handicap,
          p.score.finished ? TableCell(p.score.total()) : TableCell("out")},
         static_cast<int>(k) == winner ? Mark::pass
         : p.score.finished            ? Mark::none
                                       : Mark::fail});
  }
  return table;
}

Chart chart(std::string title, std::string quantity, std::string unit) {
  Chart chart;
  chart.title = std::move(title);
  chart.x = {"time", "s"};
  chart.y = {std::move(quantity), std::move(unit)};
  return chart;
}

Series series(const RacedPilot& pilot, auto value_of) {
  Series series{pilot.pilot.name, {}, {}, false};
  for (const RaceSample& sample : pilot.flight.samples) {
    series.x.push_back(sample.time);
    series.y.push_back(value_of(sample));
  }
  return series;
}

Drawing drawing_of(const Plan& plan, const RacedPilot& pilot) {
  Drawing drawing;
  drawing.along = {"time", "s"};
  drawing.value = {"speed", "m/s"};
  Polyline course{"planned", {}, {}, {}}, flown{pilot.pilot.name, {}, {}, {}};
  for (const Sample& sample : plan.trajectory.samples) course.points.push_back(sample.position);
  for (const RaceSample& sample : pilot.flight.samples) {
    flown.points.push_back(sample.state.position);
    flown.along.push_back(sample.time);
    flown.values.push_back(sample.state.velocity.norm());
  }
  drawing.lines = {course, flown};
  for (const GateTask& gate : plan.task.gates) {
    if (gate.ball()) {
      drawing.spheres.push_back({gate.name, gate.position, gate.radius});
      continue;
    }
    Polyline frame{gate.name, {}, {}, {}};
    for (std::size_t k = 0; k <= gate.corners.size(); ++k) {
      const Eigen::Vector2d& corner = gate.corners[k % gate.corners.size()];
      frame.points.push_back(gate.position + corner.x() * gate.left() + corner.y() * gate.up);
    }
    drawing.lines.push_back(std::move(frame));
  }
  return drawing;
}

}  // namespace

int winner_of(const std::vector<RacedPilot>& pilots) {
  int winner = -1;
  for (std::size_t k = 0; k < pilots.size(); ++k)
    if (pilots[k].score.finished &&
        (winner < 0 ||
         pilots[k].score.total() < pilots[static_cast<std::size_t>(winner)].score.total()))
      winner = static_cast<int>(k);
  return winner;
}

Value to_value(const std::vector<RacedPilot>& pilots) {
  Value value = Value::map();
  const int winner = winner_of(pilots);
  if (winner >= 0) value.set("winner", pilots[static_cast<std::size_t>(winner)].pilot.name);
  Value& list = value.set("pilots", Value::list());
  for (const RacedPilot& p : pilots) {
    Value entry = Value::map();
    entry.set("name", p.pilot.name);
    entry.set("end", std::string(to_string(p.flight.end)));
    entry.set("time", p.score.time);
    entry.set("deviation_mean", p.flight.deviation_mean);
    entry.set("deviation_worst", p.flight.deviation_worst);
    entry.set("saturated_share", p.flight.saturated_share);
    Value missed = Value::list();
    for (const std::string& name : p.score.missed) missed.push_back(name);
    entry.set("missed_gates", std::move(missed));
    entry.set("handicap", p.score.handicap);
    if (p.score.finished) entry.set("score", p.score.total());
    list.push_back(std::move(entry));
  }
  return value;
}

std::string race_result(const std::vector<RacedPilot>& pilots) {
  if (pilots.empty()) return "";
  std::string text;
  for (const RacedPilot& p : pilots) {
    text += "  " + p.pilot.name + " " + to_string(p.flight.end) + " after " +
            number_text(p.score.time) + " s, " + number_text(p.flight.deviation_mean, 3) +
            " m from the course on average";
    if (!p.score.missed.empty()) text += ", missed " + listed(p.score.missed);
    text += p.score.finished ? ": score " + number_text(p.score.total()) + " s\n" : ": out\n";
    if (p.flight.time > p.pilot.log.end() + StickLog::kLongestGap)
      text += "  (the log of " + p.pilot.name + " ends at " + number_text(p.pilot.log.end()) +
              " s; the stick is centred from there)\n";
  }
  const int winner = winner_of(pilots);
  return text + "  " +
         (winner < 0 ? "nobody finished"
                     : pilots[static_cast<std::size_t>(winner)].pilot.name + " wins") +
         "\n";
}

std::vector<Section> race_sections(const Plan& plan, const std::vector<RacedPilot>& pilots,
                                   const RaceRules& rules) {
  std::vector<Section> sections;
  TextBlock how;
  how.text = "The score is the time of all laps, " + number_text(rules.deviation_price) +
             " s for every metre of mean distance from the course, " +
             number_text(rules.gate_price) +
             " s for every missed gate, and the handicap. The lower score wins.";
  sections.push_back({"Race", {results(pilots, winner_of(pilots)), how}});
  Section paths{"Paths, coloured by speed", {}};
  for (const RacedPilot& pilot : pilots)
    paths.blocks.push_back(
        PathView{pilot.pilot.name + ", from above", Projection::above, drawing_of(plan, pilot)});
  sections.push_back(std::move(paths));

  Chart score = chart("Score over time", "score", "s");
  Chart deviation = chart("Distance from the course", "distance", "m");
  Chart speed = chart("Speed", "speed", "m/s");
  Chart forward = chart("Stick forward", "deflection", ""),
        left = chart("Stick left", "deflection", "");
  for (const RacedPilot& pilot : pilots) {
    const std::vector<double> scores = score_over_time(
        pilot.flight, plan.trajectory, plan.task.gates, pilot.score.handicap, rules);
    std::size_t at = 0;
    score.series.push_back(series(pilot, [&](const RaceSample&) { return scores[at++]; }));
    deviation.series.push_back(series(pilot, [](const RaceSample& s) { return s.deviation; }));
    speed.series.push_back(
        series(pilot, [](const RaceSample& s) { return s.state.velocity.norm(); }));
    forward.series.push_back(series(pilot, [](const RaceSample& s) { return s.stick.x(); }));
    left.series.push_back(series(pilot, [](const RaceSample& s) { return s.stick.y(); }));
  }
  sections.push_back({"Over time", {score, deviation, speed}});
  sections.push_back({"Sticks", {forward, left}});
  return sections;
}

Report race_report(const Plan& plan, const std::vector<RacedPilot>& pilots,
                   const RaceRules& rules) {
  Report report;
  report.title = plan.mission;
  report.subtitle = "a simulated race, flown by hand";
  const int winner = winner_of(pilots);
  report.status = winner < 0 ? "nobody finished"
                             : pilots[static_cast<std::size_t>(winner)].pilot.name + " wins";
  report.status_mark = winner < 0 ? Mark::fail : Mark::pass;
  report.sections = race_sections(plan, pilots, rules);
  return report;
}

}  // namespace lapwing
