// SPDX-License-Identifier: Apache-2.0
// Whose limits, obstacles and task a plan is judged by, said and compared.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "framework/core/progress.h"
#include "framework/trajectory/plan.h"
#include "framework/trajectory/plan_digest.h"
#include "framework/vehicle/controller.h"
#include "framework/verify/certificate.h"

namespace lapwing {

// Files of whoever judges; empty: what the plan states. And what tells how far the verdict is, or
// ends it; both may be null.
struct Judges {
  std::filesystem::path vehicle = {}, environment = {};
  const CancellationToken* cancellation = nullptr;
  Progress* progress = nullptr;
  ControllerSource controllers = {};
};

// A plan with its verdict, and what the verdict is about.
struct JudgedPlan {
  Plan plan;                         // with the judge's vehicle and obstacles, where there are any
  Certificate certificate;           // with the check `provenance`
  std::vector<std::string> changes;  // against the certificate that the plan holds
  Value provenance;                  // for --json
  std::string lines;                 // for people, indented, each with its line end
  // Where files of the judge's lie, see VerifyRequest.
  std::map<std::string, std::filesystem::path> elsewhere = {};
};

// `digest`: what the document's own digest says; null for a plan that has not been written yet.
// Meshes and maps are read from `folder`. InputError for files of the judge's that do not hold,
// Cancelled when told to stop.
JudgedPlan judge(Plan plan, const std::filesystem::path& folder, const DigestFindings* digest,
                 const Judges& judges = {});

// Reads and judges a plan document.
JudgedPlan judge_file(const std::filesystem::path& file, const Judges& judges = {});

// A plan document for a command: completes files that a run was ended over, and says of a script
// that it is one. InputError as read_plan has it. Fills `digest` where it is given.
Plan read_plan_file(const std::filesystem::path& file, DigestFindings* digest = nullptr);

}  // namespace lapwing
