// SPDX-License-Identifier: Apache-2.0
// Problems that are edited and solved again, for interactive tools.
//
//   EditSession session(draw);
//   session.post(state);          // any thread: how the problem is stated now
//   while (session.work()) {}     // the solving thread: answers all that was posted
//
// An edit is whatever makes another statement of the problem: a keyframe moved in place or time, a
// weight, an obstacle, a limit. Every answer has the number of the edit that it answers, and a
// grade: *steps* of the solver, the first one soon, then the *converged* trajectory, then what a
// verifier says of it. A newer edit cancels the work on an older one, whose further answers never
// come.
//
// From edit to edit the session keeps the last point with its multipliers, the sparsity of the
// problem and the solver's memory, so that ordering and symbolic factors stay where the structure
// does. A point of another number of stages is resampled. Work that is cancelled leaves the point
// that it had come to, which is what was drawn last; statements that are refused and work that
// throws leave no trace. The converged answer is that of the problem solved cold, within the
// solver's tolerance, where the problem has one optimum; where it has several, the one that the
// last point leads to.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "framework/solve/trajectory_solver.h"

namespace lapwing {

enum class AnswerGrade {
  step,       // on the way: to be drawn
  converged,  // what the solver ends with; its report has the status
  certified,  // and the verifier found nothing against it
  rejected,   // the verifier did: `message` says what
  refused,    // no such problem can be stated: `message` says why; no point
};
const char* to_string(AnswerGrade grade);

struct EditAnswer {
  std::uint64_t revision = 0;  // as `post` numbered the edit
  AnswerGrade grade = AnswerGrade::refused;
  std::shared_ptr<const TrajectoryProblem> problem;  // that is solved; null where refused
  SolveResult result;                                // of a step, the stages alone
  std::string message;
};

// What an edit makes: the problem, who solves it, and who judges it.
struct EditStatement {
  std::shared_ptr<const TrajectoryProblem> problem;
  std::shared_ptr<const TrajectorySolver> solver;
  std::optional<WarmStart> start = {};  // for a session that has no point yet
  // What speaks against a converged answer, in words; "" for nothing. Absent: the answer is not
  // certified. May throw Cancelled, or return early, where the token is cancelled.
  std::function<std::string(const EditAnswer&, const CancellationToken&)> certify = {};
};

class EditSession {
 public:
  struct Turn {
    std::shared_ptr<const TrajectoryProblem> last;  // before the edit, null at first: for `finish`
    const CancellationToken& cancellation;
  };
  // States the problem anew; called on the solving thread. InputError where there is no such
  // problem. May throw Cancelled where that is asked for.
  using State = std::function<EditStatement(const Turn&)>;
  // Gets every answer, on the solving thread, in order.
  using Hear = std::function<void(const EditAnswer&)>;

  explicit EditSession(Hear hear);

  // From any thread. Returns at once with the edit's number, from 1 on. Only the newest edit that
  // waits is worked on.
  std::uint64_t post(State state);
  // From any thread: ends the work under way, if any, and forgets an edit that waits.
  void cancel();
  // On the solving thread: the next edit begins at this flight, resampled at its times, in place of
  // the last point. One of another motion, or without a gimbal or target that the problem has, is
  // no start, and the last point stays.
  void begin_at(Trajectory flight);
  // Works on what was posted; false where there was nothing. One thread at a time. What a solver, a
  // plugin or a listener throws comes out, and the session is as it was before that edit.
  bool work();

 private:
  struct Kept {
    std::shared_ptr<const TrajectoryProblem> problem;
    WarmStart point;
  };
  void answer(std::uint64_t revision, const State& state, const CancellationToken& token);
  bool solve(const EditStatement& statement, const CancellationToken& token, EditAnswer& answer);
  void certify(const EditStatement& statement, const CancellationToken& token, EditAnswer& answer);
  std::optional<WarmStart> start_for(const EditStatement& statement) const;
  void keep(const EditAnswer& answer);

  Hear hear_;
  std::unique_ptr<SolverMemory> memory_;
  Kept kept_;
  std::optional<Trajectory> flight_;  // of `begin_at`, until there is a newer point

  std::mutex mutex_;  // of what follows
  std::uint64_t revision_ = 0;
  State waiting_;
  std::shared_ptr<CancellationToken> working_;
};

}  // namespace lapwing
