// SPDX-License-Identifier: Apache-2.0
// A session with workers that answer when and as a test says.
#include "framework/studio/session.h"

#include <unistd.h>

#include <algorithm>
#include <random>

#include "framework/core/files.h"
#include "framework/core/json.h"
#include "tests/studio/page_client.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

class WaitingWorker final : public Worker {
 public:
  void send(Frame frame) override { frames.push_back(std::move(frame)); }
  std::deque<Frame> frames;
};

class HeardPage final : public PageSocket {
 public:
  void send(std::shared_ptr<const std::string> text, bool) override {
    heard.push_back(without_origins(from_json(*text, "server")));
  }
  void close(const std::string& why) override { closed = why; }
  std::vector<Value> of_type(const std::string& type) const {
    std::vector<Value> found;
    for (const Value& message : heard)
      if (message.at("type") == Value(type)) found.push_back(message);
    return found;
  }
  const Value& last(const std::string& type) const {
    for (auto at = heard.rbegin(); at != heard.rend(); ++at)
      if (at->at("type") == Value(type)) return *at;
    throw Error("never heard " + type);
  }
  std::vector<Value> heard;
  std::string closed;
};

const char* const kScript = R"({"margin": 0.5, "weights": {"yaw": 1},
  "keyframes": [{"time": 0, "position": [0, 0, 2]}, {"time": 5, "position": [4, 0, 2]}]})";

class Session : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("lapwing_session_" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    write_file_atomically(folder_ / "shot.lua", "return 1");
    options_ = without_origins(from_json(kScript, "test"));
    open();
  }
  void TearDown() override {
    session_.reset();
    fs::remove_all(folder_);
  }

  void open(const std::string& kind = "film") {
    open_unchecked(kind);
    check_all();
  }
  void open_unchecked(const std::string& kind = "film", Value laid = Value::map()) {
    session_.reset();
    for (WaitingWorker* worker : {&solver_, &checker_, &errands_}) worker->frames.clear();
    SessionSettings settings;
    settings.script = folder_ / "shot.lua";
    settings.token = "secret";
    settings.run_words = {"lapwing", "run", "shot.lua"};
    settings.laid = std::move(laid);
    settings.glance = std::chrono::milliseconds(1);
    session_ = std::make_unique<StudioSession>(
        loop_, settings, std::make_unique<Journal>(folder_ / "shot.studio.journal"), "");
    session_->begin(solver_, checker_, errands_);
    kind_ = kind;
  }
  std::shared_ptr<HeardPage> page(const std::string& tab = "tab") {
    auto made = std::make_shared<HeardPage>();
    session_->opened(made);
    say(*made, R"({"type": "hello", "token": "secret", "tab": ")" + tab + R"(", "seen": 0})");
    return made;
  }
  void say(HeardPage& page, const std::string& text) { session_->received(page, text); }
  void say(HeardPage& page, const char* text) { session_->received(page, text); }
  void say(HeardPage& page, const Value& message) { say(page, to_json(message, -1)); }

  // The mission accepts every configuration, or says why not.
  Frame checked(const Frame& asked) const {
    Frame answer;
    answer.header.set("serial", asked.header.at("serial"));
    Value document = options_;
    if (asked.header.at("do") == Value("describe")) {
      answer.header.set("said", "described");
      answer.header.set("schema", Value::map());
      answer.header.set("choices", Value::map());
      return answer;
    }
    merge(document, asked.header.at("layer"));
    if (document.at("margin").as_number() < 0) {
      answer.header.set("said", "refused");
      answer.header.set("why", "margin: expected at least 0 m");
      answer.header.set("line", 0);
      return answer;
    }
    answer.header.set("said", "checked");
    answer.header.set("document", document);
    Value mission = Value::map();
    mission.set("name", "shot");
    mission.set("kind", kind_);
    answer.header.set("mission", mission);
    return answer;
  }
  void check_one() {
    const Frame asked = std::move(checker_.frames.front());
    checker_.frames.pop_front();
    session_->heard(WorkerRole::checker, checked(asked));
  }
  void check_all() {
    while (!checker_.frames.empty()) check_one();
  }
  // An answer that names the layer that it is about.
  static Frame solved(const Frame& asked, const std::string& grade) {
    Frame answer;
    answer.header.set("said", "answer");
    answer.header.set("serial", asked.header.at("serial"));
    answer.header.set("grade", grade);
    answer.header.set("message", "");
    const std::string plan = "{\"of\": " + to_json(asked.header.at("layer"), -1) + "}";
    const bool judged = grade == "certified" || grade == "rejected";
    answer.parts = {plan, judged ? plan : "", grade == "step" ? "" : plan};
    return answer;
  }
  void solve(const Frame& asked, const std::string& grade) {
    session_->heard(WorkerRole::solver, solved(asked, grade));
  }

  fs::path folder_;
  EventLoop loop_;
  Value options_;
  std::string kind_;
  WaitingWorker solver_, checker_, errands_;
  std::unique_ptr<StudioSession> session_;
};

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

