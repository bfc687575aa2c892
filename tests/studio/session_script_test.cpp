// SPDX-License-Identifier: Apache-2.0
// The script and the layer of edits beside a session: what changes on disk, what can be edited.
#include "tests/studio/session_fixture.h"

namespace lapwing {
namespace {

TEST_F(Session, ModulesOfTheScriptAreWatched) {
  write_file_atomically(folder_ / "part.lua", "return 1");
  const auto glance = [&] {
    loop_.after(std::chrono::milliseconds(20), [&] { loop_.stop(); });
    loop_.run();
  };
  const auto a = page("a");
  glance();
  EXPECT_TRUE(checker_.frames.empty());
  // A check tells what the script required; from then on the file counts.
  write_file_atomically(folder_ / "shot.lua", "return require 'part'");
  glance();
  Frame answer = checked(checker_.frames.front());
  checker_.frames.clear();
  answer.header.set("files", Value(Value::List{(folder_ / "part.lua").string()}));
  session_->heard(WorkerRole::checker, answer);
  check_all();
  glance();
  EXPECT_TRUE(checker_.frames.empty());
  write_file_atomically(folder_ / "part.lua", "return 2 ");
  glance();
  ASSERT_EQ(checker_.frames.size(), 1u);
  // A module that fails: it stays watched.
  fail_script("part.lua:1: no", 0);
  write_file_atomically(folder_ / "part.lua", "return 3  ");
  glance();
  EXPECT_EQ(checker_.frames.size(), 1u);
}

TEST_F(Session, DataFilesOfTheMissionAreWatched) {
  const fs::path data = folder_ / "course.yaml";
  write_file_atomically(data, "gates: 1");
  const auto glance = [&] {
    loop_.after(std::chrono::milliseconds(20), [&] { loop_.stop(); });
    loop_.run();
  };
  const auto a = page("a");
  const auto answer = [&](const char* grade, const Value::List& reads) {
    Frame frame;
    frame.header.set("said", "answer");
    frame.header.set("serial", solver_.frames.back().header.at("serial"));
    frame.header.set("grade", grade);
    frame.header.set("message", "");
    frame.header.set("reads", Value(reads));
    frame.parts = {"null", "null", ""};
    session_->heard(WorkerRole::solver, frame);
  };
  answer("certified", {data.string()});
  glance();
  EXPECT_TRUE(checker_.frames.empty()) << "it is as it was when the mission read it";
  const std::size_t solved = solver_.frames.size();
  write_file_atomically(data, "gates: 22");
  glance();
  ASSERT_EQ(checker_.frames.size(), 1u);
  check_all();
  EXPECT_EQ(solver_.frames.size(), solved + 1) << "the same options are solved anew";
  EXPECT_EQ(a->of_type("script_changed").size(), 0u);
  // A mission that fails before it has read all of them leaves them watched.
  answer("refused", {});
  write_file_atomically(data, "gates: 333");
  glance();
  EXPECT_EQ(checker_.frames.size(), 1u);
  check_all();
  // One that reads it no more does not.
  answer("certified", {});
  write_file_atomically(data, "gates: 4444");
  glance();
  EXPECT_TRUE(checker_.frames.empty());
}

TEST_F(Session, WhatTheCommandLineSetsIsTheFirstEdit) {
  const Value laid = without_origins(from_json(R"({"margin": 0.8})", "test"));
  open_unchecked("film", laid);
  check_all();
  const auto a = page("a");
  EXPECT_EQ(session_->document()->current().at("margin").as_number(), 0.8);
  EXPECT_EQ(session_->document()->undo_label(), "--config and --set");
  EXPECT_EQ(to_json(session_->document()->layer(), -1), R"({"margin":0.8})");
  // Said again it changes nothing.
  open_unchecked("film", laid);
  check_all();
  EXPECT_EQ(session_->document()->revision(), 1u);
  // What the mission refuses is told to every page, and the film can be edited.
  open_unchecked("film", without_origins(from_json(R"({"margin": -1})", "test")));
  check_all();
  const auto b = page("b");
  EXPECT_NE(b->last("remark").at("message").as_text().find("margin: expected at least 0 m"),
            std::string::npos);
  EXPECT_EQ(b->last("welcome").at("mission").at("editable"), Value(true));
  // Missions of other kinds are shown with it.
  fs::remove(folder_ / "shot.studio.journal");
  open_unchecked("race", laid);
  check_all();
  EXPECT_EQ(session_->document()->current().at("margin").as_number(), 0.8);
  EXPECT_EQ(to_json(solver_.frames.back().header.at("layer"), -1), R"({"margin":0.8})");
}

TEST_F(Session, PagesAreToldWhenNothingCanBeEditedAnyMore) {
  const auto a = page("a");
  kind_ = "map";
  write_file_atomically(folder_ / "shot.lua", "return 'map'");
  loop_.after(std::chrono::milliseconds(20), [&] { loop_.stop(); });
  loop_.run();
  check_all();
  ASSERT_EQ(a->of_type("mission").size(), 1u);
  EXPECT_EQ(a->last("mission").at("mission").at("editable"), Value(false));
  EXPECT_NE(a->last("mission").at("mission").at("why_not").as_text().find("map"),
            std::string::npos);
}

TEST_F(Session, MissionsOfOtherKindsAreEditedToo) {
  open("race");
  const auto a = page("a");
  EXPECT_EQ(a->last("welcome").at("mission").at("editable"), Value(true));
  solve(solver_.frames.back(), "certified");
  say(*a, gesture("g", 0, {change("margin", 3)}));
  check_all();
  EXPECT_EQ(session_->document()->revision(), 1u);
  EXPECT_EQ(to_json(solver_.frames.back().header.at("layer"), -1), R"({"margin":3})");
}

TEST_F(Session, AMapHasNoFlightToEdit) {
  open("map");
  const auto a = page("a");
  const Value& mission = a->last("welcome").at("mission");
  EXPECT_EQ(mission.at("editable"), Value(false));
  EXPECT_NE(mission.at("why_not").as_text().find("map"), std::string::npos);
  say(*a, gesture("g", 0, {change("margin", 3)}));
  EXPECT_EQ(a->last("refused").at("id"), Value("g"));
  say(*a, preview(1, {change("margin", 3)}));
  EXPECT_EQ(a->last("refused").at("edit"), Value(1));
}

TEST_F(Session, AnEditedLayerIsAnEdit) {
  const auto a = page("a");
  say(*a, gesture("g", 0, {change("margin", 3)}));
  check_all();
  session_->finish();
  write_file_atomically(folder_ / "shot.studio.yaml", "margin: 3\nweights: {yaw: 7}\n");
  open();
  EXPECT_EQ(session_->document()->revision(), 2u);
  EXPECT_EQ(session_->document()->current().at("weights").at("yaw").as_number(), 7);
  EXPECT_NE(session_->document()->undo_label().find("shot.studio.yaml"), std::string::npos);
}

// A layer that cannot be read, or that the mission refuses, is for its writer to mend.
TEST_F(Session, ADamagedLayerStaysAsItIs) {
  const fs::path file = folder_ / "shot.studio.yaml";
  for (const std::string text : {"margin: [3\nweights: {yaw: 7}\n", "margin: -1\n", "- 3\n"}) {
    write_file_atomically(file, text);
    open();
    const auto a = page("a");
    const Value& mission = a->last("welcome").at("mission");
    EXPECT_EQ(mission.at("editable"), Value(false)) << text;
    const Value& why = mission.at("why_not");
    EXPECT_NE(why.as_text().find("shot.studio.yaml"), std::string::npos) << why.as_text();
    say(*a, R"({"type": "save_report", "id": "s"})");
    ASSERT_EQ(a->of_type("failed").size(), 1u) << text;
    EXPECT_EQ(a->last("failed").at("id"), Value("s"));
    EXPECT_EQ(a->last("failed").at("why"), why);
    EXPECT_TRUE(errands_.frames.empty());
    say(*a, gesture("g", 0, {change("margin", 3)}));
    check_all();
    EXPECT_EQ(a->last("refused").at("id"), Value("g"));
    session_->finish();
    EXPECT_EQ(read_file(file), text);
  }
  // One who edits before the layer was judged: nothing is written over it either.
  write_file_atomically(file, "margin: -1\n");
  open_unchecked();
  check_one();
  const auto b = page("b");
  say(*b, gesture("early", 0, {change("margin", 3)}));
  check_all();
  EXPECT_EQ(b->last("refused").at("id"), Value("early"));
  EXPECT_EQ(session_->document()->revision(), 0u);
  session_->finish();
  EXPECT_EQ(read_file(file), "margin: -1\n");
  // Mended, it is an edit.
  write_file_atomically(file, "margin: 1\n");
  open();
  EXPECT_EQ(session_->document()->current().at("margin").as_number(), 1);
}

}  // namespace
}  // namespace lapwing
