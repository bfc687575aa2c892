// SPDX-License-Identifier: Apache-2.0
// Flights of the closed-loop simulator, written in each format and compared with their plan.
#include "framework/flight_review/flight_review.h"

#include <gmock/gmock.h>

#include "framework/flight_log/flight_log_reader.h"
#include "framework/flight_log/log_builder.h"
#include "framework/plugin/registry.h"
#include "tests/flight_review/log_writers.h"
#include "tests/flight_review/telemetry_writer.h"
#include "tests/obstacles.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

FlightLog read_by(const std::string& name, const std::string& bytes) {
  static const Registry registry({LAPWING_BUILD_DIR "/lib/plugins"});
  return registry.create<FlightLogReader>(name)->read(bytes);
}

FlightConditions windy() {
  FlightConditions conditions;
  conditions.wind_mean = 6;
  conditions.wind_gust = 1.5;
  return conditions;
}

bool says(const std::vector<std::string>& all, const std::string& part) {
  for (const std::string& one : all)
    if (one.find(part) != one.npos) return true;
  return false;
}

double worst_of(const FlightReview& review, const char* name) {
  const ErrorSeries* errors = find_error(review.errors, name);
  return errors ? errors->quantile(1) : NAN;
}

// What the simulator says of the flight, without a recorder: the largest distance from the plan.
double true_worst(const Plan& plan, const std::vector<RecordedState>& states) {
  double worst = 0;
  for (const RecordedState& s : states)
    if (s.time <= plan.trajectory.samples.back().time)
      worst = std::max(worst, (s.position - sample_at(plan.trajectory, s.time).position).norm());
  return worst;
}

TEST(Review, EveryFormatTellsTheSameFlight) {
  const Plan plan = wave_plan();
  const auto flown = simulated_flight(plan, windy());
  const double truth = true_worst(plan, flown);
  ASSERT_GT(truth, 0.04);
  const auto states = recorded(flown, {.clock = 200});
  for (const auto& [format, bytes] : {std::pair<std::string, std::string>{"ulog", ulog_of(states)},
                                      {"dataflash", dataflash_of(states)},
                                      {"csv", airdata_of(states)},
                                      {"tlog", tlog_of(states)},
                                      {"gpx", gpx_of(states)}}) {
    const bool from_first = format == "gpx" || format == "tlog";
    const double clock = from_first ? 200 - states[0].time : 200;
    const FlightReview review = review_flight(plan, read_by(format, bytes),
                                              {.clock = clock, .estimate_offset = false}, ".");
    EXPECT_NEAR(worst_of(review, "distance"), truth, 0.02) << format;
    EXPECT_LT(review.missing_after + review.missing_before, 0.1) << format;
    EXPECT_EQ(find_error(review.errors, "camera") != nullptr, format != "gpx") << format;
    if (format != "gpx") {
      EXPECT_LT(worst_of(review, "camera"), 1e-3) << format;
    }
  }
}

TEST(Review, OffsetAndClockOfASimulatedFlightComeBack) {
  const Plan plan = wave_plan();
  const auto flown = simulated_flight(plan, windy());
  const Eigen::Vector3d offset(1.5, -0.7, 2);
  // Without an offset first: a controller's own lag is in both.
  const FlightReview plain =
      review_flight(plan, read_by("ulog", ulog_of(recorded(flown, {.clock = 50}))), {}, ".");
  const FlightReview moved = review_flight(
      plan, read_by("ulog", ulog_of(recorded(flown, {.clock = 777.7, .offset = offset}))), {}, ".");
  EXPECT_NEAR(moved.alignment.clock - plain.alignment.clock, 727.7, 1e-3);
  EXPECT_LT((moved.alignment.offset - plain.alignment.offset + offset).norm(), 1e-2);
  EXPECT_NEAR(worst_of(moved, "distance"), worst_of(plain, "distance"), 1e-2);
  EXPECT_NEAR(plain.alignment.clock, 50, 0.15);
}

