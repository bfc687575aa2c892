// SPDX-License-Identifier: Apache-2.0
// Edited films end as they do when they are solved cold, whatever was cancelled, refused or thrown
// in between.
#include "framework/solve/edit_session.h"

#include <random>
#include <thread>

#include "tests/obstacles.h"
#include "tests/plugins/trajectory_solvers/film_problem.h"

namespace lapwing {
namespace {

using Problem = std::shared_ptr<const TrajectoryProblem>;

// A film that can be edited in every way.
struct Edited {
  std::vector<KeyframeTask> keyframes = {keyframe(0, {0, 0, 2}), keyframe(3.33, {6, 2, 5}),
                                         keyframe(6.1, {9, 5, 4}), keyframe(10, {12, -4, 3})};
  double duration = 10, keyframe_weight = 100, snap_weight = 1e-3;
  double speed = 6;                       // limit, m/s
  Eigen::Vector3d ball = {4.5, -0.5, 3};  // below the way
  double radius = 0.8;
  bool with_ball = false;
  bool limited = true;  // without limits the problem is quadratic
};

Problem stated(const Edited& film, const Problem& last = nullptr) {
  const Registry& registry = built_plugins();
  Vehicle vehicle = solo();
  vehicle.speed_across_max = film.speed;
  Environment environment;
  if (film.with_ball) {
    environment.obstacles.push_back(sphere_at("ball", film.ball, film.radius));
    environment = with_shapes(environment);
  }
  const int stages = static_cast<int>(std::lround(film.duration / 0.1)) + 1;
  auto problem = std::make_shared<TrajectoryProblem>(
      vehicle, Horizon{.stages = stages, .step = film.duration / (stages - 1)}, environment);
  problem->add_model("quadrotor", registry.create<VehicleModel>("quadrotor"));
  Value list = Value::list();
  std::vector<double> times;
  std::vector<Eigen::Vector3d> positions;
  for (const KeyframeTask& k : film.keyframes) {
    const Eigen::Vector3d& p = k.position;
    list.push_back(table({{"time", k.time}, {"value", Value::List{p.x(), p.y(), p.z()}}}));
    times.push_back(k.time);
    positions.push_back(p);
  }
  problem->add_cost("keyframe", film.keyframe_weight,
                    registry.create<CostTerm>("keyframe", table({{"keyframes", list}})));
  problem->add_cost(
      "snap", film.snap_weight,
      registry.create<CostTerm>("derivative", table({{"block", "force"}, {"order", 2}})));
  problem->add_cost("yaw", 1.0, registry.create<CostTerm>("yaw_derivative"));
  problem->add_cost("effort", 0.01, registry.create<CostTerm>("input_effort"));
  if (film.limited) {
    problem->add_constraint("input_limits",
                            registry.create<Constraint>("input_limits", table({{"norm", true}})));
    problem->add_constraint("state_limits", registry.create<Constraint>("state_limits"));
  }
  problem->add_constraint(
      "boundary_state", registry.create<Constraint>("boundary_state", table({{"start_yaw", 0.0}})));
  if (film.with_ball) problem->add_constraint("obstacle", registry.create<Constraint>("obstacle"));
  problem->set_path_guess(times, positions, std::vector<double>(times.size(), 0.0));
  problem->finish(last.get());
  return problem;
}

std::shared_ptr<const TrajectorySolver> solver() {
  return built_plugins().create<TrajectorySolver>("iqp");
}

using Certify = std::function<std::string(const EditAnswer&, const CancellationToken&)>;

struct Heard {
  std::vector<EditAnswer> answers;
  std::shared_ptr<const TrajectorySolver> by = solver();
  Certify certify = {};
  int cancel_at_step = 0;  // of those to come; 0: never
  EditSession session{[this](const EditAnswer& answer) {
    answers.push_back(answer);
    if (answer.grade == AnswerGrade::step && cancel_at_step > 0 && --cancel_at_step == 0)
      session.cancel();
  }};

