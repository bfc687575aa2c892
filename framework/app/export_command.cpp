// SPDX-License-Identifier: Apache-2.0
// lapwing export.
#include <cstdio>
#include <iostream>

#include "framework/app/command_line.h"
#include "framework/app/mission_loading.h"
#include "framework/app/origin_option.h"
#include "framework/app/output_target.h"
#include "framework/app/provenance.h"
#include "framework/core/files.h"
#include "framework/core/named_parameters.h"
#include "framework/core/visible_text.h"
#include "framework/export/exporter.h"
#include "framework/export/flight_judgement.h"
#include "framework/mission/environment_source.h"

namespace lapwing {

namespace {

// Whether the plan may be exported; says why not.
bool may_leave(const JudgedPlan& judged, const ExportRequest& asked) {
  if (judged.certificate.feasible()) return true;
  std::string failures;
  for (const Check& check : judged.certificate.failures())
    failures += "\n  " + visible_line(to_line(check));
  std::fprintf(stderr, "lapwing: '%s' is not certified%s%s\n",
               visible_line(asked.plan.string()).c_str(),
               asked.uncertified ? ", and exported on request:" : ":", failures.c_str());
  if (!asked.uncertified) std::fprintf(stderr, "  nothing was written; --uncertified exports it\n");
  return asked.uncertified;
}

// What is said of a file once it is written.
std::string write_file(const Exporter& exporter, const Plan& plan, const ExportRequest& asked) {
  const std::string content = in_plugin(exporter, "write", [&] { return exporter.write(plan); });
  std::vector<std::string> losses =
      in_plugin(exporter, "losses", [&] { return exporter.losses(plan, content); });
  for (std::string& sentence : judge_written_flight(
           exporter, plan, content, asked.plan.parent_path(), "--format " + asked.format))
    losses.push_back(std::move(sentence));
  write_file_atomically(asked.target, content);
  for (const std::string& loss : losses) std::printf("%s\n", visible_line(loss).c_str());
  return "wrote " + asked.target.string();
}

std::string write_files(const Exporter& exporter, const Plan& plan, const ExportRequest& asked) {
  const NamedContents files =
      in_plugin(exporter, "write_folder", [&] { return exporter.write_folder(plan); });
  write_folder_atomically(asked.target, files);
  std::string written = "wrote " + asked.target.string();
  for (std::size_t i = 0; i < files.size(); ++i) written += (i == 0 ? ": " : ", ") + files[i].first;
  return written;
}

}  // namespace

ExitStatus export_plan(const ExportRequest& asked, const Invocation& invocation) {
  require_output(asked.target, {asked.plan});
  const Registry registry = invocation.registry();
  const std::optional<NamedParameters> chosen = named_parameters_from(asked.format);
  if (!chosen)
    throw InputError("--format: expected NAME or NAME:KEY=VALUE,..., each key once, got '" +
                     asked.format + "'");
  const auto exporter = registry.create<Exporter>(chosen->name, chosen->parameters, "--format");
  const JudgedPlan judged = judge_file(asked.plan, {.controllers = controllers_of(invocation)});
  Plan plan = judged.plan;
  give_origin(plan, asked.origin);
  if (!may_leave(judged, asked)) return ExitStatus::not_certified;
  if (in_plugin(*exporter, "shows_surroundings", [&] { return exporter->shows_surroundings(); }))
    open_recorded_shapes(plan.environment, registry, asked.plan.parent_path());
  plan.certificate = judged.certificate.to_value();  // files may say whether it passed
  const bool folder =
      in_plugin(*exporter, "file_extension", [&] { return exporter->file_extension().empty(); });
  std::string written =
      folder ? write_files(*exporter, plan, asked) : write_file(*exporter, plan, asked);
  if (plan.task.scan)
    written += "; the plan has " + std::to_string(plan.task.scan->views.size()) + " images";
  std::printf("%s\n", visible_line(written).c_str());
  for (const std::string& remark :
       in_plugin(*exporter, "remarks", [&] { return exporter->remarks(plan); }))
    std::cerr << "lapwing: warning: " << visible_line(remark) << "\n";
  return ExitStatus::done;
}

}  // namespace lapwing