TEST(Review, ErrorsAlongAcrossAndInHeightAreTold) {
  const Plan plan = wave_plan();
  auto states = ideal_flight(plan, 50, 0, 0);
  for (RecordedState& s : states) {
    const Sample planned = sample_at(plan.trajectory, std::min(s.time, 40.0));
    const Eigen::Vector2d way = planned.velocity.head<2>().normalized();
    if (s.time > 10 && s.time < 20)
      s.position.head<2>() += 0.3 * Eigen::Vector2d(-way.y(), way.x());
    if (s.time > 25 && s.time < 30) s.position.z() -= 0.4;
    if (s.time > 30) s.yaw += 0.1, s.camera.x() += 0.1;
    s.orientation = Eigen::AngleAxisd(s.yaw, Eigen::Vector3d::UnitZ());
  }
  const FlightReview review =
      review_flight(plan, read_by("ulog", ulog_of(recorded(states, {.clock = 10}))),
                    {.clock = 10, .estimate_offset = false}, ".");
  const ErrorSeries* across = find_error(review.errors, "across");
  EXPECT_NEAR(across->values[across->worst()], 0.3, 1e-3);
  EXPECT_GT(across->times[across->worst()], 10);
  EXPECT_LT(across->times[across->worst()], 20);
  const ErrorSeries* height = find_error(review.errors, "height");
  EXPECT_NEAR(height->values[height->worst()], -0.4, 1e-3);
  EXPECT_GT(height->times[height->worst()], 25);
  EXPECT_NEAR(worst_of(review, "along"), 0, 1e-3);
  EXPECT_NEAR(find_error(review.errors, "yaw")->quantile(1), 0.1, 1e-3);
  EXPECT_NEAR(worst_of(review, "camera"), 0.1, 0.02);
}

TEST(Review, TimeBehindThePlanIsTold) {
  const Plan plan = wave_plan();
  auto states = ideal_flight(plan, 50, 0, 0);
  // From 20 s on it waits for two seconds.
  for (RecordedState& s : states)
    if (s.time > 20) s.time += 2;
  const FlightReview review =
      review_flight(plan, read_by("ulog", ulog_of(recorded(states, {.clock = 10}))),
                    {.clock = 10, .estimate_offset = false}, ".");
  const ErrorSeries* late = find_error(review.errors, "late");
  ASSERT_NE(late, nullptr);
  EXPECT_NEAR(late->values[late->worst()], 2, 0.2);
  double before = 0;
  for (std::size_t i = 0; i < late->times.size(); ++i)
    if (late->times[i] < 19) before = std::max(before, std::abs(late->values[i]));
  EXPECT_LT(before, 0.1);
  EXPECT_LT(worst_of(review, "path"), 0.1);
  EXPECT_NEAR(review.flown.finish, 42, 0.5);
  EXPECT_TRUE(says(advice_of(plan, review), "fell behind by up to"));
}

TEST(Review, BrokenLimitsAreNamedWithTheirTimes) {
  Plan plan = wave_plan();
  // A ball that the plan passes at 0.6 m more than its margin; the flight is a metre nearer in
  // height alone, and passes it on its side.
  const Sample near = sample_at(plan.trajectory, 15);
  Obstacle ball;
  ball.name = "tree";
  ball.type = "sphere";
  ball.parameters.set(
      "center", Value(Value::List{near.position.x(), near.position.y(), near.position.z() + 3.1}));
  ball.parameters.set("radius", 1.5);
  plan.environment.obstacles.push_back(ball);
  plan.environment.margin = 1;
  auto states = ideal_flight(plan, 50, 0, 0);
  const auto judged = [&](const std::vector<RecordedState>& flown) {
    return review_flight(plan, read_by("ulog", ulog_of(recorded(flown, {.clock = 10}))),
                         {.clock = 10, .estimate_offset = false}, ".");
  };
  const FlightReview good = judged(states);
  EXPECT_TRUE(good.kept()) << to_line(good.certificate.broken()[0].flown);
  ASSERT_NE(good.certificate.find("clearance"), nullptr);
  EXPECT_NEAR(*good.certificate.find("clearance")->flown.worst, 1.6, 0.05);
  for (RecordedState& s : states)
    s.position.z() += 1 * std::exp(-0.5 * std::pow((s.time - 15) / 1.5, 2));
  const FlightReview bad = judged(states);
  EXPECT_FALSE(bad.kept());
  const FlownCheck* clearance = bad.certificate.find("clearance");
  EXPECT_FALSE(clearance->flown.pass);
  EXPECT_NEAR(*clearance->flown.worst, 0.65, 0.05);
  EXPECT_NEAR(clearance->flown.at, 15, 1.5);
  EXPECT_TRUE(says(advice_of(plan, bad), "plan with `margin`"));
}

