// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/mission_editor.h"

#include "framework/core/error.h"
#include "framework/mission/controller_source.h"
#include "framework/verify/verify.h"

namespace lapwing {

MissionEditor::MissionEditor(std::filesystem::path script, MissionSettings settings, Hear hear,
                             Judge judge)
    : script_(std::move(script)),
      settings_(std::move(settings)),
      hear_(std::move(hear)),
      judge_(std::move(judge)),
      session_([this](const EditAnswer& answer) { this->hear(answer); }) {
  if (!hear_) throw Error("a mission editor needs a listener");
  if (!judge_)
    judge_ = [this](const Plan& plan, const std::filesystem::path& folder,
                    const CancellationToken& token) {
      return verify(plan, {.folder = folder,
                           .cancellation = &token,
                           .controllers = controllers_of(*settings_.registry)});
    };
}

std::uint64_t MissionEditor::edit(MissionEdit edit) {
  return session_.post([this, edit = std::move(edit)](const EditSession::Turn& context) {
    return state(edit, context);
  });
}

EditStatement MissionEditor::state(const MissionEdit& edit, const EditSession::Turn& context) {
  MissionSettings settings = settings_;
  settings.limits = sandbox_limits(edit.layers, edit.overrides);
  settings.cancellation = &context.cancellation;
  settings.like = context.last;
  auto mission = std::make_unique<Mission>(script_, settings);
  mission->configure(edit.layers, edit.overrides);
  MissionStatement statement = mission->state();
  mission_ = std::move(mission);
  statement_ = std::move(statement);
  EditStatement edited{
      .problem = statement_.problem, .solver = statement_.solver, .start = statement_.start};
  if (edit.certify)
    edited.certify = [this](const EditAnswer& answer, const CancellationToken& token) {
      plan_ = std::make_shared<const Plan>(plan_of(answer));
      certificate_ = judge_(*plan_, statement_.obstacle_folder, token);
      std::string all;
      for (const Check& check : certificate_->failures())
        all += (all.empty() ? "" : "; ") + to_line(check);
      return all;
    };
  return edited;
}

Plan MissionEditor::plan_of(const EditAnswer& answer) const {
  Plan plan = statement_.plan;
  plan.trajectory = answer.problem->trajectory(answer.result.point.stages);
  if (answer.grade == AnswerGrade::step)
    plan.solver = Value();
  else
    plan.solver = to_value(answer.result.report, statement_.solver_name);
  return plan;
}

void MissionEditor::hear(const EditAnswer& answer) {
  const bool judged =
      answer.grade == AnswerGrade::certified || answer.grade == AnswerGrade::rejected;
  EditedPlan edited{answer, nullptr, {}, {}};
  if (judged) {
    edited.plan = plan_;
    edited.certificate = certificate_;
  } else if (answer.problem) {
    edited.plan = std::make_shared<const Plan>(plan_of(answer));
  }
  edited.folder = statement_.obstacle_folder;
  hear_(edited);
}

}  // namespace lapwing
