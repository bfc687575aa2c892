// SPDX-License-Identifier: Apache-2.0
// Light paintings end to end: drawn within their tolerance, photographed, refused with a reason.
#include "tests/missions/flown_film.h"

namespace lapwing {
namespace {

class LightPainting : public Filming {
 protected:
  static double mean_error(const Flown& flown) {
    return flown.result.at("light_painting").at("mean_error").as_number();
  }
  Flown paint(const std::string& text, const std::string& more = "", const char* name = "out") {
    write_file_atomically(
        folder_ / "drawing.lua",
        "return require 'mission.light_painting'.text { name = 'drawing', " + text + " }");
    return fly((folder_ / "drawing.lua").string(), more, name);
  }
  std::string refused(const std::string& text) {
    write_file_atomically(
        folder_ / "drawing.lua",
        "return require 'mission.light_painting'.text { name = 'drawing', " + text + " }");
    const std::string command = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing run '" +
                                (folder_ / "drawing.lua").string() + "' --out '" +
                                (folder_ / "none").string() + "' > /dev/null 2> '" +
                                (folder_ / "stderr.txt").string() + "'";
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 2) << text;
    EXPECT_FALSE(fs::exists(folder_ / "none")) << text;
    return read_file(folder_ / "stderr.txt");
  }
};

TEST_F(LightPainting, HelloIsWrittenToTheMillimetre) {
  const Flown flown = fly("../light_painting/hello.lua");
  expect_certified(flown);
  EXPECT_LT(mean_error(flown), 0.005);
  EXPECT_EQ(read_file(flown.folder / "long_exposure.png").substr(1, 3), "PNG");
  EXPECT_NE(read_file(flown.folder / "report.html").find("Long exposure"), std::string::npos);
  const Plan plan = read_plan(flown.folder / "plan.json");
  EXPECT_EQ(plan.task.strokes.size(), 8u);  // H 3, E 2, L and L and O
  double top = 0;
  for (const Sample& sample : plan.trajectory.samples) top = std::max(top, sample.position.z());
  EXPECT_NEAR(top, 4, 0.05);
}

TEST_F(LightPainting, TheHeartOfAPictureIsDrawn) {
  const Flown flown = fly("../light_painting/svg_heart.lua");
  expect_certified(flown);
  EXPECT_LT(mean_error(flown), 0.005);
}

// With a gap it rests in the dark before each further stroke; facing the camera it looks back along
// the view. Neither costs accuracy.
TEST_F(LightPainting, GapsAndFacingAreKept) {
  const Flown plain = paint("text = 'TI'", "", "plain");
  const Flown flown =
      paint("text = 'TI', gap = 1, facing = 'camera', view_yaw_deg = 60", "", "gap");
  expect_certified(flown);
  EXPECT_LT(mean_error(flown), 0.005);
  const Plan plan = read_plan(flown.folder / "plan.json"),
             without = read_plan(plain.folder / "plan.json");
  ASSERT_EQ(plan.lights.size(), plan.task.strokes.size());
  for (std::size_t k = 1; k < plan.lights.size(); ++k)
    EXPECT_GE(plan.lights[k].start, plan.lights[k - 1].finish + 1 - 1e-6);
  for (const Sample& sample : plan.trajectory.samples)
    EXPECT_NEAR(std::cos(sample.yaw - (60 - 180) * EIGEN_PI / 180), 1, 1e-6);
  for (const Sample& sample : without.trajectory.samples) EXPECT_NEAR(sample.yaw, 0, 1e-6);
  EXPECT_NE(refused("text = 'TI', gap = -1").find("gap"), std::string::npos);
  EXPECT_NE(refused("text = 'TI', facing = 'up'").find("facing"), std::string::npos);
}

class SlowLightPainting : public LightPainting {};

// Fig. 3.8 B: with much weight on smoothness the letters are round, and the certificate says so.
TEST_F(SlowLightPainting, TooSmoothIsAMatterOfWeights) {
  const Flown smooth =
      fly("../light_painting/hello.lua", "--set weights.smoothness=1 --set tolerance=1");
  EXPECT_EQ(smooth.status, 0);
  EXPECT_GT(mean_error(smooth), 0.03);
  const Flown hurried =
      fly("../light_painting/hello.lua", "--set weights.smoothness=1 --set slowest=1", "hurried");
  EXPECT_EQ(hurried.status, 1);
  EXPECT_NE(hurried.result.at("notes").as_list().at(0).as_text().find("tolerance"),
            std::string::npos);
  // With a tolerance to keep, it is flown slower until it is kept.
  const Flown kept = fly("../light_painting/hello.lua", "--set weights.smoothness=0.1", "kept");
  expect_certified(kept);
  EXPECT_LE(mean_error(kept), 0.02);
  EXPECT_LT(kept.result.at("light_painting").at("speed_share").as_number(), 1);
}

TEST_F(LightPainting, TurnedRoundForItsSpectators) {
  const Flown flown = paint("text = 'L', view_yaw_deg = 0, base = {5, 1, 3}, height = 1");
  expect_certified(flown);
  // Looking east the letter's foot points south, to the right.
  const Points stroke = read_plan(flown.folder / "plan.json").task.strokes.at(0);
  double low = 1e9, y = 0;
  for (const auto& p : stroke)
    if (p.z() + p.y() < low) low = p.z() + p.y(), y = p.y();
  EXPECT_LT(y, 1);
  for (const auto& p : stroke) EXPECT_NEAR(p.x(), 5, 1e-9);
}

TEST_F(SlowLightPainting, SvgIsReadWhole) {
  // Every command once, relative and not, transforms, shapes, flags without blanks; 10 strokes.
  write_file_atomically(folder_ / "all.svg", R"svg(<?xml version="1.0"?><!DOCTYPE svg>
<svg><!-- <path d="M bad"/> --><defs><path d="M0,0 L9,9"/></defs>
<g transform="translate(10,20) scale(2)"><path transform='rotate(90)' d="M1 0L2,0"/></g>
<path d="M0 0H10V10h-5v-5l1,1z m20,0 C20,0 30,10 40,0S60,10,70,0 s5,5 10,0 Q90,10 95,0T110,0t5,0"/>
<path d="M0,50a5 5 0 1110-1A5,5,0,0,0,20,50"/>
<line x1="0" y1="70" x2="5" y2="70"/><polyline points="0,80 1,81 2,80"/>
<polygon points="0,90 5,90 5,95"/><rect x="20" y="90" width="4" height="3"/>
<circle cx="40" cy="90" r="3"/><ellipse cx="50" cy="90" rx="3" ry="2"/></svg>)svg");
  const Flown flown = paint("svg = 'all.svg', height = 10");
  expect_certified(flown);
  const Plan plan = read_plan(flown.folder / "plan.json");
  EXPECT_EQ(plan.task.strokes.size(), 10u);
  double left = 1e9, right = -1e9;
  for (const Points& stroke : plan.task.strokes)
    for (const auto& p : stroke) left = std::min(left, p.x()), right = std::max(right, p.x());
  // x goes from 0 to 115, y from 95 up to the crest of the curve s5,5 10,0, whose first control
  // point is mirrored: 3 (1 - t)^2 t (-10) + 3 (1 - t) t^2 5.
  double crest = 0;
  for (double t = 0; t <= 1; t += 1e-3)
    crest = std::min(crest, 3 * (1 - t) * t * (5 * t - 10 * (1 - t)));
  EXPECT_NEAR(right - left, 10 * 115 / (95 - crest), 0.02);
}

TEST_F(LightPainting, WhatCannotBeDrawnIsRefused) {
  EXPECT_NE(refused("text = 'a#b'").find("no glyph for '#'"), std::string::npos);
  EXPECT_NE(refused("text = '  '").find("nothing to draw"), std::string::npos);
  EXPECT_NE(refused("height = 2").find("give one of text, svg"), std::string::npos);
  EXPECT_NE(refused("text = 'A', svg = 'b.svg'").find("one of"), std::string::npos);
  EXPECT_NE(refused("svg = 'absent.svg'").find("absent.svg"), std::string::npos);
  write_file_atomically(folder_ / "none.svg", "<svg><text>A</text></svg>");
  EXPECT_NE(refused("svg = 'none.svg'").find("no path"), std::string::npos);
  write_file_atomically(folder_ / "bad.svg", "<svg><path d='M0,0 L nan,1'/></svg>");
  EXPECT_NE(refused("svg = 'bad.svg'").find("bad.svg: "), std::string::npos);
  write_file_atomically(folder_ / "huge.svg", "<svg><path d='M0,0 L1e300,1'/></svg>");
  EXPECT_NE(refused("svg = 'huge.svg'").find("too large"), std::string::npos);
  write_file_atomically(folder_ / "cut.svg", "<svg><path d='M0,0 L1,1'");
  EXPECT_NE(refused("svg = 'cut.svg'").find("ends within a tag"), std::string::npos);
}

}  // namespace
}  // namespace lapwing
