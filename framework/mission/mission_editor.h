// SPDX-License-Identifier: Apache-2.0
// A mission under edit, for interactive tools: its script is stated anew after every edit, solved
// from where the last edit ended, and judged by the verifier.
//
//   MissionEditor editor("shot.lua", settings, draw);
//   editor.edit({layers, {"keyframes[2].position=[0,4,6]"}});   // any thread
//   while (editor.work()) {}                                   // the solving thread
//
// An edit is a configuration on the script, as `lapwing run` takes it: `run` with the same one
// plans the same flight, within the solver's tolerance. What is said of sessions holds
// (solve/edit_session.h): order of answers, cancellation, refusals, errors.
#pragma once

#include <filesystem>
#include <optional>

#include "framework/mission/mission.h"
#include "framework/solve/edit_session.h"
#include "framework/verify/certificate.h"

namespace lapwing {

struct MissionEdit {
  std::vector<Value> layers;           // lowest first
  std::vector<std::string> overrides;  // "key.path=value", in order
  bool certify = true;                 // else the last answer is the converged one
};

struct EditedPlan {
  EditAnswer answer;
  // The plan with the answer's motion, without a certificate; null where the edit was refused.
  std::shared_ptr<const Plan> plan;
  // The verifier's, of this very plan: where the grade is certified or rejected.
  std::optional<Certificate> certificate;
  // Where the files lie that the plan's environment names, until the next edit.
  std::filesystem::path folder = {};
  // As of MissionResult.
  std::shared_ptr<const ScanRecord> scan = {};
  std::shared_ptr<const ExplorationRecord> exploration = {};
};

class MissionEditor {
 public:
  // Gets every answer, on the solving thread, in order.
  using Hear = std::function<void(const EditedPlan&)>;

  // Judges a plan; the files that its environment names lie in the folder. May throw Cancelled.
  using Judge = std::function<Certificate(const Plan&, const std::filesystem::path& folder,
                                          const CancellationToken&)>;

  // The script is read again by every edit. `settings.start` is where the first one begins. Without
  // a judge the verifier judges by itself.
  MissionEditor(std::filesystem::path script, MissionSettings settings, Hear hear,
                Judge judge = {});

  // As EditSession::post, cancel, work and begin_at.
  std::uint64_t edit(MissionEdit edit);
  void cancel() { session_.cancel(); }
  bool work() { return session_.work(); }
  void begin_at(Trajectory flight) { session_.begin_at(std::move(flight)); }

 private:
  EditStatement state(const MissionEdit& edit, const EditSession::Turn& context);
  Plan plan_of(const EditAnswer& answer) const;
  void hear(const EditAnswer& answer);

  std::filesystem::path script_;
  MissionSettings settings_;
  Hear hear_;
  Judge judge_;
  MissionStatement statement_;        // of the edit that is worked on
  std::shared_ptr<const Plan> plan_;  // of the answer that was judged
  std::optional<Certificate> certificate_;
  std::unique_ptr<Mission> mission_;  // whose files the statement's environment names
  EditSession session_;
};

}  // namespace lapwing
