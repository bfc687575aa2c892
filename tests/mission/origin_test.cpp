// SPDX-License-Identifier: Apache-2.0
// The origin of a mission: stated once for every kind, kept in its plan.
#include <gmock/gmock.h>

#include "tests/mission/mission_fixture.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

class Origins : public MissionTest {
 protected:
  std::string refusal(const std::string& text, const std::vector<std::string>& overrides = {}) {
    try {
      const auto mission = load(text);
      mission->configure({}, overrides);
      mission->judge();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

constexpr const char* kPlace =
    "origin = { latitude_deg = 46.5, longitude_deg = 6.6, height = 2, height_of = 'ground' }";

TEST_F(Origins, PlansOfEveryKindHaveTheirs) {
  const std::string place = kPlace;
  for (const std::string& text :
       {kFilm + place + " }",
        "return require 'mission.race'.course { start = {0, 0, 2}, gates = { { shape = 'ball', "
        "radius = 1, position = {8, 4, 2} } }, closed_loop = 'reported', " +
            place + " }",
        "return require 'mission.light_painting'.text { text = 'i', " + place + " }"}) {
    const auto mission = load(text);
    mission->configure({}, {});
    const Plan plan = mission->plan().plan;
    ASSERT_TRUE(plan.geodetic_origin) << text;
    EXPECT_EQ(*plan.geodetic_origin, (GeodeticOrigin{46.5, 6.6, 2, HeightOf::ground})) << text;
  }
  const auto mission = load(std::string(kFilm) + "}");
  mission->configure({}, {});
  EXPECT_FALSE(mission->plan().plan.geodetic_origin);
}

TEST_F(Origins, BadOnesAreRefusedByFileAndKeyBeforePlanning) {
  const std::string film = kFilm;
  const auto with = [&](const std::string& origin) { return film + "origin = {" + origin + "} }"; };
  EXPECT_THAT(refusal(with("latitude_deg = 46.5, longitude_deg = 6.6, height = 2")),
              HasSubstr("shot.lua:8: origin.height_of: expected ellipsoid, sea or ground"));
  EXPECT_THAT(refusal(with("latitude_deg = 46.5, height = 2, height_of = 'ground'")),
              HasSubstr("shot.lua:8: origin: longitude_deg missing"));
  EXPECT_THAT(refusal(with("height_of = 'ground'")),
              HasSubstr("origin: latitude_deg, longitude_deg, height missing"));
  EXPECT_THAT(
      refusal(with("latitude_deg = 0, longitude_deg = 0, height = 2, height_of = 'ground'")),
      HasSubstr("shot.lua:8: origin.latitude_deg: 0, 0 lies in the Gulf of Guinea"));
  EXPECT_THAT(refusal(film + kPlace + "}", {"origin.height=9999"}),
              HasSubstr("--set origin.height=9999: origin.height: expected m above the ground"));
  EXPECT_THAT(refusal(film + kPlace + "}", {"origin.height_of=AMSL"}),
              HasSubstr("expected one of ellipsoid, sea, ground, got 'AMSL'"));
  EXPECT_THAT(refusal(film + kPlace + "}", {"origin.latitude_deg=nan"}),
              HasSubstr("origin.latitude_deg: 'nan' is not a quantity"));
}

TEST_F(Origins, TheBaseOfADrawingIsNotOne) {
  EXPECT_THAT(refusal("return require 'mission.light_painting'.text { text = 'i', "
                      "origin = {0, 0, 2} }"),
              HasSubstr("shot.lua:1: origin: the place of a drawing is `base`"));
}

TEST_F(Origins, AShotFileWithAnOriginTakesNoOther) {
  write_file_atomically(folder_ / "shot.json", R"({
    "keyframeTimes": [0, 8], "refLLH": {"lat": 47.0, "lng": 8.0, "altitude": 400},
    "keyFrameList": [{"lookFromNED": {"n": 0, "e": 0, "d": -5}},
                     {"lookFromNED": {"n": 0, "e": 12, "d": -8}}]})");
  EXPECT_THAT(refusal(std::string("return require('mission.film').from_file { "
                                  "file = 'shot.json', ") +
                      kPlace + " }"),
              HasSubstr("origin: the shot file states the origin of its world"));
}

}  // namespace
}  // namespace lapwing
