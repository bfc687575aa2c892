// lapwing verify, export and config.
#include <cstdio>
#include <iostream>

#include "framework/app/command_line.h"
#include "framework/app/mission_loading.h"
#include "framework/config/annotated.h"
#include "framework/core/files.h"
#include "framework/export/exporter.h"
#include "framework/verify/verify.h"

namespace lapwing {

namespace {

void print_check(const Check& check) {
  const char* verdict = !check.skipped.empty() ? "skipped" : check.pass ? "pass" : "FAIL";
  std::string words;
  if (!check.skipped.empty()) {
    words = check.skipped;
  } else {
    words = to_line(check);
  }
  std::printf("  %-7s  %-22s %s%s\n", verdict, check.name.c_str(), words.c_str(),
              check.required || !check.skipped.empty() ? "" : " (reported only)");
}

}  // namespace

// A plan carries the verdict of its run; a plan changed since may no longer deserve it.
void warn_of_another_verdict(const Plan& plan, const Certificate& now) {
  const Value* stored = plan.certificate.find("feasible");
  if (!stored || stored->type() != Value::Type::boolean) return;
  if (stored->as_boolean() != now.feasible())
    std::fprintf(stderr,
                 "lapwing: the plan says of itself that it is %scertified; its numbers say that "
                 "it is %scertified: it was changed after it was planned\n",
                 stored->as_boolean() ? "" : "not ", now.feasible() ? "" : "not ");
}

ExitStatus verify_plan(const std::filesystem::path& file, const Invocation& invocation) {
  const Plan plan = read_plan(file);
  const Certificate certificate = verify(plan, file.parent_path());
  warn_of_another_verdict(plan, certificate);
  if (invocation.json) {
    Value object = Value::map();
    object.set("plan", file.string());
    object.set("mission", plan.mission);
    object.set("certificate", certificate.to_value());
    print_json(object);
  } else {
    std::printf("%s: %s\n", plan.mission.c_str(),
                certificate.feasible() ? "certified" : "not certified");
    for (const Check& check : certificate.checks) print_check(check);
  }
  return certificate.feasible() ? ExitStatus::done : ExitStatus::not_certified;
}

ExitStatus export_plan(const std::filesystem::path& file, const std::string& format,
                       const std::filesystem::path& target, const Invocation& invocation) {
  const Registry registry = invocation.registry();
  const Plan plan = read_plan(file);
  const auto exporter = registry.create<Exporter>(format);
  const bool folder =
      in_plugin(*exporter, "file_extension", [&] { return exporter->file_extension().empty(); });
  if (folder) {
    write_folder_atomically(
        target, in_plugin(*exporter, "write_folder", [&] { return exporter->write_folder(plan); }));
  } else {
    write_file_atomically(target,
                          in_plugin(*exporter, "write", [&] { return exporter->write(plan); }));
  }
  for (const std::string& remark :
       in_plugin(*exporter, "remarks", [&] { return exporter->remarks(plan); }))
    std::cerr << "lapwing: warning: " << remark << "\n";
  return ExitStatus::done;
}

ExitStatus show_configuration(const std::filesystem::path& script, const Invocation& invocation) {
  const Registry registry = invocation.registry();
  const auto mission = load_mission(script, invocation, registry);
  if (invocation.json) {
    print_json(mission->configuration());
  } else {
    std::cout << "# " << mission->kind() << ": " << mission->name() << "\n"
              << annotated_yaml(mission->configuration());
  }
  return ExitStatus::done;
}

}  // namespace lapwing