// A drag is solved from the last point, a document from the beginning.
TEST_F(Session, TheCertificateOfADragIsNotTheDocuments) {
  const auto a = page("a");
  EXPECT_EQ(solver_.frames.back().header.at("settled"), Value(true));
  say(*a, preview(1, {change("margin", 2)}));
  EXPECT_EQ(solver_.frames.back().header.at("settled"), Value(false));
  solve(solver_.frames.back(), "certified");
  say(*a, gesture("g", 0, {change("margin", 2)}));
  check_all();
  EXPECT_EQ(solver_.frames.back().header.at("do"), Value("solve"));
  EXPECT_EQ(solver_.frames.back().header.at("settled"), Value(true));
  EXPECT_TRUE(page("b")->last("welcome").at("answer").is_null());
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

TEST_F(Session, TheEndOfAnErrorIsToldAndAnAnswerIsNone) {
  const auto a = page("a");
  const auto glance_at = [&](const char* text) {
    write_file_atomically(folder_ / "shot.lua", text);
    loop_.after(std::chrono::milliseconds(20), [&] { loop_.stop(); });
    loop_.run();
    ASSERT_FALSE(checker_.frames.empty());
  };
  glance_at("return");
  Frame broken;
  broken.header.set("said", "refused");
  broken.header.set("serial", checker_.frames.front().header.at("serial"));
  broken.header.set("why", "shot.lua:1: no mission");
  broken.header.set("line", 1);
  broken.header.set("files", Value::list());
  checker_.frames.clear();
  session_->heard(WorkerRole::checker, broken);
  EXPECT_EQ(a->last("script_error").at("line"), Value(1));
  say(*a, preview(1, {change("margin", 2)}));
  solve(solver_.frames.back(), "step");
  EXPECT_TRUE(a->of_type("script_loaded").empty());
  glance_at("return 3  ");
  check_all();
  EXPECT_EQ(a->of_type("script_loaded").size(), 1u);
}

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
  Frame broken;
  broken.header.set("said", "refused");
  broken.header.set("serial", checker_.frames.front().header.at("serial"));
  broken.header.set("why", "part.lua:1: no");
  broken.header.set("line", 0);
  broken.header.set("files", Value::list());
  checker_.frames.clear();
  session_->heard(WorkerRole::checker, broken);
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

// Answers of a slow machine: they come late, twice, and in any order. Whatever is told as certified
// is about the layer of that revision, or of that preview, and no grade of an edit falls.
TEST_F(Session, ACertificateIsNeverOfAnotherRevision) {
  std::mt19937 random(3);
  const auto a = page("a"), b = page("b");
  std::map<std::int64_t, std::string> layer_of_revision{{0, "{}"}};
  std::map<std::int64_t, std::string> layer_of_edit;
  std::vector<Frame> posted;
  int edit = 0, certified = 0;
  for (int k = 0; k < 3000; ++k) {
    HeardPage& page = random() % 2 ? *a : *b;
    const double value = static_cast<double>(random() % 64) / 8;
    const auto revision = static_cast<std::int64_t>(session_->document()->revision());
    switch (random() % 8) {
      case 0:
        say(page, gesture("g" + std::to_string(k), revision, {change("margin", value - 1)}));
        break;
      case 1: {
        const StudioDocument& document = *session_->document();
        layer_of_edit[++edit] =
            to_json(layer_of(document.script(),
                             document.proposed(Patch{{option_path("weights.yaw"), Value(value)}})),
                    -1);
        say(page, preview(edit, {change("weights.yaw", value)}));
        break;
      }
      case 2:
        say(page, R"({"type": "rest"})");
        break;
      case 3:
        say(page, std::string(R"({"type": ")") + (random() % 2 ? "undo" : "redo") +
                      R"(", "id": "u)" + std::to_string(k) + R"(", "base": )" +
                      std::to_string(revision) + "}");
        break;
      case 4:
        if (!checker_.frames.empty()) check_one();
        break;
      default:
        break;
    }
    layer_of_revision[static_cast<std::int64_t>(session_->document()->revision())] =
        to_json(session_->document()->layer(), -1);
    for (; !solver_.frames.empty(); solver_.frames.pop_front())
      if (solver_.frames.front().header.at("do") == Value("solve"))
        posted.push_back(solver_.frames.front());
    for (auto n = random() % 3; n > 0 && !posted.empty(); --n) {
      const std::size_t recent = std::min<std::size_t>(posted.size(), 3);
      const Frame& asked = posted[posted.size() - 1 - random() % recent];
      const char* grades[] = {"step", "converged", "certified", "rejected", "step"};
      solve(asked, grades[random() % 5]);
    }
  }
  std::map<std::string, int> rank_of_subject;
  for (const Value& answer : a->of_type("answer")) {
    const std::string& grade = answer.at("grade").as_text();
    const std::string of = to_json(answer.at("plan").at("of"), -1);
    if (answer.at("edit").is_null()) {
      ASSERT_EQ(of, layer_of_revision.at(answer.at("revision").as_integer()));
    } else {
      ASSERT_EQ(of, layer_of_edit.at(answer.at("edit").as_integer()));
    }
    if (grade == "certified" || grade == "rejected")
      ASSERT_EQ(to_json(answer.at("certificate").at("of"), -1), of);
    else
      ASSERT_TRUE(answer.at("certificate").is_null());
    certified += grade == "certified";
  }
  EXPECT_GT(certified, 50);
  EXPECT_GT(session_->document()->revision(), 100u);
  // After what was told last, a late answer of something else changes nothing.
  check_all();
  const std::size_t told = a->heard.size();
  for (std::size_t i = 0; i + 2 < posted.size(); ++i) solve(posted[i], "certified");
  EXPECT_EQ(a->heard.size(), told);
}