// Lapwing's own recording, in the world of the plan.
FlightLog own_log(const Eigen::Vector3d& shift, double until = 1e9) {
  LogBuilder builder("csv", 0);
  builder.log.recorder = "Lapwing";
  builder.log.clock = "the start of the plan";
  for (const RecordedState& s : ideal_flight(wave_plan(), 20, 0, 0)) {
    const Eigen::Vector3d p = s.position + shift;
    if (s.time <= until) builder.add("position", s.time, {p.x(), p.y(), p.z()});
  }
  return builder.finish();
}

// The wave and a wall 6 m north of its northernmost place; the plan keeps 1 m from it.
Plan plan_beside_a_wall() {
  Plan plan = wave_plan();
  double north = -INFINITY;
  for (const Sample& s : plan.trajectory.samples) north = std::max(north, s.position.y());
  plan.environment.obstacles.push_back(box_at("wall", {-30, north + 5, 0}, {30, north + 6, 15}));
  plan.environment.margin = 1;
  return plan;
}

TEST(Review, AFlightBesideItsPlanIsNotFlownAsPlanned) {
  const Plan plan = plan_beside_a_wall();
  for (const bool offset : {true, false}) {
    const auto judged = [&](const Eigen::Vector3d& shift) {
      return review_flight(plan, own_log(shift), {.clock = {}, .estimate_offset = offset}, ".");
    };
    const FlightReview good = judged({0.2, 0, 0});
    EXPECT_TRUE(good.kept()) << verdict_of(good);
    EXPECT_EQ(verdict_of(good), "flown as planned");
    const FlightReview through = judged({0, 6, 0});
    EXPECT_FALSE(through.kept());
    EXPECT_FALSE(through.certificate.find("clearance")->flown.pass) << offset;
    EXPECT_LT(*through.certificate.find("clearance")->flown.worst, 0);
    EXPECT_THAT(verdict_of(through), HasSubstr("broke limits that the plan keeps, 6"));
    const FlightReview far = judged({0, -20, 0});
    EXPECT_FALSE(far.kept());
    EXPECT_TRUE(far.certificate.find("clearance")->flown.pass);
    EXPECT_NEAR(far.beside, 20, 0.1);
    EXPECT_EQ(verdict_of(far), "20 m beside the plan");
    const FlightReview low = judged({0, 0, -4.5});
    EXPECT_FALSE(low.kept());
    EXPECT_EQ(verdict_of(low), "4.5 m beside the plan");
  }
}

TEST(Review, ThePilotsRangeAndSightAreJudgedAsFlown) {
  Plan plan = wave_plan();
  // The pilot stands west of the wave; a wall south of the wave hides nothing of the plan.
  double south = INFINITY, far = 0;
  for (const Sample& s : plan.trajectory.samples) south = std::min(south, s.position.y());
  PilotPlace pilot{{-40, 0, 1.7}, 500, 1};
  for (const Sample& s : plan.trajectory.samples)
    far = std::max(far, (s.position - pilot.eye).norm());
  pilot.range = far + 2;
  plan.environment.pilot = pilot;
  plan.environment.obstacles.push_back(box_at("wall", {-30, south - 4, 0}, {30, south - 3, 40}));
  const auto judged = [&](const Eigen::Vector3d& shift) {
    return review_flight(plan, own_log(shift), {.clock = {}, .estimate_offset = false}, ".");
  };
  const FlightReview good = judged({0, 0, 0});
  EXPECT_TRUE(good.kept()) << verdict_of(good);
  for (const char* name : {"pilot_distance", "pilot_sight"}) {
    ASSERT_NE(good.certificate.find(name), nullptr) << name;
    EXPECT_TRUE(good.certificate.find(name)->flown.pass) << name;
  }
  const FlightReview far_off = judged({2.8, 0, 0});
  EXPECT_FALSE(far_off.certificate.find("pilot_distance")->flown.pass);
  EXPECT_TRUE(says(advice_of(plan, far_off), "plan with `pilot.range` = "));
  const FlightReview behind = judged({0, -14, 0});
  EXPECT_FALSE(behind.certificate.find("pilot_sight")->flown.pass);
  EXPECT_GT(*behind.certificate.find("pilot_sight")->flown.worst, 1);
  EXPECT_TRUE(says(advice_of(plan, behind), "place the pilot where more of the flight is seen"));
}

