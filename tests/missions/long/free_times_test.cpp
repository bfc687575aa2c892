// SPDX-License-Identifier: Apache-2.0
// Films of many keyframes whose times are free.
#include "tests/missions/flown_film.h"
#include "tests/missions/random_list.h"

namespace lapwing {
namespace {

class FreeTimes : public Filming {
 protected:
  Flown list(int count, int seed) {
    write_file_atomically(folder_ / "film.lua", random_list(count, seed));
    return fly((folder_ / "film.lua").string(), "", "out", 2);
  }
};

TEST_F(FreeTimes, FortyListsOfFiftyKeyframes) {
  for (int seed = 1; seed <= 40; ++seed) {
    const Flown flown = list(50, seed);
    EXPECT_EQ(flown.status, 0) << seed << to_json(flown.result);
    std::printf("seed %d: %.4g s of flight, solved in %.3g s\n", seed,
                flown.result.at("film").at("duration").as_number(),
                flown.result.at("seconds").at("solve").as_number());
  }
}

TEST_F(FreeTimes, TheCostIsLinearInTheNumberOfKeyframes) {
  for (const int count : {10, 20, 50, 100, 200}) {
    const Flown flown = list(count, 1);
    EXPECT_EQ(flown.status, 0) << count << to_json(flown.result);
    std::printf("%d keyframes: solved in %.3g s\n", count,
                flown.result.at("seconds").at("solve").as_number());
  }
}

// Designers' shots whose times are preferred, with weight `weight`, or free where it is 0. Their
// subjects keep their tracks.
class FreeShots : public DesignersShots {
 protected:
  // A script of the shot, or "" where the file has no local positions.
  static std::string script_of(int number, double weight) {
    char name[32];
    std::snprintf(name, sizeof name, "shot_%02d.json", number);
    const Value shot = from_json(read_file(fs::path(data_folder()) / "shots" / name), name);
    const auto& list = shot.at("keyFrameList").as_list();
    const auto& times = shot.at("keyframeTimes").as_list();
    if (list.size() < 2 || !list[0].find("lookFromNED") || !list[0].find("lookAtNED")) return "";
    const auto place = [](const Value& ned) {
      return "{ " + std::to_string(ned.at("e").as_number()) + ", " +
             std::to_string(ned.at("n").as_number()) + ", " +
             std::to_string(-ned.at("d").as_number()) + " }";
    };
    std::string keyframes, track;
    for (std::size_t k = 0; k < list.size(); ++k) {
      const std::string time = std::to_string(times[k].as_number());
      keyframes += "{ position = " + place(list[k].at("lookFromNED"));
      if (k > 0 && weight > 0)
        keyframes += ", time = " + time + ", time_weight = " + std::to_string(weight);
      keyframes += " }, ";
      track += "{ time = " + time + ", position = " + place(list[k].at("lookAtNED")) + " }, ";
    }
    const double end = 10 * times.back().as_number() + 100;  // later than any film
    track += "{ time = " + std::to_string(end) +
             ", position = " + place(list.back().at("lookAtNED")) + " }";
    return "return require 'mission.film'.shot { name = 'shot', timing = 'free', subject = "
           "{ track = { " +
           track + " } }, keyframes = { " + keyframes + "} }";
  }
  Flown fly_free(int number, double weight, const std::string& more = "") {
    write_file_atomically(folder_ / "film.lua", script_of(number, weight));
    return fly((folder_ / "film.lua").string(), more, "out", 1);
  }
};

TEST_F(FreeShots, TimesFoundWithTheCameraNeverCostMore) {
  std::printf("shot weight  apart  together   flight  solved in\n");
  int better = 0, kept = 0;
  for (const double weight : {0.5, 0.0})
    for (int number = 1; number <= 32; ++number) {
      if (script_of(number, weight).empty()) continue;
      SCOPED_TRACE(number);
      const Flown flown = fly_free(number, weight);
      if (flown.status != 0) continue;  // the film itself is not certified at any times
      const Value& film = flown.result.at("film");
      if (!film.find("cost_together")) {
        ++kept;
        continue;
      }
      const double apart = film.at("cost_apart").as_number();
      const double together = film.at("cost_together").as_number();
      (together <= apart * (1 + 1e-6) ? better : kept) += 1;
      std::printf("%4d %6g %10.5g %10.5g %7.4g s %7.3g s\n", number, weight, apart, together,
                  film.at("duration").as_number(),
                  flown.result.at("seconds").at("solve").as_number());
      const std::string notes = to_json(flown.result);
      EXPECT_EQ(together > apart * (1 + 1e-6),
                notes.find("the times are those found without the camera") != std::string::npos);
    }
  std::printf("%d at times found with the camera, %d at those found without\n", better, kept);
  EXPECT_GT(better, 10);
}

TEST_F(FreeShots, SolversAgree) {
  for (const int number : {3, 12, 30}) {
    const Flown iqp = fly_free(number, 0.5), ipopt = fly_free(number, 0.5, "--set solver=ipopt");
    ASSERT_EQ(iqp.status, 0);
    ASSERT_EQ(ipopt.status, 0);
    const auto cost = [](const Flown& flown) {
      return flown.result.at("film").at("cost_together").as_number();
    };
    EXPECT_NEAR(cost(iqp), cost(ipopt), 2e-3 * cost(iqp)) << number;
  }
}

}  // namespace
}  // namespace lapwing