TEST_F(Session, AWelcomeHasTheAnswerOfTheDocumentAlone) {
  const auto a = page("a");
  solve(solver_.frames.back(), "certified");
  EXPECT_EQ(page("b")->last("welcome").at("answer").at("grade"), Value("certified"));
  say(*a, preview(1, {change("margin", 2)}));
  solve(solver_.frames.back(), "certified");
  EXPECT_EQ(to_json(page("c")->last("welcome").at("answer").at("plan").at("of"), -1), "{}");
  say(*a, gesture("g", 0, {change("margin", 3)}));
  check_all();
  EXPECT_TRUE(page("d")->last("welcome").at("answer").is_null());
}

TEST_F(Session, AfterADragThatWasDroppedTheDocumentsAnswerStandsAgain) {
  const auto a = page("a");
  solve(solver_.frames.back(), "certified");
  say(*a, preview(1, {change("margin", 2)}));
  const Frame dragged = solver_.frames.back();
  say(*a, R"({"type": "rest"})");
  ASSERT_GE(solver_.frames.size(), 2u);
  EXPECT_EQ(solver_.frames[solver_.frames.size() - 2].header.at("do"), Value("drop"));
  // The next drag begins at what is shown.
  EXPECT_EQ(solver_.frames.back().header.at("do"), Value("begin_at"));
  EXPECT_EQ(solver_.frames.back().parts.at(0), R"({"of": {}})");
  const Value& again = a->last("answer");
  EXPECT_TRUE(again.at("edit").is_null());
  EXPECT_EQ(again.at("grade"), Value("certified"));
  const std::size_t told = a->heard.size();
  solve(dragged, "certified");
  EXPECT_EQ(a->heard.size(), told);
  // The next gesture is solved as ever.
  say(*a, gesture("g", 0, {change("margin", 3)}));
  check_all();
  solve(solver_.frames.back(), "certified");
  EXPECT_EQ(a->last("answer").at("revision"), Value(1));
}