  std::uint64_t post(const Edited& film) {
    return session.post([this, film](const EditSession::Turn& context) {
      return EditStatement{.problem = stated(film, context.last), .solver = by, .certify = certify};
    });
  }
  const EditAnswer& after(const Edited& film) {
    post(film);
    while (session.work()) {
    }
    return answers.back();
  }
};

// Costs agree within what the solver calls optimal, and so do the flights.
void expect_as_cold(const EditAnswer& answer, const Edited& film, const std::string& what) {
  ASSERT_EQ(answer.grade, AnswerGrade::converged) << what;
  ASSERT_EQ(answer.result.report.status, SolveStatus::optimal) << what;
  const Problem problem = stated(film);
  const SolveResult cold = solver()->solve(*problem, {});
  ASSERT_EQ(cold.report.status, SolveStatus::optimal) << what;
  EXPECT_NEAR(answer.result.report.cost, cold.report.cost, 5e-6 * (1 + cold.report.cost)) << what;
  EXPECT_LT(answer.result.report.violations.front().amount, 1e-5) << what;
  const auto edited = answer.problem->trajectory(answer.result.point.stages).samples;
  const auto other = problem->trajectory(cold.point.stages).samples;
  ASSERT_EQ(edited.size(), other.size()) << what;
  double apart = 0;
  for (std::size_t i = 0; i < edited.size(); ++i)
    apart = std::max(apart, (edited[i].position - other[i].position).norm());
  EXPECT_LT(apart, 0.05) << what;
}

// One of the things that a user does, at random.
std::string edit(Edited& film, std::mt19937& random) {
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const int which = std::uniform_int_distribution<int>(0, 6)(random);
  const std::size_t k = std::uniform_int_distribution<std::size_t>(1, 2)(random);
  switch (which) {
    case 0:
      film.keyframes[k].position += Eigen::Vector3d(uniform(-1, 1), uniform(-1, 1), 0.3);
      film.keyframes[k].position.z() = uniform(3.5, 6);
      return "moved keyframe " + std::to_string(k);
    case 1:
      film.keyframes[1].time = uniform(2.5, 4.5);
      film.keyframes[2].time = uniform(5.5, 8);
      return "other times";
    case 2:
      film.keyframe_weight = std::pow(10, uniform(1, 3));
      return "weight of keyframes";
    case 3:
      film.snap_weight = std::pow(10, uniform(-4, -2));
      return "weight of snap";
    case 4:
      film.speed = uniform(3, 9);
      return "limit of speed";
    case 5:
      film.duration = film.keyframes.back().time = std::round(uniform(9, 12) * 10) / 10;
      return "duration";
    default:
      film.with_ball = !film.with_ball;
      film.radius = uniform(0.5, 1.0);
      film.ball = {uniform(4, 5), uniform(-1, 0), uniform(1.5, 2)};
      return "obstacle";
  }
}

TEST(EditSession, RandomEditsEndAsColdSolvesDo) {
  std::mt19937 random(7);
  Edited film;
  Heard heard;
  expect_as_cold(heard.after(film), film, "at first");
  for (int k = 0; k < 60; ++k) {
    const std::string what = std::to_string(k) + ": " + edit(film, random);
    expect_as_cold(heard.after(film), film, what);
    if (HasFatalFailure()) return;
    EXPECT_EQ(heard.answers.back().revision, k + 2u);
  }
}

// The same edits one after the other give the same bits.
TEST(EditSession, Repeats) {
  std::vector<Stages> ends[2];
  for (auto& list : ends) {
    std::mt19937 random(11);
    Edited film;
    Heard heard;
    for (int k = 0; k < 10; ++k) {
      edit(film, random);
      list.push_back(heard.after(film).result.point.stages);
    }
  }
  for (std::size_t k = 0; k < ends[0].size(); ++k) EXPECT_EQ(ends[0][k], ends[1][k]) << k;
}

TEST(EditSession, StepsComeFirstAndTheVerifierLast) {
  std::string complaint;
  Heard heard;
  heard.certify = [&](const EditAnswer&, const CancellationToken&) { return complaint; };
  Edited film;
  EXPECT_EQ(heard.after(film).grade, AnswerGrade::certified);
  film.keyframes[1].position.x() += 1;
  complaint = "the sky is closed";
  heard.answers.clear();
  EXPECT_EQ(heard.after(film).message, complaint);
  const std::size_t count = heard.answers.size();
  ASSERT_GE(count, 3u);
  for (std::size_t k = 0; k + 2 < count; ++k) EXPECT_EQ(heard.answers[k].grade, AnswerGrade::step);
  EXPECT_EQ(heard.answers[count - 2].grade, AnswerGrade::converged);
  EXPECT_EQ(heard.answers[count - 1].grade, AnswerGrade::rejected);
  // What was judged is what is drawn.
  EXPECT_EQ(heard.answers[count - 2].result.point.stages,
            heard.answers[count - 1].result.point.stages);
  for (const EditAnswer& answer : heard.answers) EXPECT_EQ(answer.revision, 2u);
  // The first step is already near.
  const auto at = [](const EditAnswer& answer) -> Eigen::Vector3d {
    return answer.result.point.stages.col(33).head<3>();
  };
  EXPECT_LT((at(heard.answers[0]) - at(heard.answers[count - 1])).norm(), 0.3);
}

// Of its one program an early point is drawn, which keeps the film's equations.
TEST(EditSession, AQuadraticFilmIsDrawnBeforeItConverges) {
  Heard heard;
  Edited film;
  film.limited = false;
  ASSERT_TRUE(stated(film)->quadratic());
  heard.after(film);
  film.keyframes[1].position.x() += 1;
  heard.answers.clear();
  expect_as_cold(heard.after(film), film, "after an edit");
  ASSERT_EQ(heard.answers.size(), 3u);  // the last step is the converged one
  const EditAnswer &early = heard.answers.front(), &last = heard.answers.back();
  EXPECT_EQ(early.grade, AnswerGrade::step);
  const auto at = [](const EditAnswer& answer) -> Eigen::Vector3d {
    return answer.result.point.stages.col(33).head<3>();
  };
  EXPECT_LT((at(early) - at(last)).norm(), 0.5);
  EXPECT_LT(early.problem->leg_defects(early.result.point.stages).at(0), 1e-2);
}

TEST(EditSession, WhereNothingChangesTwoProgramsProveIt) {
  Edited film;
  Heard heard;
  heard.after(film);
  EXPECT_LE(heard.after(film).result.report.iterations, 2);
  EXPECT_GT(solver()->solve(*stated(film), {}).report.iterations, 2);
}

TEST(EditSession, ARefusedEditIsToldAndLeavesNoTrace) {
  Edited film;
  Heard heard;
  heard.after(film);
  Edited wrong = film;
  wrong.keyframes[3].time = 20;  // beyond the duration
  const EditAnswer refused = heard.after(wrong);
  EXPECT_EQ(refused.grade, AnswerGrade::refused);
  EXPECT_EQ(refused.revision, 2u);
  EXPECT_FALSE(refused.problem);
  EXPECT_NE(refused.message.find("20 s"), std::string::npos) << refused.message;
  EXPECT_LE(heard.after(film).result.report.iterations, 2);  // warm: the point was kept
  film.keyframes[1].position.x() += 0.5;
  expect_as_cold(heard.after(film), film, "after a refusal");
}

// Throws in the call of a given number.
class Failing final : public TrajectorySolver {
 public:
  SolveResult solve(const TrajectoryProblem& problem, const SolveRequest& request) const override {
    if (++calls == at) throw Error("out of order");
    return inner->solve(problem, request);
  }
  std::shared_ptr<const TrajectorySolver> inner = solver();
  mutable int calls = 0;
  int at = 0;
};

TEST(EditSession, WhatIsThrownComesOutAndLeavesNoTrace) {
  const auto failing = std::make_shared<Failing>();
  Heard heard;
  heard.by = failing;
  Edited film;
  heard.after(film);
  Edited other = film;
  other.keyframes[1].position.x() += 3;
  failing->at = failing->calls + 1;
  EXPECT_THROW(heard.after(other), Error);
  EXPECT_FALSE(heard.session.work());  // it is not tried again
  EXPECT_LE(heard.after(film).result.report.iterations, 2);
  heard.certify = [](const EditAnswer&, const CancellationToken&) -> std::string {
    throw Error("no verifier");
  };
  EXPECT_THROW(heard.after(other), Error);
  heard.certify = {};
  expect_as_cold(heard.after(other), other, "after the verifier threw");
}

TEST(EditSession, WhatCannotBeFlownIsAnsweredAndForgotten) {
  Edited film;
  Heard heard;
  heard.after(film);
  Edited low = film;
  low.with_ball = true;  // around the start: no flight begins in there
  low.ball = film.keyframes[0].position;
  low.radius = 3;
  const EditAnswer answer = heard.after(low);
  EXPECT_EQ(answer.grade, AnswerGrade::converged);
  expect_as_cold(heard.after(film), film, "after what cannot be flown");
}

TEST(EditSession, CancelledWorkEndsAndTheNextAnswerIsWhole) {
  std::mt19937 random(3);
  for (const int at : {1, 2}) {
    Heard heard;
    Edited film;
    heard.after(film);
    for (int k = 0; k < 12; ++k) {
      edit(film, random);
      heard.answers.clear();
      heard.cancel_at_step = at;
      heard.post(film);
      while (heard.session.work()) {
      }
      // Without so many steps it is answered.
      const bool cancelled = heard.cancel_at_step == 0;
      heard.cancel_at_step = 0;
      ASSERT_FALSE(heard.answers.empty()) << k;
      EXPECT_EQ(heard.answers.back().grade, cancelled ? AnswerGrade::step : AnswerGrade::converged)
          << k;
      expect_as_cold(heard.after(film), film,
                     std::to_string(k) + " after step " + std::to_string(at));
    }
  }
}

// An edit that is cancelled while it is judged has no certificate.
TEST(EditSession, NoCertificateOfWhatIsCancelled) {
  Heard heard;
  Edited film;
  heard.certify = [&](const EditAnswer&, const CancellationToken& token) -> std::string {
    heard.session.cancel();
    if (token.cancelled()) throw Cancelled();
    return "";
  };
  EXPECT_EQ(heard.after(film).grade, AnswerGrade::converged);
  heard.certify = [&](const EditAnswer&, const CancellationToken&) -> std::string {
    heard.session.cancel();
    return "";
  };
  EXPECT_EQ(heard.after(film).grade, AnswerGrade::converged);
}

TEST(EditSession, ANewerEditEndsTheOlderOne) {
  Edited film;
  Heard heard;
  heard.after(film);
  heard.answers.clear();
  std::mt19937 random(5);
  std::thread worker;
  std::atomic<bool> over{false};
  worker = std::thread([&] {
    while (!over || heard.session.work()) {
      if (!heard.session.work()) std::this_thread::yield();
    }
  });
  std::uint64_t last = 0;
  for (int k = 0; k < 40; ++k) {
    edit(film, random);
    last = heard.post(film);
    std::this_thread::sleep_for(
        std::chrono::milliseconds(std::uniform_int_distribution<int>(0, 30)(random)));
  }
  over = true;
  worker.join();
  ASSERT_FALSE(heard.answers.empty());
  for (std::size_t k = 1; k < heard.answers.size(); ++k)
    EXPECT_LE(heard.answers[k - 1].revision, heard.answers[k].revision);
  EXPECT_EQ(heard.answers.back().revision, last);
  expect_as_cold(heard.answers.back(), film, "the last");
}

TEST(EditSession, AnotherSolverFindsItsPlaceTaken) {
  const Problem problem = stated({});
  std::unique_ptr<SolverMemory> memory = std::make_unique<SolverMemory>();
  SolveRequest request;
  request.memory = &memory;
  const SolveResult kept = solver()->solve(*problem, request);
  const SolveResult again = solver()->solve(*problem, request);
  EXPECT_EQ(kept.point.stages, again.point.stages);
  EXPECT_EQ(kept.point.stages, solver()->solve(*problem, {}).point.stages);
}

}  // namespace
}  // namespace lapwing