TEST(Review, APartOfAFlightIsKeptAsFarAsTheLogGoes) {
  const Plan plan = plan_beside_a_wall();
  const FlightReview part = review_flight(plan, own_log({0, 0, 0}, 12.4), {}, ".");
  EXPECT_FALSE(part.kept());
  EXPECT_FALSE(part.broke());
  EXPECT_NEAR(part.share(), 0.31, 0.005);
  EXPECT_THAT(verdict_of(part), HasSubstr("kept as far as the log goes (3"));
  // A gap in the middle is missing as well; half a second at the end is not.
  FlightLog holed = own_log({0, 0, 0}, 39.6);
  EXPECT_TRUE(review_flight(plan, holed, {}, ".").kept());
  LogSeries& position = holed.series["position"];
  LogSeries left{"", {}, {}};
  for (std::size_t i = 0; i < position.size(); ++i) {
    if (position.times[i] > 15 && position.times[i] < 25) continue;
    left.times.push_back(position.times[i]);
    for (std::size_t k = 0; k < 3; ++k) left.values.push_back(position.values[3 * i + k]);
  }
  position = left;
  const FlightReview hole = review_flight(plan, holed, {}, ".");
  EXPECT_FALSE(hole.kept());
  EXPECT_NEAR(hole.share(), 0.74, 0.01);
}

TEST(Review, SpeedsAndFramingAreJudgedAsFlown) {
  Plan plan = wave_plan();
  plan.environment.subjects.push_back({"actor", {0}, {{0, 0, 1}}, 1.8, 0.6});
  auto states = ideal_flight(plan, 50, 0, 0);
  // The camera as flown looks at the subject; the wave's own does not always.
  for (RecordedState& s : states) {
    const Eigen::Vector3d to = Eigen::Vector3d(0, 0, 1) - s.position;
    s.camera = {std::atan2(to.y(), to.x()), std::atan2(to.z(), to.head<2>().norm())};
  }
  plan.task.framing.push_back({"actor", {0, 40}});
  const auto judged = [&] {
    return review_flight(plan, read_by("ulog", ulog_of(recorded(states, {.clock = 10}))),
                         {.clock = 10, .estimate_offset = false}, ".");
  };
  const FlightReview seen = judged();
  ASSERT_NE(seen.certificate.find("framing"), nullptr);
  EXPECT_GT(*seen.certificate.find("framing")->flown.worst, 0.99);
  // Away for a quarter of the time.
  for (RecordedState& s : states)
    if (s.time > 10 && s.time < 20) s.camera.x() += 2;
  const FlightReview away = judged();
  EXPECT_NEAR(*away.certificate.find("framing")->flown.worst, 0.75, 0.02);
  EXPECT_FALSE(away.certificate.find("framing")->flown.pass);
  Vehicle slow = wave_vehicle();
  slow.speed_across_max = 2;
  plan.vehicle = to_value(slow);
  const FlightReview fast = judged();
  const FlownCheck* speed = fast.certificate.find("speed_across");
  ASSERT_NE(speed, nullptr);
  EXPECT_FALSE(speed->flown.pass);
  double truth = 0;
  for (const Sample& s : plan.trajectory.samples)
    truth = std::max(truth, s.velocity.head<2>().norm());
  EXPECT_NEAR(*speed->flown.worst, truth, 0.05);
}

TEST(Review, ImagesOfAScanAreFound) {
  Plan plan = wave_plan();
  ScanTask scan;
  scan.region = Eigen::AlignedBox3d(Eigen::Vector3d(-1, -1, 0), Eigen::Vector3d(1, 1, 2));
  scan.camera = {640, 480, 500, 500, 319.5, 239.5};
  for (const double time : {5.0, 15.0, 25.0, 35.0}) {
    const Sample s = sample_at(plan.trajectory, time);
    scan.views.push_back({time, s.position, s.yaw + s.gimbal_yaw, s.gimbal_pitch});
  }
  plan.task.scan = scan;
  const auto states = recorded(ideal_flight(plan, 50, 0, 0), {.clock = 10});
  // The second image is half a second late, the last is missing.
  const FlightReview review =
      review_flight(plan, read_by("ulog", ulog_of(states, true, {15, 25.5, 35})),
                    {.clock = 10, .estimate_offset = false}, ".");
  ASSERT_EQ(review.certificate.views.size(), 4u);
  EXPECT_TRUE(review.certificate.views[0].taken);
  EXPECT_FALSE(review.certificate.views[1].taken);
  EXPECT_TRUE(review.certificate.views[2].taken);
  EXPECT_FALSE(review.certificate.views[3].taken);
  EXPECT_NEAR(review.certificate.views[1].time, 15.5, 1e-3);
  EXPECT_LT(review.certificate.views[0].distance, 0.01);
}

