// Films whose path is kept and whose times are found.
#include "tests/missions/flown_film.h"

namespace lapwing {
namespace {

class TimedFilms : public Filming {
 protected:
  static std::string film(const std::string& second = "", const std::string& more = "") {
    return R"(return require "mission.film".shot {
      name = "timed", vehicle = "vehicles/solo", timing = "path_first",
      keyframes = { { position = {0, 0, 3} }, { position = {14, 2, 5})" +
           second + R"( }, { position = {20, 14, 4} } }, )" + more + "}";
  }
  Flown timed(const std::string& text, const std::string& more = "", const char* name = "out") {
    write_file_atomically(folder_ / "film.lua", text);
    return fly((folder_ / "film.lua").string(), more, name);
  }
  static double second_time(const Flown& flown) {
    return read_plan(flown.folder / "plan.json").task.keyframes.at(1).time;
  }
};

TEST_F(TimedFilms, AreFasterOnTheSamePath) {
  const Flown own = timed(film(), "--set timing=given", "own");
  const Flown fast = timed(film(), "", "fast");
  ASSERT_EQ(own.status, 0);
  ASSERT_EQ(fast.status, 0) << to_json(fast.result);
  const Plan slow_plan = read_plan(own.folder / "plan.json");
  const Plan fast_plan = read_plan(fast.folder / "plan.json");
  EXPECT_LT(fast_plan.trajectory.duration(), 0.75 * slow_plan.trajectory.duration());
  Points path;
  for (const Sample& s : slow_plan.trajectory.samples) path.push_back(s.position);
  for (const Sample& s : fast_plan.trajectory.samples)
    EXPECT_LT(distance_to({path}, s.position), 0.26) << s.time;
  EXPECT_LE(fast.result.at("film").at("path_error").as_number(), 0.25);
}

TEST_F(TimedFilms, WishesAreGranted) {
  const Flown free = timed(film());
  ASSERT_EQ(free.status, 0) << to_json(free.result);
  const double fastest = second_time(free);
  const auto asked = [&](const std::string& wish) {
    const Flown flown = timed(film(wish));
    EXPECT_EQ(flown.status, 0) << wish << to_json(flown.result);
    return second_time(flown);
  };
  EXPECT_NEAR(asked(", time = 9"), 9, 1e-9);
  const double window = asked(", earliest = 8, latest = 12");
  EXPECT_NEAR(window, 8, 0.06);
  EXPECT_NEAR(asked(", latest = 30"), fastest, 0.1) << "a window that asks for nothing";
  const double preferred = asked(", time = 9, time_weight = 0.2");
  EXPECT_GT(preferred, fastest + 0.1);
  EXPECT_LT(preferred, 9);
  EXPECT_GT(asked(", time = 9, time_weight = 50"), preferred);
}

}  // namespace
}  // namespace lapwing
