// SPDX-License-Identifier: Apache-2.0
// What a session tells of planning, checking and errands, and of processes that crash.
#include "tests/studio/session_fixture.h"

#include <algorithm>
#include <random>

namespace lapwing {
namespace {

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

TEST_F(Session, TheEndOfAnErrorIsToldAndAnAnswerIsNone) {
  const auto a = page("a");
  const auto glance_at = [&](const char* text) {
    write_file_atomically(folder_ / "shot.lua", text);
    loop_.after(std::chrono::milliseconds(20), [&] { loop_.stop(); });
    loop_.run();
    ASSERT_FALSE(checker_.frames.empty());
  };
  glance_at("return");
  fail_script("shot.lua:1: no mission", 1);
  EXPECT_EQ(a->last("script_error").at("line"), Value(1));
  say(*a, preview(1, {change("margin", 2)}));
  solve(solver_.frames.back(), "step");
  EXPECT_TRUE(a->of_type("script_loaded").empty());
  glance_at("return 3  ");
  check_all();
  EXPECT_EQ(a->of_type("script_loaded").size(), 1u);
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
