// SPDX-License-Identifier: Apache-2.0
#include "framework/solve/edit_session.h"

#include <algorithm>

#include "framework/core/error.h"

namespace lapwing {
namespace {

bool worth_keeping(const SolveResult& result) {
  const SolveStatus status = result.report.status;
  return status != SolveStatus::unsupported && status != SolveStatus::numerical_error &&
         result.report.iterations > 0 && result.point.stages.size() > 0 &&
         result.point.stages.allFinite();
}

bool moves_alike(const Trajectory& a, const Trajectory& b) {
  return a.motion.name == b.motion.name && a.motion.columns == b.motion.columns &&
         a.has_gimbal == b.has_gimbal && a.has_target == b.has_target && a.samples.size() > 1;
}

}  // namespace

const char* to_string(AnswerGrade grade) {
  switch (grade) {
    case AnswerGrade::step:
      return "step";
    case AnswerGrade::converged:
      return "converged";
    case AnswerGrade::certified:
      return "certified";
    case AnswerGrade::rejected:
      return "rejected";
    case AnswerGrade::refused:
      return "refused";
  }
  return "refused";
}

EditSession::EditSession(Hear hear) : hear_(std::move(hear)) {
  if (!hear_) throw Error("an edit session needs a listener");
}

std::uint64_t EditSession::post(State state) {
  const std::lock_guard lock(mutex_);
  waiting_ = std::move(state);
  if (working_) working_->cancel();
  return ++revision_;
}

void EditSession::cancel() {
  const std::lock_guard lock(mutex_);
  waiting_ = nullptr;
  if (working_) working_->cancel();
}

void EditSession::begin_at(Trajectory flight) {
  flight_ = std::move(flight);
}

bool EditSession::work() {
  State state;
  std::uint64_t revision = 0;
  auto token = std::make_shared<CancellationToken>();
  {
    const std::lock_guard lock(mutex_);
    if (!waiting_) return false;
    std::swap(state, waiting_);
    revision = revision_;
    working_ = token;
  }
  struct Working {
    EditSession& session;
    ~Working() {
      const std::lock_guard lock(session.mutex_);
      session.working_.reset();
    }
  } const working{*this};
  answer(revision, state, *token);
  return true;
}

// The last point where the problem has its blocks, else none.
std::optional<WarmStart> EditSession::start_for(const EditStatement& statement) const {
  const TrajectoryProblem& problem = *statement.problem;
  if (flight_ && moves_alike(*flight_, problem.trajectory(problem.initial_guess())))
    return WarmStart{problem.point_of(*flight_), {}, {}};
  if (!kept_.problem) return statement.start;
  const StageLayout &now = problem.layout(), &then = kept_.problem->layout();
  bool alike = now.count() == then.count();
  for (int b = 0; alike && b < now.count(); ++b) {
    const BlockSpec &mine = now.block(b), &theirs = then.block(b);
    alike = mine.name == theirs.name && mine.size == theirs.size &&
            mine.topology == theirs.topology && mine.role == theirs.role;
  }
  if (!alike || problem.horizon().step_free != kept_.problem->horizon().step_free) return {};
  WarmStart start = kept_.point;
  const Horizon &horizon = problem.horizon(), &before = kept_.problem->horizon();
  if (horizon.stages != before.stages || horizon.leg_count() != before.leg_count()) {
    start = {problem.point_of(kept_.problem->trajectory(start.stages)), {}, {}};
  } else if (!horizon.step_free) {  // stages at the new times
    const Stages guess = problem.initial_guess();
    for (const char* block : {"time", "step"})
      start.stages.row(now.offset(now.index(block))) = guess.row(now.offset(now.index(block)));
  }
  if (start.bound_multipliers.size() != problem.columns()) start.bound_multipliers.resize(0);
  if (start.row_multipliers.size() == problem.rows() || start.row_multipliers.size() == 0)
    return start;
  // Rows came or went: those of the dynamics are the same ones.
  const int same = std::min(problem.dynamics_rows(), kept_.problem->dynamics_rows());
  Eigen::VectorXd rows = Eigen::VectorXd::Zero(problem.rows());
  rows.head(same) = start.row_multipliers.head(same);
  start.row_multipliers = std::move(rows);
  return start;
}

// Problem and point together.
void EditSession::keep(const EditAnswer& answer) {
  if (!worth_keeping(answer.result)) return;
  kept_ = {answer.problem, answer.result.point};
  flight_.reset();
}

void EditSession::answer(std::uint64_t revision, const State& state,
                         const CancellationToken& token) {
  EditAnswer answer;
  answer.revision = revision;
  EditStatement statement;
  try {
    statement = state({kept_.problem, token});
  } catch (const Cancelled&) {
    return;
  } catch (const InputError& error) {
    answer.message = error.what();
    if (!token.cancelled()) hear_(answer);
    return;
  }
  if (!statement.problem || !statement.solver)
    throw Error("an edit states a problem and names its solver");
  answer.problem = statement.problem;
  if (token.cancelled() || !solve(statement, token, answer)) return;
  answer.grade = AnswerGrade::converged;
  hear_(answer);
  if (statement.certify && !token.cancelled()) certify(statement, token, answer);
}

// False where it was cancelled.
bool EditSession::solve(const EditStatement& statement, const CancellationToken& token,
                        EditAnswer& answer) {
  SolveRequest request;
  request.cancellation = &token;
  request.memory = &memory_;
  request.warm_start = start_for(statement);
  request.moved = [&](const Stages& at) {
    if (token.cancelled()) return;
    hear_({.revision = answer.revision,
           .grade = AnswerGrade::step,
           .problem = answer.problem,
           .result = {{}, {at, {}, {}}},
           .message = {}});
  };
  const auto solved = [&] {
    answer.result = solve_by(*statement.solver, *answer.problem, request);
    return !token.cancelled() && answer.result.report.status != SolveStatus::cancelled;
  };
  bool whole = solved();
  if (whole && request.warm_start && answer.result.report.status != SolveStatus::optimal) {
    // A point that leads nowhere says nothing of the problem.
    const EditAnswer warm = answer;
    request.warm_start.reset();
    request.moved = {};
    whole = solved();
    if (!whole) answer = warm;
  }
  keep(answer);
  return whole;
}

void EditSession::certify(const EditStatement& statement, const CancellationToken& token,
                          EditAnswer& answer) {
  try {
    answer.message = statement.certify(answer, token);
  } catch (const Cancelled&) {
    return;
  }
  if (token.cancelled()) return;
  answer.grade = answer.message.empty() ? AnswerGrade::certified : AnswerGrade::rejected;
  hear_(answer);
}

}  // namespace lapwing
