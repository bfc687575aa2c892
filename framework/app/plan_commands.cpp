// SPDX-License-Identifier: Apache-2.0
// lapwing verify and config.
#include <unistd.h>

#include <cstdio>
#include <iostream>

#include "framework/app/check_lines.h"
#include "framework/app/command_line.h"
#include "framework/app/fleet_verify.h"
#include "framework/app/interruption.h"
#include "framework/app/mission_loading.h"
#include "framework/app/progress_line.h"
#include "framework/app/provenance.h"
#include "framework/app/terminal.h"
#include "framework/config/annotated.h"
#include "framework/core/visible_text.h"

namespace lapwing {

namespace {

// All but the failures. What could not be checked because the document failed is counted.
void print_others(const Certificate& certificate) {
  const Check* document = certificate.find("document");
  const bool readable = document && document->pass;
  int not_made = 0;
  for (const Check& check : certificate.checks) {
    const bool failed = check.required && check.skipped.empty() && !check.pass;
    const bool follows = !readable && !check.skipped.empty();
    not_made += follows;
    if (!failed && !follows) print_check(check);
  }
  if (not_made > 0)
    std::printf("  the other %d checks were not made: they need a consistent document\n", not_made);
}

// A plan carries the verdict of its run; a plan changed since may no longer deserve it.
void warn_of_changes(const JudgedPlan& judged, const Judges& judges) {
  const Value* stored = judged.plan.certificate.find("feasible");
  const bool own = judges.vehicle.empty() && judges.environment.empty();
  const bool now = judged.certificate.feasible();
  std::string sections;
  for (const Value& section : judged.provenance.at("document").at("changed").as_list())
    sections += (sections.empty() ? "" : ", ") + section.as_text();
  if (!sections.empty())
    std::fprintf(stderr, "lapwing: the plan was changed after planning: %s\n",
                 visible_line(sections).c_str());
  else if (own && stored && stored->type() == Value::Type::boolean && stored->as_boolean() != now)
    std::fprintf(stderr,
                 "lapwing: the plan states that it is %scertified; its numbers show that "
                 "it is %scertified\n",
                 stored->as_boolean() ? "" : "not ", now ? "" : "not ");
  for (const std::string& change : judged.changes)
    std::fprintf(stderr, "lapwing: %s\n", visible_line(change).c_str());
}

}  // namespace

ExitStatus verify_plan(const std::filesystem::path& file, const Judges& given,
                       const Invocation& invocation) {
  const Interruption interruption;
  ProgressLine progress("verify", std::cerr, progress_style_of_stderr(invocation.quiet),
                        columns_of_stderr(), &steady_seconds);
  Judges judges = given;
  judges.cancellation = &interruption.token();
  judges.progress = &progress;
  judges.controllers = controllers_of(invocation);
  if (const auto fleet = fleet_file(file)) {
    const JudgedFleet judged = judge_fleet(*fleet, judges);
    progress.clear();
    return print_fleet(*fleet, judged, invocation);
  }
  const JudgedPlan judged = judge_file(file, judges);
  progress.clear();
  const Certificate& certificate = judged.certificate;
  warn_of_changes(judged, judges);
  if (invocation.json) {
    Value object = Value::map();
    object.set("plan", file.string());
    object.set("mission", judged.plan.mission);
    object.set("provenance", judged.provenance);
    object.set("certificate", certificate.to_value());
    print_json(object);
  } else {
    const bool feasible = certificate.feasible();
    std::printf("%s: %s\n", visible_line(judged.plan.mission).c_str(),
                tinted(feasible ? Tone::good : Tone::bad, feasible ? "certified" : "not certified")
                    .c_str());
    print_failures(certificate);
    std::printf("%s", visible_text(judged.lines).c_str());
    print_others(certificate);
  }
  return certificate.feasible() ? ExitStatus::done : ExitStatus::not_certified;
}

ExitStatus show_configuration(const std::filesystem::path& script, const Invocation& invocation) {
  const Interruption interruption;
  const Registry registry = invocation.registry();
  const auto mission = load_mission(script, invocation, registry, &interruption.token());
  if (invocation.json) {
    mission->judge();
    print_json(mission->configuration());
    return ExitStatus::done;
  }
  // Who reads wants the ends of a track; a file is a configuration, and has all of it.
  const LongLists lists = ::isatty(STDOUT_FILENO) ? LongLists::shortened : LongLists::whole;
  // Whoever still has to name an input wants to see what there is to set.
  std::cout << "# " << visible_line(mission->kind()) << ": " << visible_line(mission->name())
            << "\n"
            << visible_text(annotated_yaml(mission->configuration(), lists)) << std::flush;
  mission->judge();
  return ExitStatus::done;
}

}  // namespace lapwing
