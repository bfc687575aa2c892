// SPDX-License-Identifier: Apache-2.0
// Smooth legs of a tour: by every solver, past corners, and in a whole scan.
#include "framework/trajectory/polyline.h"
#include "tests/missions/scan_hut.h"

namespace lapwing {
namespace {

// Legs without a tour: round corners, a turn on the spot, straight up, nearly back.
constexpr const char* kLegs = R"(
local smooth = require "mission.scan_smooth"
local function number(name, default)
  return { name = name, type = "number", default = default, summary = "of the flight" }
end
local legs = {
  { points = {0, 0, 10,  10, 0, 10,  10, 8, 12,  4, 9, 14}, yaw_from = 0, yaw_to = 2,
    seconds = 16 },
  { points = {0, 0, 10,  0, 0, 10}, yaw_from = 0, yaw_to = 3, seconds = 4 },
  { points = {0, 0, 10,  0, 0, 18}, yaw_from = 0, yaw_to = -3, seconds = 7 },
  { points = {0, 0, 10,  1, 0, 10,  0.2, 0.1, 10}, yaw_from = 1, yaw_to = 1, seconds = 5 },
}
return { kind = "legs", name = "legs",
  options = lapwing.options({
    { name = "flight", type = "table", summary = "as of a scan", table = {
      number("speed", 3), number("acceleration", 2), number("stray", 0.1) } },
    { name = "which", type = "integer", default = 1, summary = "of the legs" },
    { name = "hurry", type = "number", default = 1, summary = "share of its seconds" },
    { name = "solver", type = "plugin", kind = "trajectory_solver", default = "iqp",
      summary = "of smooth legs" } }, {}),
  plan = function(run)
    local leg = legs[run.options.which]
    leg.seconds = run.options.hurry * leg.seconds
    local found, stray = smooth.legs(run, run:vehicle("vehicles/solo"), { legs = { leg } })
    return run:plan { solution = found[1], figures = { stray = stray } }
  end }
)";

class SmoothLegs : public Scanning {
 protected:
  void SetUp() override {
    Scanning::SetUp();
    write_file_atomically(folder_ / "legs.lua", kLegs);
  }
  Trajectory flown(const std::string& more) {
    EXPECT_EQ(run(more, "legs.lua", "legs"), 0) << more << ": " << error();
    return read_plan(folder_ / "legs/plan.json").trajectory;
  }
};

TEST_F(SmoothLegs, EverySolverFliesThemAlike) {
  for (const int which : {1, 2, 3, 4}) {
    const std::string leg = "--set which=" + std::to_string(which);
    const Trajectory first = flown(leg);
    for (const Sample& s : {first.samples.front(), first.samples.back()}) {
      EXPECT_LT(s.velocity.norm(), 1e-6);
    }
    for (const char* solver : {"ipopt", "nlopt"}) {
      const Trajectory other = flown(leg + " --set solver=" + solver);
      ASSERT_EQ(other.samples.size(), first.samples.size()) << solver;
      for (std::size_t k = 0; k < first.samples.size(); ++k)
        ASSERT_LT((other.samples[k].position - first.samples[k].position).norm(), 1e-3)
            << solver << ", leg " << which << ", sample " << k;
    }
  }
}

// Past both corners without a stop, and no farther from the way than is allowed.
TEST_F(SmoothLegs, CornersArePassed) {
  const Points way = {{0, 0, 10}, {10, 0, 10}, {10, 8, 12}, {4, 9, 14}};
  const Trajectory flight = flown("");
  double slowest = 10;
  for (const Sample& s : flight.samples) {
    EXPECT_LE(distance_to({way}, s.position), 0.1);
    if (s.time > 2 && s.time < flight.duration() - 2)
      slowest = std::min(slowest, s.velocity.norm());
  }
  EXPECT_GT(slowest, 0.2);
  for (const Eigen::Vector3d& corner : way) {
    double nearest = 10;
    for (const Sample& s : flight.samples)
      nearest = std::min(nearest, (s.position - corner).norm());
    EXPECT_LT(nearest, 0.25);
  }
}

TEST_F(SmoothLegs, ALegThatIsTooFastTakesLonger) {
  const double hurried = flown("--set which=3 --set hurry=0.5").duration();
  EXPECT_GT(hurried, 3.6) << "8 m up do not go in 3.5 s";
  EXPECT_LE(hurried, 3 * 3.5);
}

TEST_F(SmoothLegs, ALegThatCannotBeIsNamed) {
  EXPECT_NE(run("--set flight.stray=1e-6", "legs.lua", "legs"), 0);
  EXPECT_THAT(error(), HasSubstr("no smooth flight of leg 1 of 1"));
  EXPECT_THAT(error(), HasSubstr("flight.stray"));
  EXPECT_FALSE(fs::exists(folder_ / "legs/plan.json"));
}

class SlowSmoothLegs : public SmoothLegs {};

// The same budget shows more where no leg creeps up to its view.
TEST_F(SlowSmoothLegs, AScanShowsMoreInItsBudget) {
  ASSERT_EQ(run(""), 0) << error();
  const Value before = answer();
  ASSERT_EQ(run("--set flight.smooth=true"), 0) << error();
  const Value tour = answer().at("tour");
  EXPECT_GT(tour.at("score").as_number(), 1.1 * before.at("tour").at("score").as_number());
  EXPECT_THAT(plan(), HasSubstr("smooth legs by iqp"));
  const Plan read = read_plan(folder_ / "out/plan.json");
  EXPECT_LE(read.trajectory.duration(), 70);
  EXPECT_NEAR(read.trajectory.duration(), tour.at("seconds").as_number() + 0.5, 1e-3);
  const Certificate certificate = verify(read, folder_ / "out");
  for (const Check& check : certificate.failures()) ADD_FAILURE() << to_line(check);
  EXPECT_THAT(refused("--set flight.stray=0"), HasSubstr("flight.stray"));
}

}  // namespace
}  // namespace lapwing
