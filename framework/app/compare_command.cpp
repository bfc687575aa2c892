// SPDX-License-Identifier: Apache-2.0
// lapwing compare and lapwing log.
#include <cmath>
#include <cstdio>
#include <iostream>

#include "framework/app/flight_log_commands.h"
#include "framework/app/log_reading.h"
#include "framework/app/origin_option.h"
#include "framework/app/output_target.h"
#include "framework/app/provenance.h"
#include "framework/app/terminal.h"
#include "framework/core/files.h"
#include "framework/core/units.h"
#include "framework/core/visible_text.h"
#include "framework/flight_log/log_time.h"
#include "framework/flight_review/flight_review.h"
#include "framework/mission/environment_source.h"

namespace lapwing {
namespace {

void print_errors(const FlightReview& review) {
  std::printf("  %-10s %10s %10s %10s  %8s\n", "error", "median", "95 %", "worst", "at");
  for (const ErrorSeries& series : review.errors) {
    const bool angle = series.unit == "rad";
    const auto shown = [&](double v) { return angle ? degrees(v) : v; };
    const std::size_t worst = series.worst();
    std::printf("  %-10s %10.3f %10.3f %10.3f  %6.2f s  %s, %s\n", series.name.c_str(),
                shown(series.median()), shown(series.quantile(0.95)), shown(series.values[worst]),
                series.times[worst], angle ? "degrees" : series.unit.c_str(),
                series.summary.c_str());
  }
}

void print_checks(const FlightReview& review) {
  const std::vector<FlownCheck> broken = review.certificate.broken();
  if (broken.empty() && !review.certificate.checks.empty())
    std::printf("  every limit that could be judged was kept (%zu)\n",
                review.certificate.checks.size());
  for (const FlownCheck& check : broken)
    std::printf("  %s %s%s\n", tinted(Tone::bad, "broken:").c_str(),
                visible_line(to_line(check.flown)).c_str(),
                check.planned_pass ? "" : " (so does the plan)");
  for (const char* name : {"framing", "coverage", "drawing"})
    if (const FlownCheck* check = review.certificate.find(name))
      if (check->flown.pass)
        std::printf("  %-10s %s\n", name, visible_line(result_of(check->flown)).c_str());
  const auto& views = review.certificate.views;
  if (views.empty()) return;
  const auto taken =
      std::count_if(views.begin(), views.end(), [](const auto& v) { return v.taken; });
  std::printf(
      "  %td of %zu views were taken within the tolerances of the plan%s\n", taken, views.size(),
      review.certificate.views_by_time ? ", by the poses at their times: no image is logged" : "");
}

void print(const Plan& plan, const FlightReview& review) {
  std::printf("%s: %s\n", visible_line(plan.mission).c_str(),
              tinted(review.kept() ? Tone::good : Tone::bad, verdict_of(review)).c_str());
  for (const std::string& sentence : alignment_sentences(review))
    std::printf("  %s\n", visible_line(sentence).c_str());
  print_errors(review);
  print_checks(review);
  const std::vector<std::string> advice = advice_of(plan, review);
  if (!advice.empty()) std::printf("what would have to change\n");
  for (const std::string& one : advice) std::printf("  %s\n", visible_line(one).c_str());
}

ExitStatus say_another(const std::string& file, const std::string& what,
                       const Invocation& invocation) {
  std::cerr << tinted_error(Tone::bad, "lapwing:") << " '" << visible_line(file)
            << "': " << visible_line(what) << "\n";
  if (invocation.json) {
    Value object = Value::map();
    object.set("status", "another flight");
    object.set("error", what);
    print_json(object);
  }
  return ExitStatus::not_certified;
}

// Smallest, largest and sum of each number of a series, for comparisons with other readers.
Value figures_of(const std::string& name, const LogSeries& series) {
  const auto width = static_cast<std::size_t>(log_quantity(name).width);
  Value least = Value::list(), most = Value::list(), mean = Value::list();
  for (std::size_t k = 0; k < width; ++k) {
    double low = INFINITY, high = -INFINITY, sum = 0;
    for (std::size_t i = 0; i < series.size(); ++i) {
      const double value = series.values[width * i + k];
      low = std::min(low, value), high = std::max(high, value), sum += value;
    }
    least.push_back(low);
    most.push_back(high);
    mean.push_back(sum / static_cast<double>(series.size()));
  }
  Value value = Value::map();
  value.set("source", as_utf8(series.source));
  value.set("samples", static_cast<std::int64_t>(series.size()));
  value.set("first", series.times.front());
  value.set("last", series.times.back());
  value.set("least", std::move(least));
  value.set("most", std::move(most));
  value.set("mean", std::move(mean));
  return value;
}

Value log_value(const FlightLog& log) {
  Value value = Value::map();
  value.set("format", log.format);
  value.set("recorder", as_utf8(log.recorder));
  value.set("clock", log.clock);
  if (log.utc) value.set("utc", *log.utc);
  if (log.heights) value.set("heights", std::string(to_string(*log.heights)));
  value.set("bytes", static_cast<std::int64_t>(log.bytes));
  value.set("bytes_read", static_cast<std::int64_t>(log.bytes_read));
  value.set("damage", as_utf8(log.damage));
  Value& series = value.set("series", Value::map());
  for (const auto& [name, one] : log.series) series.set(name, figures_of(name, one));
  Value& records = value.set("records", Value::map());
  for (const LogRecords& one : log.records)
    records.set(as_utf8(one.name), static_cast<std::int64_t>(one.count));
  Value& photographs = value.set("photographs", Value::list());
  for (const double time : log.photographs) photographs.push_back(time);
  value.set("gaps", static_cast<std::int64_t>(log.gaps.size()));
  Value& messages = value.set("messages", Value::list());
  for (const LogMessage& message : log.messages) {
    Value& one = (messages.push_back(Value::map()), messages.as_list().back());
    one.set("time", message.time);
    one.set("text", as_utf8(message.text));
  }
  Value& remarks = value.set("remarks", Value::list());
  for (const std::string& remark : log.remarks) remarks.push_back(as_utf8(remark));
  return value;
}

// A time of the log, alone; of a clock that counts from 1970 as a date.
std::string short_moment(const FlightLog& log, double time) {
  if (log.utc && *log.utc == 0) return utc_text(time, 3);
  char text[64];
  std::snprintf(text, sizeof text, "%.3f s", time);
  return text;
}

void print(const FlightLog& log) {
  std::printf("%s%s%s, %.6g s\n", log.format.c_str(), log.recorder.empty() ? "" : ", ",
              visible_line(log.recorder).c_str(), log.finish() - log.start());
  if (log.utc) {
    const std::string begin = utc_text(*log.utc + log.start(), 0);
    if (!begin.empty()) std::printf("  from %s\n", begin.c_str());
  }
  if (!log.damage.empty())
    std::printf("  damaged: %s; %zu of %zu bytes were read\n", visible_line(log.damage).c_str(),
                log.bytes_read, log.bytes);
  for (const LogQuantity& quantity : log_quantities()) {
    const LogSeries* series = log.find(quantity.name);
    if (!series) continue;
    std::printf("  %-18s %8zu samples from %s to %s  %s%s%s\n", quantity.name, series->size(),
                short_moment(log, series->times.front()).c_str(),
                short_moment(log, series->times.back()).c_str(), quantity.summary,
                series->source.empty() ? "" : "; ", visible_line(series->source).c_str());
  }
  if (!log.photographs.empty()) std::printf("  %zu photographs\n", log.photographs.size());
  for (const std::string& remark : log.remarks) std::printf("  %s\n", visible_line(remark).c_str());
  for (const LogMessage& message : log.messages)
    std::printf("  %12s  %s\n", short_moment(log, message.time).c_str(),
                visible_line(message.text).c_str());
}

}  // namespace

ExitStatus compare_flight(const FlightLogRequest& asked, const Invocation& invocation) {
  if (!asked.target.empty()) require_output(asked.target, {asked.plan, asked.log});
  const Registry registry = invocation.registry();
  Plan plan = read_plan_file(asked.plan);
  give_origin(plan, asked.origin);
  FlightLog log = read_flight_log(asked.log, asked.format, registry);
  const std::filesystem::path folder = asked.plan.parent_path();
  FlightReview review;
  try {
    review = review_flight(
        plan, std::move(log),
        {.clock = asked.clock, .estimate_offset = !asked.no_offset, .estimate_turn = asked.turn},
        folder);
  } catch (const AnotherFlight& error) {
    return say_another(asked.log.string(), error.what(), invocation);
  } catch (const InputError& error) {
    throw InputError("'" + asked.log.string() + "': " + error.what());
  }
  if (!asked.target.empty()) {
    open_recorded_shapes(plan.environment, registry, folder);
    write_file_atomically(asked.target, render_html(review_report(plan, review, folder)));
  }
  if (invocation.json) {
    Value object = to_value(plan, review);
    object.set("plan", asked.plan.string());
    object.set("file", asked.log.string());
    print_json(object);
  } else {
    print(plan, review);
    if (!asked.target.empty()) std::printf("wrote %s\n", asked.target.string().c_str());
  }
  return review.kept() ? ExitStatus::done : ExitStatus::not_certified;
}

ExitStatus show_flight_log(const FlightLogRequest& asked, const Invocation& invocation) {
  const Registry registry = invocation.registry();
  const FlightLog log = read_flight_log(asked.log, asked.format, registry);
  if (invocation.json)
    print_json(log_value(log));
  else
    print(log);
  return ExitStatus::done;
}

}  // namespace lapwing
