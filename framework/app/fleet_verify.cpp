// SPDX-License-Identifier: Apache-2.0
#include "framework/app/fleet_verify.h"

#include <cstdio>

#include "framework/app/check_lines.h"
#include "framework/app/configured_fleet.h"
#include "framework/app/fleet_words.h"
#include "framework/app/terminal.h"
#include "framework/core/checksum.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/log.h"
#include "framework/core/visible_text.h"
#include "framework/export/fleet_report.h"
#include "framework/export/run_folder.h"
#include "framework/verify/fleet.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

std::vector<const Plan*> plans_of(const JudgedFleet& judged) {
  std::vector<const Plan*> plans;
  for (const JudgedPlan& one : judged.plans) plans.push_back(&one.plan);
  return plans;
}

Value json_of(const fs::path& file, const JudgedFleet& judged) {
  Value object = Value::map();
  object.set("fleet", file.string());
  object.set("mission", judged.fleet.mission);
  object.set("certificate", judged.certificate.to_value());
  object.set("not_compared",
             Value(Value::List(judged.not_compared.begin(), judged.not_compared.end())));
  Value& tours = object.set("tours", Value::list());
  for (std::size_t t = 0; t < judged.plans.size(); ++t) {
    const FleetTour& tour = judged.fleet.tours[t];
    Value row = Value::map();
    row.set("drone", tour.drone);
    row.set("battery", std::int64_t{tour.battery});
    row.set("start", tour.start);
    row.set("plan", (file.parent_path() / tour.file).string());
    row.set("provenance", judged.plans[t].provenance);
    row.set("certificate", judged.plans[t].certificate.to_value());
    tours.push_back(std::move(row));
  }
  return object;
}

}  // namespace

std::optional<fs::path> fleet_file(const fs::path& file) {
  std::error_code code;
  if (fs::is_directory(file, code)) {
    const fs::path within = file / "fleet.json";
    return fs::exists(within, code) ? std::optional(within) : std::nullopt;
  }
  if (!fs::is_regular_file(file, code)) return std::nullopt;
  const std::string text = read_file(file);
  if (text.find("\"fleet_format\"") == text.npos) return std::nullopt;
  return is_fleet(from_json(text, file.string())) ? std::optional(file) : std::nullopt;
}

JudgedFleet judge_fleet(const fs::path& file, const Judges& judges) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (const std::string left = complete_run_folder(folder); !left.empty()) logging::warning(left);
  const Value document = from_json(read_file(file), file.string());
  const DigestFindings digest = check_digest(document);
  JudgedFleet judged;
  judged.fleet = fleet_from_value(document);
  std::vector<std::string> checksums;
  for (const FleetTour& tour : judged.fleet.tours) {
    checksums.push_back(sha256(read_file(folder / tour.file)));
    judged.plans.push_back(judge_file(folder / tour.file, judges));
  }
  std::vector<FleetMember> members;
  VerifyRequest request{.folder = folder, .cancellation = judges.cancellation};
  for (std::size_t t = 0; t < judged.plans.size(); ++t) {
    members.push_back({&judged.plans[t].plan, &judged.plans[t].certificate, checksums[t]});
    request.elsewhere = judged.plans.front().elsewhere;
  }
  ConfigurationComparison compared = compare_fleet(judged.fleet, plans_of(judged));
  judged.certificate = verify_fleet(judged.fleet, members, &digest, request, compared.faults);
  judged.not_compared = std::move(compared.not_compared);
  return judged;
}

ExitStatus print_fleet(const fs::path& file, const JudgedFleet& judged,
                       const Invocation& invocation) {
  const bool feasible = judged.certificate.feasible();
  if (invocation.json) {
    print_json(json_of(file, judged));
    return feasible ? ExitStatus::done : ExitStatus::not_certified;
  }
  std::printf(
      "%s: %s\n", visible_line(judged.fleet.mission).c_str(),
      tinted(feasible ? Tone::good : Tone::bad, feasible ? "certified" : "not certified").c_str());
  print_failures(judged.certificate);
  const double end = end_of_fleet(judged.fleet, plans_of(judged));
  std::printf("  %s\n", fleet_in_words(judged.fleet, end).c_str());
  for (std::size_t t = 0; t < judged.plans.size(); ++t)
    std::printf("  %s\n", visible_line(tour_in_words(judged.fleet.tours[t], judged.plans[t].plan,
                                                     judged.plans[t].certificate.feasible()))
                              .c_str());
  for (const std::string& left : judged.not_compared)
    std::printf("  not compared  %s\n", visible_line(left).c_str());
  for (const Check& check : judged.certificate.checks)
    if (!check.skipped.empty() || check.pass) print_check(check);
  return feasible ? ExitStatus::done : ExitStatus::not_certified;
}

}  // namespace lapwing