TEST_F(Session, QuickMovesAreDrawnAllTheSame) {
  const auto a = page("a");
  solver_.frames.clear();
  for (int i = 1; i <= 10; ++i) say(*a, preview(i, {change("margin", i)}));
  ASSERT_EQ(solver_.frames.size(), 1u);  // else each would end the one before
  solve(solver_.frames[0], "step");
  EXPECT_EQ(a->last("answer").at("edit"), Value(1));
  ASSERT_EQ(solver_.frames.size(), 2u);  // the newest alone
  solve(solver_.frames[0], "converged");
  solve(solver_.frames[1], "step");
  EXPECT_EQ(a->last("answer").at("edit"), Value(10));
  // One that has been drawn is ended at once, and so is one by a gesture.
  say(*a, preview(11, {change("margin", 11)}));
  EXPECT_EQ(solver_.frames.size(), 3u);
  say(*a, preview(12, {change("margin", 12)}));
  say(*a, gesture("g", 0, {change("margin", 13)}));
  check_all();
  EXPECT_EQ(solver_.frames.size(), 4u);
  solve(solver_.frames[2], "step");
  solve(solver_.frames[3], "step");
  EXPECT_EQ(solver_.frames.size(), 4u);
  EXPECT_EQ(a->last("answer").at("revision"), Value(1));
}

TEST_F(Session, ACrashCostsOneSolve) {
  const auto a = page("a");
  say(*a, gesture("g", 0, {change("margin", 3)}));
  check_all();
  const Frame asked = solver_.frames.back();
  session_->crashed(WorkerRole::solver, "plugin 'x' crashed");
  EXPECT_EQ(a->last("worker").at("state"), Value("crashed"));
  EXPECT_EQ(a->last("worker").at("message"), Value("plugin 'x' crashed"));
  session_->started(WorkerRole::solver);  // it is tried once more
  EXPECT_EQ(solver_.frames.back().header.at("serial"), asked.header.at("serial"));
  const std::size_t sent = solver_.frames.size();
  session_->crashed(WorkerRole::solver, "plugin 'x' crashed");
  session_->started(WorkerRole::solver);
  EXPECT_EQ(solver_.frames.size(), sent);  // and not for ever
  EXPECT_EQ(a->last("answer").at("grade"), Value("refused"));
  EXPECT_EQ(session_->document()->revision(), 1u);
  // A process that checks: the gesture waits for the next one.
  say(*a, gesture("h", 1, {change("margin", 4)}));
  checker_.frames.clear();
  session_->crashed(WorkerRole::checker, "killed");
  session_->started(WorkerRole::checker);
  check_all();
  EXPECT_EQ(session_->document()->revision(), 2u);
  say(*a, gesture("i", 2, {change("margin", 5)}));
  for (int i = 0; i < 2; ++i) {
    checker_.frames.clear();
    session_->crashed(WorkerRole::checker, "killed");
    session_->started(WorkerRole::checker);
  }
  EXPECT_EQ(a->last("refused").at("id"), Value("i"));
}

