// SPDX-License-Identifier: Apache-2.0
// A review as a page.
#include <algorithm>
#include <cmath>

#include "framework/core/units.h"
#include "framework/export/flight_charts.h"
#include "framework/flight_log/log_time.h"
#include "framework/flight_review/flight_review.h"
#include "framework/trajectory/interpolate.h"

namespace lapwing {
namespace {

// What is measured of a flight is not known below a tenth of a millimetre or of a millisecond.
double to_least(double value) {
  constexpr double kLeast = 1e-4;
  return std::round(value / kLeast) * kLeast + 0.0;
}

bool is_angle(const std::string& unit) {
  return unit.starts_with("rad");
}

double shown(double value, const std::string& unit) {
  return to_least(is_angle(unit) ? degrees(value) : value);
}

std::string shown_unit(const std::string& unit) {
  return unit == "rad" ? "\u00b0" : unit == "rad/s" ? "\u00b0/s" : unit;
}

Drawing drawing_of(const Plan& plan, const FlightReview& review,
                   const std::filesystem::path& folder) {
  Drawing drawing;
  drawing.along = {"time", "s"};
  drawing.value = {"distance from the plan", "m"};
  Polyline planned{"planned", {}, {}, {}}, flown{"flown", {}, {}, {}};
  for (const Sample& s : plan.trajectory.samples) {
    planned.points.push_back(s.position);
    planned.along.push_back(s.time);
  }
  const double last = plan.trajectory.samples.back().time;
  for (const Sample& s : review.flown.trajectory.samples) {
    const double time = s.time + review.flown.start;
    flown.points.push_back(s.position);
    flown.along.push_back(time);
    const Sample wanted =
        sample_at(plan.trajectory, std::clamp(time, plan.trajectory.samples.front().time, last));
    flown.values.push_back((s.position - wanted.position).norm());
  }
  drawing.lines = {planned, flown};
  add_task(plan, folder, drawing);
  return drawing;
}

Facts facts_of(const FlightReview& review) {
  const FlightAlignment& a = review.alignment;
  Facts facts;
  facts.facts = {{"log",
                  review.log.format +
                      (review.log.recorder.empty() ? std::string() : ", " + review.log.recorder),
                  ""},
                 {"time 0 of the plan", moment_in_words(review.log, a.clock, 3), ""},
                 {"uncertainty of it", number_text(to_least(a.clock_sigma), 2), "s"},
                 {"correction east", number_text(to_least(a.offset.x()), 3), "m"},
                 {"correction north", number_text(to_least(a.offset.y()), 3), "m"},
                 {"correction up", number_text(to_least(a.offset.z()), 3), "m"},
                 {"compared from", number_text(review.flown.start, 5), "s"},
                 {"compared to", number_text(review.flown.finish, 5), "s"}};
  const double missing = review.missing_before + review.missing_after;
  facts.facts.push_back({"of the plan not in the log", number_text(missing, 4), "s",
                         missing > 0.05 ? Mark::fail : Mark::pass});
  return facts;
}

Table errors_table(const FlightReview& review) {
  Table table{"Errors",
              {{"error", ""},
               {"", ""},
               {"unit", ""},
               {"median", ""},
               {"95 %", ""},
               {"worst", ""},
               {"at", "s"},
               {"mean", ""}},
              {}};
  for (const ErrorSeries& series : review.errors) {
    const std::size_t worst = series.worst();
    table.rows.push_back(
        {{series.name, series.summary, shown_unit(series.unit), shown(series.median(), series.unit),
          shown(series.quantile(0.95), series.unit), shown(series.values[worst], series.unit),
          series.times[worst], series.is_signed ? shown(series.mean(), series.unit) : NAN}});
  }
  return table;
}

Table checks_table(const FlightReview& review) {
  Table table{"Limits and task, as flown",
              {{"check", ""},
               {"unit", ""},
               {"planned", ""},
               {"flown", ""},
               {"limit", ""},
               {"at", "s"},
               {"", ""}},
              {}};
  for (const FlownCheck& check : review.certificate.checks) {
    const Check& c = check.flown;
    const Mark mark = c.pass ? Mark::pass : c.required ? Mark::fail : Mark::none;
    table.rows.push_back(
        {{c.name, shown_unit(c.unit), check.planned ? shown(*check.planned, c.unit) : NAN,
          c.worst ? shown(*c.worst, c.unit) : NAN, shown(c.limit, c.unit), c.at, c.detail},
         mark});
  }
  return table;
}

Table views_table(const FlightReview& review) {
  Table table{
      "Views", {{"view", ""}, {"image at", "s"}, {"distance", "m"}, {"angle", "\u00b0"}}, {}};
  for (const FlownView& view : review.certificate.views)
    table.rows.push_back(
        {{static_cast<double>(view.number), view.time, view.distance, degrees(view.angle)},
         view.taken ? Mark::pass : Mark::fail});
  return table;
}

// Charts of at most this many points: a page, not a log.
constexpr std::size_t kMostPoints = 20000;

Series series_of(const ErrorSeries& errors) {
  Series series{errors.name, {}, {}, false};
  const std::size_t step = errors.times.size() / kMostPoints + 1;
  for (std::size_t i = 0; i < errors.times.size(); i += step) {
    series.x.push_back(errors.times[i]);
    series.y.push_back(shown(errors.values[i], errors.unit));
  }
  return series;
}

void add_chart(const FlightReview& review, const char* title, const char* quantity,
               std::initializer_list<const char*> names, Section& section) {
  Chart chart;
  chart.title = title;
  chart.x = {"time", "s"};
  for (const char* name : names)
    if (const ErrorSeries* errors = find_error(review.errors, name)) {
      chart.y = {quantity, shown_unit(errors->unit)};
      chart.series.push_back(series_of(*errors));
    }
  if (chart.series.empty()) return;
  for (const FlownCheck& check : review.certificate.broken())
    chart.markers.push_back({check.flown.name, check.flown.at});
  section.blocks.emplace_back(std::move(chart));
}

Section motion_section_of(const Plan& plan, const FlightReview& review) {
  Section section{"Motion", {}};
  const auto chart = [&](const char* title, const char* unit, auto value) {
    Chart made;
    made.title = title;
    made.x = {"time", "s"};
    made.y = {title, unit};
    Series planned{"planned", {}, {}, false}, flown{"flown", {}, {}, false};
    for (const Sample& s : plan.trajectory.samples)
      planned.x.push_back(s.time), planned.y.push_back(value(s));
    for (const Sample& s : review.flown.trajectory.samples)
      flown.x.push_back(s.time + review.flown.start), flown.y.push_back(value(s));
    made.series = {planned, flown};
    section.blocks.emplace_back(std::move(made));
  };
  chart("height", "m", [](const Sample& s) { return s.position.z(); });
  if (!plan.trajectory.motion.moves) return section;
  chart("horizontal speed", "m/s", [](const Sample& s) { return s.velocity.head<2>().norm(); });
  chart("horizontal acceleration", "m/s^2",
        [](const Sample& s) { return s.acceleration.head<2>().norm(); });
  return section;
}

std::string paragraphs(const std::vector<std::string>& sentences) {
  std::string text;
  for (const std::string& sentence : sentences) text += (text.empty() ? "" : "\n\n") + sentence;
  return text;
}

}  // namespace

Report review_report(const Plan& plan, const FlightReview& review,
                     const std::filesystem::path& folder) {
  Report report;
  report.title = plan.mission;
  report.subtitle = "the flight against its plan";
  report.status = verdict_of(review);
  report.status_mark = review.kept() ? Mark::pass : Mark::fail;
  report.sections.push_back(
      {"Log and plan brought together",
       {facts_of(review), TextBlock{paragraphs(alignment_sentences(review)), false, ""}}});
  const Drawing drawing = drawing_of(plan, review, folder);
  report.sections.push_back({"Path",
                             {PathView{"Path from above", Projection::above, drawing},
                              PathView{"Path from the south", Projection::from_south, drawing},
                              Scene3D{"Path in space", drawing}}});
  Section errors{"Errors", {errors_table(review)}};
  add_chart(review, "Distance", "distance", {"distance", "path"}, errors);
  add_chart(review, "Along, across, height", "error", {"along", "across", "height"}, errors);
  add_chart(review, "Behind the plan", "time", {"late"}, errors);
  add_chart(review, "Angles", "error", {"yaw", "camera"}, errors);
  report.sections.push_back(std::move(errors));
  if (!review.certificate.checks.empty())
    report.sections.push_back({"Limits", {checks_table(review)}});
  if (!review.certificate.views.empty())
    report.sections.push_back({"Views", {views_table(review)}});
  report.sections.push_back(motion_section_of(plan, review));
  const std::vector<std::string> advice = advice_of(plan, review);
  if (!advice.empty()) {
    const TextBlock text{paragraphs(advice), false, ""};
    report.sections.push_back({"What would have to change", {text}});
  }
  return report;
}

}  // namespace lapwing
