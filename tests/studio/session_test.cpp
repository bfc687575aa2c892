// SPDX-License-Identifier: Apache-2.0
// Pages that edit one document: gestures, undo, what waits.
#include "tests/studio/session_fixture.h"

#include <algorithm>

namespace lapwing {
namespace {

TEST_F(Session, OnlyAGoodHelloIsWelcome) {
  for (const char* text :
       {R"({"type": "hello", "token": "secreT", "tab": "t", "seen": 0})",
        R"({"type": "hello", "token": "secret1", "tab": "t", "seen": 0})", R"({"type": "rest"})",
        R"({"type": "undo", "id": "u", "base": 0})", "nonsense", "{}", ""}) {
    auto page = std::make_shared<HeardPage>();
    session_->opened(page);
    say(*page, text);
    EXPECT_NE(page->closed, "") << text;
    EXPECT_TRUE(page->heard.empty()) << text;
  }
  const auto good = page();
  EXPECT_EQ(good->closed, "");
  const Value& welcome = good->last("welcome");
  EXPECT_TRUE(same_options(welcome.at("document"), options_));
  EXPECT_EQ(welcome.at("revision"), Value(0));
  EXPECT_EQ(welcome.at("mission").at("editable"), Value(true));
  EXPECT_EQ(to_json(welcome, -1).find("secret"), std::string::npos);
  // A second hello, and what cannot be read, once in.
  say(*good, "nonsense");
  EXPECT_EQ(good->heard.back().at("type"), Value("failed"));
  say(*good, R"({"type": "hello", "token": "secret", "tab": "t", "seen": 0})");
  EXPECT_NE(good->closed, "");
}

TEST_F(Session, AGestureIsCheckedJournalledAndToldToAll) {
  const auto a = page("a"), b = page("b");
  say(*a, gesture("g1", 0, {change("margin", 0.75)}));
  EXPECT_TRUE(a->of_type("document").empty());  // not before it holds
  check_all();
  for (const auto& each : {a, b}) {
    const Value& told = each->last("document");
    EXPECT_EQ(told.at("revision"), Value(1));
    EXPECT_EQ(told.at("by"), Value("g1"));
    EXPECT_EQ(to_json(told.at("patch"), -1), R"([{"path":"margin","value":0.75}])");
    EXPECT_EQ(told.at("can_undo"), Value(true));
  }
  // Again: told to whoever asks, and nothing changes.
  say(*b, gesture("g1", 0, {change("margin", 0.75)}));
  check_all();
  EXPECT_EQ(b->of_type("document").size(), 2u);
  EXPECT_EQ(b->last("document").at("patch"), Value::list());
  EXPECT_EQ(a->of_type("document").size(), 1u);
  EXPECT_EQ(session_->document()->revision(), 1u);
  // What the mission refuses leaves no trace.
  const std::string journal = read_file(folder_ / "shot.studio.journal");
  say(*a, gesture("g2", 1, {change("margin", -1)}));
  check_all();
  EXPECT_EQ(a->last("refused").at("id"), Value("g2"));
  EXPECT_EQ(a->last("refused").at("why"), Value("margin: expected at least 0 m"));
  EXPECT_EQ(read_file(folder_ / "shot.studio.journal"), journal);
  // One of an older revision is laid on top, or refused.
  say(*b, gesture("g3", 0, {change("weights.yaw", 2)}));
  say(*b, gesture("g4", 0, {change("margin", 2)}));
  check_all();
  EXPECT_EQ(session_->document()->revision(), 2u);
  EXPECT_EQ(b->last("refused").at("id"), Value("g4"));
  say(*a, R"({"type": "undo", "id": "u1", "base": 1})");
  check_all();
  EXPECT_EQ(a->last("refused").at("id"), Value("u1"));  // it would take another's back
  say(*a, R"({"type": "undo", "id": "u2", "base": 2})");
  check_all();
  EXPECT_EQ(session_->document()->current().at("weights").at("yaw").as_number(), 1);
  // All of it outlives the session, as do ids.
  open();
  EXPECT_EQ(session_->document()->revision(), 3u);
  const auto c = page("c");
  say(*c, gesture("g1", 0, {change("margin", 0.75)}));
  EXPECT_EQ(c->last("document").at("patch"), Value::list());
  say(*c, R"({"type": "redo", "id": "r1", "base": 3})");
  check_all();
  EXPECT_EQ(session_->document()->current().at("weights").at("yaw").as_number(), 2);
}

TEST_F(Session, GesturesThatComeTogetherAreTakenInOrder) {
  const auto a = page("a");
  for (int i = 0; i < 5; ++i)
    say(*a, gesture("g" + std::to_string(i), 0, {change("keyframes[1].time", i + 1)}));
  EXPECT_EQ(checker_.frames.size(), 1u);  // each on what the one before left
  check_all();
  EXPECT_EQ(session_->document()->revision(), 1u);
  EXPECT_EQ(a->of_type("refused").size(), 4u);
  for (int i = 0; i < 5; ++i)
    say(*a,
        gesture("h" + std::to_string(i), 1, {change(i % 2 ? "margin" : "weights.yaw", 1.0 + i)}));
  check_all();
  EXPECT_EQ(session_->document()->revision(), 3u);
}

TEST_F(Session, SoManyEditsMayWaitAndNoMore) {
  const auto a = page("a"), b = page("b");
  const auto edit = [&](HeardPage& page, int number) {
    say(page, gesture("g" + std::to_string(number), session_->document()->revision(),
                      {change("margin", 1.0)}));
  };
  edit(*a, 0);
  check_all();
  for (int i = 1; i <= 64; ++i) edit(*(i % 2 ? a : b), i);
  EXPECT_TRUE(a->of_type("refused").empty());
  EXPECT_TRUE(b->of_type("refused").empty());
  edit(*a, 65);
  say(*b, R"({"type": "undo", "id": "u", "base": 1})");
  ASSERT_EQ(a->of_type("refused").size(), 1u);
  EXPECT_EQ(a->last("refused").at("id"), Value("g65"));
  EXPECT_NE(a->last("refused").at("why").as_text().find("64 edits"), std::string::npos);
  ASSERT_EQ(b->of_type("refused").size(), 1u);
  EXPECT_EQ(b->last("refused").at("id"), Value("u"));
  // What was applied, or waits, is not refused where it is said again.
  const std::size_t heard = b->of_type("document").size();
  edit(*b, 0);
  EXPECT_EQ(b->of_type("document").size(), heard + 1);
  EXPECT_EQ(b->last("document").at("by"), Value("g0"));
  edit(*b, 1);
  EXPECT_EQ(b->of_type("refused").size(), 1u);
  check_all();
  const auto told = b->of_type("document");
  EXPECT_TRUE(std::any_of(told.begin(), told.end(),
                          [](const Value& m) { return m.at("by") == Value("g1"); }));
  // There is room again.
  say(*a, R"({"type": "undo", "id": "v", "base": 1})");
  check_all();
  EXPECT_EQ(session_->document()->revision(), 2u);
}

TEST_F(Session, SoManyBytesOfEditsMayWaitAndNoMore) {
  const auto a = page("a");
  const auto edit = [&](int number) {
    std::string text = to_json(gesture("g" + std::to_string(number),
                                       session_->document()->revision(), {change("margin", 1.0)}),
                               -1);
    text.resize(std::size_t{1} << 20, ' ');
    say(*a, text);
  };
  for (int i = 0; i < 8; ++i) edit(i);
  EXPECT_TRUE(a->of_type("refused").empty());
  edit(8);
  ASSERT_EQ(a->of_type("refused").size(), 1u);
  EXPECT_EQ(a->last("refused").at("id"), Value("g8"));
  EXPECT_NE(a->last("refused").at("why").as_text().find("8 MiB"), std::string::npos);
  check_all();
  const std::size_t refused = a->of_type("refused").size();
  edit(9);
  check_all();
  EXPECT_EQ(a->of_type("refused").size(), refused);
}

TEST_F(Session, AGestureIsSolvedWhileItIsCheckedAndToldAfterwards) {
  const auto a = page("a");
  solver_.frames.clear();
  say(*a, gesture("g1", 0, {change("margin", 0.75)}));
  ASSERT_EQ(solver_.frames.size(), 1u);
  solve(solver_.frames[0], "step");
  solve(solver_.frames[0], "converged");
  EXPECT_TRUE(a->of_type("answer").empty());
  check_all();
  EXPECT_EQ(solver_.frames.size(), 1u);  // not once more
  ASSERT_EQ(a->of_type("answer").size(), 2u);
  EXPECT_EQ(a->last("answer").at("revision"), Value(1));
  solve(solver_.frames[0], "certified");
  EXPECT_EQ(a->last("answer").at("grade"), Value("certified"));
  // Refused: what was said of it is never told, and the document is solved again.
  say(*a, gesture("g2", 1, {change("margin", -1)}));
  solve(solver_.frames.back(), "certified");
  check_all();
  ASSERT_EQ(a->of_type("answer").size(), 4u);
  EXPECT_EQ(solver_.frames.back().header.at("do"), Value("begin_at"));
  EXPECT_EQ(to_json(a->last("answer").at("plan").at("of"), -1), R"({"margin":0.75})");
}

// Where there are two ways around an obstacle a solve may end on either side: what was shown once
// is shown again, and not solved.
TEST_F(Session, UndoRedoAndReloadShowTheVeryFlightAgain) {
  const auto a = page("a");
  const auto judge = [&](const std::string& plan) {
    Frame answer = solved(solver_.frames.back(), "certified");
    answer.parts = {plan, "{}", plan};
    session_->heard(WorkerRole::solver, answer);
  };
  const auto step = [&](const char* type, int id) {
    say(*a, std::string(R"({"type": ")") + type + R"(", "id": "s)" + std::to_string(id) +
                R"(", "base": )" + std::to_string(session_->document()->revision()) + "}");
    check_all();
  };
  judge(R"({"way": "left"})");
  say(*a, gesture("g", 0, {change("margin", 2)}));
  check_all();
  judge(R"({"way": "right"})");
  const std::size_t solves = solver_.frames.size();
  for (int i = 0; i < 4; ++i) {
    step(i % 2 ? "redo" : "undo", i);
    const Value& answer = a->last("answer");
    EXPECT_EQ(answer.at("revision"), Value(2 + i));
    EXPECT_EQ(answer.at("grade"), Value("certified"));
    EXPECT_EQ(answer.at("plan").at("way"), Value(i % 2 ? "right" : "left"));
    EXPECT_EQ(solver_.frames.back().header.at("do"), Value("begin_at"));
    EXPECT_EQ(to_json(page("b")->last("welcome").at("answer")), to_json(answer));
  }
  for (std::size_t i = solves; i < solver_.frames.size(); ++i)
    EXPECT_NE(solver_.frames[i].header.at("do"), Value("solve"));
  // It is what is flown and exported.
  say(*a, R"({"type": "export", "id": "e", "format": "csv"})");
  EXPECT_EQ(errands_.frames.back().parts.at(0), R"({"way": "right"})");
  // Another script may plan it otherwise.
  write_file_atomically(folder_ / "shot.lua", "return 2 ");
  loop_.after(std::chrono::milliseconds(20), [&] { loop_.stop(); });
  loop_.run();
  check_all();
  EXPECT_EQ(solver_.frames.back().header.at("do"), Value("solve"));
  judge(R"({"way": "third"})");
  step("undo", 9);
  EXPECT_EQ(solver_.frames.back().header.at("do"), Value("solve"));
}

TEST_F(Session, SoManyFlightsAreRememberedAndNoMore) {
  const auto a = page("a");
  solve(solver_.frames.back(), "certified");
  for (int i = 1; i <= 64; ++i) {
    say(*a, gesture("g" + std::to_string(i), i - 1, {change("margin", 1.0 + i)}));
    check_all();
    solve(solver_.frames.back(), "certified");
  }
  const auto undo = [&](int i) {
    say(*a, R"({"type": "undo", "id": "u)" + std::to_string(i) + R"(", "base": )" +
                std::to_string(session_->document()->revision()) + "}");
    check_all();
    return solver_.frames.back().header.at("do");
  };
  for (int i = 0; i < 63; ++i) EXPECT_EQ(undo(i), Value("begin_at")) << i;
  EXPECT_EQ(undo(63), Value("solve"));  // the first of 65
}

TEST_F(Session, EditsMadeOnTopOfEachOtherAreTakenInOrder) {
  const auto a = page("a"), b = page("b");
  const auto after = [](Value message, std::initializer_list<const char*> ids) {
    message.set("after", Value(Value::List(ids.begin(), ids.end())));
    return message;
  };
  // Pressed twice before the first is acknowledged.
  say(*a, gesture("g1", 0, {change("margin", 1)}));
  say(*a, after(gesture("g2", 0, {change("margin", 2)}), {"g1"}));
  check_all();
  EXPECT_TRUE(a->of_type("refused").empty());
  EXPECT_EQ(session_->document()->current().at("margin").as_number(), 2);
  // Another page's edit in between is not known to it.
  say(*a, gesture("g3", 2, {change("margin", 3)}));
  say(*b, gesture("h", 2, {change("weights.yaw", 9)}));
  say(*a, after(gesture("g4", 2, {change("weights.yaw", 4)}), {"g3"}));
  check_all();
  EXPECT_EQ(a->last("refused").at("id"), Value("g4"));
  // One that was made on top of a refused one is refused.
  say(*a, gesture("g5", 4, {change("margin", -1)}));
  say(*a, after(gesture("g6", 4, {change("weights.yaw", 5)}), {"g5"}));
  check_all();
  EXPECT_EQ(a->last("refused").at("id"), Value("g6"));
  EXPECT_EQ(session_->document()->revision(), 4u);
}

}  // namespace
}  // namespace lapwing
