// SPDX-License-Identifier: Apache-2.0
// srt and edl: what is in the shot when.
#include <gmock/gmock.h>

#include <regex>

#include "tests/plugins/exporters/placed_plan.h"

namespace lapwing {
namespace {

using testing::HasSubstr;
using testing::Not;

// 10 s with a camera that looks east and, from 5 s on, west; "east" and "west" stand there.
Plan two_ways() {
  Plan plan = planned_camera();
  plan.trajectory.samples.clear();
  for (int i = 0; i <= 100; ++i) {
    Sample s;
    s.time = 0.1 * i;
    s.position = {0, 0, 5};
    s.yaw = i < 50 ? 0 : M_PI;
    plan.trajectory.samples.push_back(s);
  }
  for (const double x : {20.0, -20.0}) {
    Subject subject;
    subject.name = x > 0 ? "e<i>ast --> {1}" : "west\nÜ";
    subject.times = {0};
    subject.positions = {{x, 0, 5}};
    plan.environment.subjects.push_back(subject);
  }
  return plan;
}

struct Entry {
  double from, to;
  std::string text;
};
std::vector<Entry> entries_in(const std::string& text) {
  const std::string time = "(\\d\\d):(\\d\\d):(\\d\\d),(\\d\\d\\d)";
  const std::regex entry("(\\d+)\n" + time + " --> " + time + "\n([^\n]+)\n([^\n]+)\n");
  std::vector<Entry> entries;
  for (std::sregex_iterator found(text.begin(), text.end(), entry), end; found != end; ++found) {
    const auto seconds = [&](int k) {
      return std::stod((*found)[k]) * 3600 + std::stod((*found)[k + 1]) * 60 +
             std::stod((*found)[k + 2]) + std::stod((*found)[k + 3]) / 1000;
    };
    EXPECT_EQ((*found)[1], std::to_string(entries.size() + 1));
    entries.push_back({seconds(2), seconds(6), (*found)[10]});
  }
  return entries;
}

TEST(Srt, SaysWhoIsInTheShot) {
  Plan plan = two_ways();
  plan.cuts = {{7, 8}};
  const auto entries = entries_in(exporter_named("srt", with("every", 100))->write(plan));
  ASSERT_EQ(entries.size(), 4u);  // the camera turns between 4.9 s and 5 s
  EXPECT_EQ(entries[0].text,
            "in the shot: e\xe2\x80\xb9i\xe2\x80\xba"
            "ast --\xe2\x80\xba (1)");
  EXPECT_EQ(entries[0].from, 0);
  EXPECT_NEAR(entries[0].to, 4.95, 0.06);
  EXPECT_EQ(entries[1].text, "in the shot: west Ü");
  EXPECT_EQ(entries[2].text, "cut; in the shot: west Ü");
  EXPECT_EQ(entries[2].from, 7);
  EXPECT_EQ(entries[2].to, 8);
  EXPECT_EQ(entries[3].to, 10);
  for (std::size_t i = 1; i < entries.size(); ++i) EXPECT_EQ(entries[i].from, entries[i - 1].to);
  EXPECT_GE(entries_in(exporter_named("srt")->write(plan)).size(), 10u);
}

TEST(Srt, SaysImagesGatesAndLights) {
  Plan plan = two_ways();
  plan.environment.subjects.clear();
  plan.lights = {{1, 2}};
  GateTask gate;
  gate.name = "north";
  gate.radius = 1;
  gate.position = plan.trajectory.samples[40].position;
  for (std::size_t i = 0; i < plan.trajectory.samples.size(); ++i)
    plan.trajectory.samples[i].position.x() = 0.5 * std::abs(static_cast<double>(i) - 40);
  plan.task.gates.push_back(gate);
  plan.task.scan.emplace();
  plan.task.scan->views.push_back({3, {}, 0, 0});
  const auto entries = entries_in(exporter_named("srt", with("every", 100))->write(plan));
  const auto at = [&](double time) {
    for (const Entry& entry : entries)
      if (entry.from <= time && time < entry.to) return entry.text;
    return std::string("none");
  };
  EXPECT_EQ(at(0.5), "flight");
  EXPECT_EQ(at(1.5), "light on");
  EXPECT_EQ(at(3.1), "image 1");
  EXPECT_EQ(at(4.1), "gate 1: north");
}

TEST(Srt, SaysThatAPlanIsNotCertified) {
  Plan plan = two_ways();
  EXPECT_THAT(exporter_named("srt")->write(plan), HasSubstr("\nnot certified\n\n"));
  plan.certificate = with("feasible", true);
  EXPECT_THAT(exporter_named("srt")->write(plan), Not(HasSubstr("not certified")));
}

TEST(Edl, KeepsWhatIsNotCut) {
  Plan plan = two_ways();
  plan.cuts = {{2, 3}};
  plan.environment.subjects.pop_back();
  const auto exporter = exporter_named("edl", with("frame_rate", 25));
  const std::string text = exporter->write(plan);
  EXPECT_THAT(text, HasSubstr("TITLE: A & B <\"_bersicht\"> (not certified)\n"
                              "FCM: NON-DROP FRAME\n\n"
                              "001  AX       V     C        "
                              "00:00:00:00 00:00:02:00 01:00:00:00 01:00:02:00\n"));
  EXPECT_THAT(text, HasSubstr("002  AX       V     C        00:00:03:00 00:00:04:"));
  EXPECT_THAT(text, HasSubstr(" 01:00:02:00 01:00:03:"));
  EXPECT_THAT(text, HasSubstr("* COMMENT: in the shot: e<i>ast"));
  EXPECT_THAT(text, HasSubstr("* COMMENT: nobody in the shot"));
  for (const char c : text) EXPECT_TRUE(c == '\n' || (c >= 0x20 && c < 0x7f));
  const auto said = exporter->losses(plan, text);
  EXPECT_TRUE(says(said, "3 events at 25 frames/s keep 9 s of 10 s"));
  std::string moved = text;
  moved.replace(moved.find("00:00:02:00"), 11, "00:00:02:20");
  EXPECT_TRUE(says(exporter->losses(plan, moved), "0.2 s from those of the plan"));
}

TEST(ShotFormats, RefuseWhatTheyCannotHold) {
  for (const char* format : {"srt", "edl"}) {
    const auto exporter = exporter_named(format);
    Plan still = two_ways();
    still.trajectory.samples.resize(1);
    EXPECT_THAT(refusal_of(*exporter, still), HasSubstr("has no length"));
    Plan endless = two_ways();
    endless.trajectory.samples.back().time = std::nan("");
    EXPECT_THAT(refusal_of(*exporter, endless), HasSubstr("increasing times"));
  }
  Plan race = two_ways();
  race.trajectory.has_gimbal = false;
  EXPECT_THAT(refusal_of(*exporter_named("edl"), race), HasSubstr("without a camera"));
  EXPECT_EQ(refusal_of(*exporter_named("srt"), race), "");
  Plan many = two_ways();
  for (int i = 0; i < 1200; ++i) many.cuts.push_back({0.008 * i, 0.008 * i + 0.004});
  EXPECT_THAT(refusal_of(*exporter_named("edl", with("frame_rate", 99)), many),
              testing::AnyOf(HasSubstr("the format numbers 999"), std::string()));
}

}  // namespace
}  // namespace lapwing