TEST_F(Session, ErrandsAreDoneInTurnAndNeedWhatTheyAreAbout) {
  const auto a = page("a");
  const std::string fly = R"({"type": "fly", "edit": 1, "wind": [3, 4, 0], "seed": 1})";
  say(*a, fly);
  EXPECT_NE(a->last("failed").at("why").as_text().find("no certified plan"), std::string::npos);
  solve(solver_.frames.back(), "rejected");
  say(*a, fly);
  EXPECT_EQ(a->of_type("failed").size(), 2u);
  // A certified preview is not the document's.
  say(*a, preview(1, {change("margin", 2)}));
  solve(solver_.frames.back(), "certified");
  say(*a, fly);
  EXPECT_EQ(a->of_type("failed").size(), 3u);
  say(*a, gesture("g", 0, {change("margin", 3)}));
  check_all();
  solve(solver_.frames.back(), "certified");
  say(*a, fly);
  ASSERT_EQ(errands_.frames.size(), 1u);
  EXPECT_EQ(errands_.frames[0].header.at("wind_mean").as_number(), 5);
  for (int i = 0; i < 5; ++i)
    say(*a, R"({"type": "picture", "edit": )" + std::to_string(i) +
                R"(, "time": 1, "width": 8, "height": 6})");
  EXPECT_EQ(errands_.frames.size(), 1u);
  Frame flown;
  flown.header.set("said", "done");
  flown.header.set("serial", errands_.frames[0].header.at("serial"));
  for (const char* key : {"lost", "finished", "kept", "worst"}) flown.header.set(key, false);
  flown.parts = {"{}"};
  session_->heard(WorkerRole::errands, flown);
  EXPECT_EQ(a->last("flown").at("edit"), Value(1));
  ASSERT_EQ(errands_.frames.size(), 2u);  // the newest picture alone
  Frame drawn;
  drawn.header.set("said", "done");
  drawn.header.set("serial", errands_.frames[1].header.at("serial"));
  drawn.parts = {"\x89PNG..."};
  session_->heard(WorkerRole::errands, drawn);
  EXPECT_EQ(a->last("picture").at("edit"), Value(4));
  EXPECT_EQ(*session_->blob(a->last("picture").at("blob").as_text()), "\x89PNG...");
  // Whoever left is not answered, and who stays is.
  say(*a, R"({"type": "export_lua", "id": "l"})");
  session_->closed(*a);
  const auto b = page("b");
  say(*b, R"({"type": "export_lua", "id": "m"})");
  Frame done;
  done.header.set("said", "failed");
  done.header.set("why", "no");
  done.header.set("serial", errands_.frames[2].header.at("serial"));
  session_->heard(WorkerRole::errands, done);
  EXPECT_TRUE(b->of_type("failed").empty());
  done.header.set("serial", errands_.frames[3].header.at("serial"));
  session_->heard(WorkerRole::errands, done);
  EXPECT_EQ(b->last("failed").at("id"), Value("m"));
}

