// SPDX-License-Identifier: Apache-2.0
// The program beside its script: what it opens, what it follows, what is in the way of starting.
#include "tests/studio/program_fixture.h"

namespace lapwing {
namespace {

TEST_F(StudioProgram, ModulesBesideTheScriptAreFollowed) {
  write_file_atomically(folder_ / "places.lua", "return { {-10, 0, 5}, {10, 0, 5} }\n");
  write_file_atomically(folder_ / "shot.lua",
                        R"(local film, places = require "mission.film", require "places"
return film.shot { keyframes = { { time = 0, position = places[1], yaw_deg = 0 },
                                 { time = 10, position = places[2] } } })");
  script_ = "shot.lua";
  PageClient page(serve(), "a");
  page.until_judged(0);
  write_file_atomically(folder_ / "places.lua", "return { {-10, 0, 5}, {10, 4, 5} }\n");
  const Value told = page.until_type("document");
  EXPECT_EQ(to_json(told.at("patch"), -1),
            R"([{"path":"keyframes[2].position","value":[10.0,4.0,5.0]}])");
  write_file_atomically(folder_ / "places.lua", "return {\n");
  EXPECT_NE(page.until_type("script_error").at("message").as_text().find("places.lua"),
            std::string::npos);
  write_file_atomically(folder_ / "places.lua", "return { {-10, 0, 5}, {10, 4, 5} }\n");
  page.until_type("script_loaded");
}

TEST_F(StudioProgram, FollowsItsScriptWithAndWithoutEdits) {
  use("filming/castle_flyover.lua");
  PageClient page(serve(), "a");
  page.until_judged(0);
  const std::string text = read_file(folder_ / script_);
  const auto write = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    ASSERT_NE(changed.find(from), std::string::npos);
    changed.replace(changed.find(from), from.size(), to);
    write_file_atomically(folder_ / script_, changed);
  };
  const auto resolve = [&](const char* take) {
    Value message = page_says("resolve_script");
    message.set("take", take);
    page.send(message);
    return page.until_type("document");
  };
  write("radius = 5", "radius = 4");  // without edits the document follows
  const Value followed = page.until_type("document");
  EXPECT_EQ(to_json(followed.at("patch"), -1), R"([{"path":"obstacles[1].radius","value":4.0}])");
  write("radius = 5", "radius = (4");  // an error: told with its line, and the document stays
  const Value error = page.until_type("script_error");
  EXPECT_EQ(error.at("line"), Value(16)) << to_json(error);
  write("radius = 5", "radius = 4");
  page.until_type("answer");
  page.send(gesture("g", 1, {change("keyframes[2].position", place(0, -4, 14))}));
  page.until_judged(2);
  write("radius = 5", "radius = 3");
  EXPECT_EQ(page.until_type("script_changed").at("conflict"), Value(false));
  const Value both = resolve("both");
  EXPECT_EQ(to_json(both.at("patch"), -1), R"([{"path":"obstacles[1].radius","value":3.0}])");
  write("{  0, -2, 14}", "{  0, -3, 14}");
  EXPECT_EQ(page.until_type("script_changed").at("conflict"), Value(true));
  const Value theirs = resolve("theirs");
  EXPECT_EQ(theirs.at("revision"), Value(4));
  page.send_text(R"({"type": "undo", "id": "u", "base": 4})");  // the edit is back, on their script
  EXPECT_EQ(to_json(page.until_type("document").at("patch"), -1),
            R"([{"path":"keyframes[2].position","value":[0.0,-4.0,14.0]},)"
            R"({"path":"obstacles[1].radius","value":3.0}])");
  EXPECT_EQ(page.until_judged(5).at("grade"), Value("certified"));
  server_->end(SIGTERM);
  // Changed while nobody looked: asked for when it is opened.
  write("{ 18,  4,  5}", "{ 18,  6,  5}");
  PageClient again(serve(), "b");
  EXPECT_EQ(again.welcome.at("revision"), Value(5));
  EXPECT_EQ(again.until_type("script_changed").at("conflict"), Value(true));
  again.send_text(R"({"type": "resolve_script", "take": "mine"})");
  again.until_type("document");
  EXPECT_EQ(again.until_judged(6).at("grade"), Value("certified"));
  again.send_text(R"({"type": "resolve_script", "take": "mine"})");
  EXPECT_EQ(again.until_type("refused").at("id"), Value("resolve_script"));
}

TEST_F(StudioProgram, OpensAScriptWithAnErrorAndFollowsIt) {
  use("filming/castle_flyover.lua");
  const std::string text = read_file(folder_ / script_);
  write_file_atomically(folder_ / script_, "local film = require \"mission.film\"\nreturn {\n");
  PageClient page(serve(), "a");
  EXPECT_TRUE(page.welcome.at("document").is_null());
  const Value error = page.until_type("script_error");
  EXPECT_GT(error.at("line").as_integer(), 0) << to_json(error);
  page.send(gesture("g", 0, {change("margin", 1)}));
  EXPECT_EQ(page.until_type("refused").at("id"), Value("g"));
  write_file_atomically(folder_ / script_, text);
  const Value welcome = page.until_type("welcome");
  EXPECT_EQ(welcome.at("document").at("keyframes").as_list().size(), 3u);
  EXPECT_EQ(page.until_judged(0).at("grade"), Value("certified"));
}

TEST_F(StudioProgram, OpensOtherMissionsAndFilmsOfSeveralProblems) {
  use("racing/seven_gates.lua");
  {
    PageClient page(serve(), "a");
    EXPECT_EQ(page.welcome.at("mission").at("editable"), Value(true));
    const Value answer = page.until_judged(0);
    EXPECT_EQ(answer.at("grade"), Value("certified")) << answer.at("message").as_text();
    EXPECT_EQ(answer.at("plan").at("gates").as_list().size(), 7u);
    // A drag has no answer of its own; what it ends with is planned.
    page.send(preview(1, {change("gates[7].position", place(-3, 6, 1.5))}));
    page.send(gesture("g", 0, {change("gates[7].position", place(-3, 6, 1.5))}));
    const Value moved = page.until_judged(1);
    EXPECT_EQ(moved.at("grade"), Value("certified")) << moved.at("message").as_text();
    EXPECT_EQ(moved.at("plan").at("gates").as_list()[6].at("position").as_list()[1], Value(6.0));
  }
  write_file_atomically(folder_ / "free.lua", R"(local film = require "mission.film"
return film.shot { timing = "free", subject = { position = {0, 0, 2}, height = 4 },
  keyframes = { { time = 0, position = {-18, -6, 3} }, { time = 10, position = {0, -12, 9} } } }
)");
  script_ = "free.lua";
  PageClient page(serve(), "a");
  EXPECT_EQ(page.welcome.at("mission").at("editable"), Value(true));
  EXPECT_EQ(page.until_judged(0).at("grade"), Value("certified"));
  page.send(gesture("g", 0, {change("keyframes[2].position", place(0, -11, 8))}));
  EXPECT_EQ(page.until_judged(1).at("grade"), Value("certified"));
}

TEST_F(StudioProgram, SaysWhatIsInTheWayOfStarting) {
  use("filming/castle_flyover.lua");
  const StudioAddress address = serve();
  write_file_atomically(folder_ / "other.lua", read_file(folder_ / script_));
  const auto fails = [&](std::vector<std::string> words, const std::string& why) {
    words.insert(words.begin(), {"studio", "--no-open"});
    EXPECT_EQ(run(words), 2);
    EXPECT_NE(errors_.find(why), std::string::npos) << errors_;
  };
  fails({"other.lua", "--assets", "page", "--port", std::to_string(address.port)}, "it is in use");
  fails({script_.string(), "--assets", "page"}, "another studio has this mission open");
  fails({"none.lua", "--assets", "page"}, "none.lua");
  fails({"other.lua", "--assets", "nowhere"}, "no index.html");
  fails({"page/index.html", "--assets", "page", "--port", "0"}, "--port");
  fails({"page/studio.js", "--assets", "page", "--data", "nowhere"}, "nowhere");
  fails({"other.lua", "--assets", "page", "--set", "margin=-1"}, "margin");
  fails({"other.lua", "--assets", "page", "--set", "sandbox.memory=9"}, "sandbox.memory");
  fails({"other.lua", "--assets", "page", "--config", "none"}, "none");
  // What the script may not read is no edit either.
  write_file_atomically(folder_ / "file.lua",
                        "return require('mission.film').from_file { input = 'own.json' }\n");
  const fs::path elsewhere = folder_.string() + "_elsewhere.json";
  write_file_atomically(elsewhere, "{}");
  fails({"file.lua", "--assets", "page", "--set", "input=" + elsewhere.string()}, "not found");
  fs::remove(elsewhere);
  EXPECT_FALSE(fs::exists(folder_ / "other.studio.journal"));
}

}  // namespace
}  // namespace lapwing