TEST(Review, ALogCutShortIsComparedAsFarAsItGoes) {
  const Plan plan = wave_plan();
  const auto states = recorded(ideal_flight(plan, 50), {.clock = 30, .noise = 0.01});
  const std::string bytes = ulog_of(states);
  const FlightReview review =
      review_flight(plan, read_by("ulog", bytes.substr(0, bytes.size() / 2)), {}, ".");
  EXPECT_NEAR(review.alignment.clock, 30, 0.02);
  EXPECT_NEAR(review.missing_after, 20, 1);
  const auto said = alignment_sentences(review);
  EXPECT_TRUE(says(said, "the log is damaged: it ends within a record"));
  EXPECT_TRUE(says(said, "of the plan are not in the log"));
  EXPECT_LT(worst_of(review, "distance"), 0.1);
}

TEST(Review, DropoutsAreBridgedAndSaid) {
  const Plan plan = wave_plan();
  auto states = recorded(ideal_flight(plan, 50), {.clock = 30});
  std::erase_if(states, [](const RecordedState& s) { return s.time > 45 && s.time < 47; });
  const FlightReview review = review_flight(plan, read_by("ulog", ulog_of(states)), {}, ".");
  EXPECT_NEAR(review.alignment.clock, 30, 0.01);
  EXPECT_TRUE(says(alignment_sentences(review), "positions are missing for up to 2"));
  EXPECT_LT(worst_of(review, "distance"), 0.05);
}

TEST(Review, AnOriginIsAskedForWhereThereAreLatitudesAlone) {
  Plan plan = wave_plan();
  plan.geodetic_origin.reset();
  const auto states = recorded(ideal_flight(plan, 10), {.clock = 30});
  try {
    review_flight(plan, read_by("gpx", gpx_of(states)), {}, ".");
    ADD_FAILURE() << "it was not refused";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("--origin LAT,LON,HEIGHT,OF"));
  }
  // A local frame needs none.
  const FlightReview review = review_flight(plan, read_by("ulog", ulog_of(states, false)), {}, ".");
  EXPECT_LT(review.alignment.offset.norm(), 0.01);
}

TEST(Review, HeightsThatCannotBeToldAreCorrectedAndSaid) {
  Plan plan = wave_plan();
  plan.geodetic_origin = GeodeticOrigin{kWaveLatitude, kWaveLongitude, 0, HeightOf::ground};
  const auto states = recorded(ideal_flight(plan, 20), {.clock = 30});
  for (const bool offset : {true, false}) {
    const FlightReview review = review_flight(plan, read_by("ulog", ulog_of(states)),
                                              {.clock = {}, .estimate_offset = offset}, ".");
    EXPECT_NEAR(review.alignment.offset.z(), -kWaveHeight, 0.1);
    EXPECT_LT(worst_of(review, "distance"), 0.05);
    EXPECT_TRUE(says(alignment_sentences(review), "does not tell what its heights count from"));
    EXPECT_FALSE(says(advice_of(plan, review), "from the plan throughout"));
  }
}

TEST(Review, ThePageAndTheDocumentHoldIt) {
  const Plan plan = wave_plan();
  const auto states = recorded(simulated_flight(plan, windy()), {.clock = 30});
  const FlightReview review = review_flight(plan, read_by("ulog", ulog_of(states)), {}, ".");
  const std::string page = render_html(review_report(plan, review, "."));
  for (const char* part : {"Log and plan brought together", "Path from above", "Behind the plan",
                           "Limits and task, as flown"})
    EXPECT_THAT(page, HasSubstr(part));
  const Value value = to_value(plan, review);
  EXPECT_NEAR(value.at("errors").at("distance").at("worst").as_number(),
              worst_of(review, "distance"), 1e-12);
  EXPECT_EQ(value.at("kept").as_boolean(), review.kept());
}

}  // namespace
}  // namespace lapwing