TEST_F(Session, SoManyErrandsMayWaitAndNoMore) {
  const auto a = page("a"), b = page("b");
  const auto ask = [&](HeardPage& page, int number) {
    say(page, R"({"type": "export_lua", "id": "l)" + std::to_string(number) + R"("})");
  };
  for (int i = 0; i < 32; ++i) ask(*(i % 2 ? a : b), i);
  EXPECT_TRUE(a->of_type("failed").empty());
  EXPECT_TRUE(b->of_type("failed").empty());
  ask(*a, 32);
  EXPECT_EQ(a->last("failed").at("id"), Value("l32"));
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

// Of the newest solve of the document alone, until it has an answer.
TEST_F(Session, ProgressIsOfTheDocument) {
  const auto a = page("a");
  const auto planned = [&](const Frame& solve) {
    Frame frame;
    frame.header.set("said", "progress");
    frame.header.set("serial", solve.header.at("serial"));
    frame.header.set("phase", "path");
    frame.header.set("fraction", 0.25);
    frame.header.set("left", Value());
    session_->heard(WorkerRole::solver, std::move(frame));
  };
  const Frame first = solver_.frames.back();
  planned(first);
  ASSERT_EQ(a->of_type("progress").size(), 1u);
  const Value& told = a->last("progress");
  EXPECT_EQ(told.at("revision"), Value(0));
  EXPECT_EQ(told.at("phase"), Value("path"));
  EXPECT_EQ(told.at("fraction"), Value(0.25));
  EXPECT_TRUE(told.at("left").is_null());
  say(*a, gesture("g", 0, {change("margin", 3)}));
  planned(first);
  planned(solver_.frames.back());  // it has no revision before it is checked
  EXPECT_EQ(a->of_type("progress").size(), 1u);
  check_all();
  planned(solver_.frames.back());
  EXPECT_EQ(a->last("progress").at("revision"), Value(1));
  solve(solver_.frames.back(), "certified");
  planned(solver_.frames.back());
  EXPECT_EQ(a->of_type("progress").size(), 2u);
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

// Images of an exploration: told once the edit has its revision, also to a page that comes later,
// and never of a solve that has ended.
TEST_F(Session, ImagesAreToldInOrderAndPlanningCanWait) {
  open("explore");
  const auto a = page("a");
  const auto taken = [&](const Frame& solve, int image) {
    Frame frame;
    frame.header.set("said", "image");
    frame.header.set("serial", solve.header.at("serial"));
    frame.parts = {"{\"image\":" + std::to_string(image) + "}", "WLV1"};
    session_->heard(WorkerRole::solver, std::move(frame));
  };
  say(*a, gesture("g", 0, {change("margin", 3)}));
  const Frame solving = solver_.frames.back();
  taken(solving, 1);
  EXPECT_TRUE(a->of_type("image").empty());  // it has no revision before it is checked
  check_all();
  ASSERT_EQ(a->of_type("image").size(), 1u);
  EXPECT_EQ(a->last("image").at("revision"), Value(1));
  EXPECT_TRUE(session_->blob(a->last("image").at("sights").as_text()));
  say(*a, R"({"type": "pace", "pace": "pause"})");
  EXPECT_EQ(a->last("pace").at("paused"), Value(true));
  EXPECT_EQ(solver_.frames.back().header.at("do"), Value("pace"));
  EXPECT_EQ(solver_.frames.back().header.at("paused"), Value(true));
  say(*a, R"({"type": "pace", "pace": "step"})");
  EXPECT_EQ(solver_.frames.back().header.at("step"), Value(true));
  taken(solving, 2);
  const auto b = page("b");
  EXPECT_EQ(b->of_type("image").size(), 2u);
  EXPECT_EQ(b->last("pace").at("paused"), Value(true));
  // Nobody is left who could go on.
  session_->closed(*a);
  EXPECT_EQ(solver_.frames.back().header.at("step"), Value(true));
  session_->closed(*b);
  EXPECT_EQ(solver_.frames.back().header.at("paused"), Value(false));
  solve(solving, "certified");
  const auto c = page("c");
  taken(solving, 3);
  say(*c, R"({"type": "pace", "pace": "pause"})");
  EXPECT_TRUE(c->of_type("image").empty());
  EXPECT_TRUE(c->of_type("pace").empty());
  // A process that crashed takes its images again, and does not wait.
  say(*c, gesture("h", 1, {change("margin", 4)}));
  const Frame again = solver_.frames.back();
  check_all();
  taken(again, 1);
  say(*c, R"({"type": "pace", "pace": "pause"})");
  EXPECT_EQ(c->last("pace").at("paused"), Value(true));
  session_->crashed(WorkerRole::solver, "killed");
  session_->started(WorkerRole::solver);
  EXPECT_EQ(c->last("pace").at("paused"), Value(false));
  EXPECT_TRUE(page("d")->of_type("image").empty());
}

TEST_F(Session, OnlyAnExplorationCanBePaused) {
  open("scan");
  const auto a = page("a");
  say(*a, R"({"type": "pace", "pace": "pause"})");
  EXPECT_EQ(a->last("refused").at("why"),
            Value("only the planning of an exploration can be paused"));
  EXPECT_TRUE(a->of_type("pace").empty());
}

}  // namespace
}  // namespace lapwing
