// SPDX-License-Identifier: Apache-2.0
// What a studio keeps when its server, a worker, a plugin or the disk fails; two tabs; how long an
// edit takes.
#include "tests/studio/program_fixture.h"

namespace lapwing {
namespace {

std::optional<Value> value_at(const Value& document, const std::string& path) {
  const OptionPath parsed = option_path(path);
  const Value* found = find_at(document, parsed, parsed.size());
  return found ? std::optional<Value>(*found) : std::nullopt;
}

// Pages of a studio that was killed find the next one, where the user's runtime folder is private.
TEST_F(StudioProgram, AfterAKillTheNextOneHasTheSameAddress) {
  use("filming/castle_flyover.lua");
  const fs::path runtime = folder_ / "runtime";
  fs::create_directory(runtime);
  fs::permissions(runtime, fs::perms::owner_all);
  ::setenv("XDG_RUNTIME_DIR", runtime.c_str(), 1);
  const StudioAddress first = serve();
  const fs::path kept = fs::directory_iterator(runtime)->path();
  EXPECT_EQ(fs::status(kept).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  server_->end(SIGKILL);
  const StudioAddress second = serve();
  EXPECT_EQ(second.port, first.port);
  EXPECT_EQ(second.token, first.token);
  PageClient(second, "a").until_judged(0);
  server_->end(SIGTERM);  // in order: the next one has another token
  EXPECT_TRUE(fs::is_empty(runtime));
  EXPECT_NE(serve().token, first.token);
  server_->end(SIGKILL);
  // What others could have written, and what is none, is not used.
  const auto with_file = [&](const std::string& text, fs::perms mode) {
    write_file_atomically(kept, text);
    fs::permissions(kept, mode);
    const std::string token = serve().token;
    server_->end(SIGKILL);
    return token;
  };
  const std::string token(32, 'a'),
      text = R"({"port": )" + std::to_string(first.port) + R"(, "token": ")" + token + R"("})";
  const fs::perms own = fs::perms::owner_read | fs::perms::owner_write;
  EXPECT_EQ(with_file(text, own), token);
  EXPECT_NE(with_file(text, own | fs::perms::others_write), token);
  EXPECT_NE(with_file(R"({"port": 1, "token": ""})", own), "");
  EXPECT_EQ(with_file("nonsense", own).size(), 32u);
  ::unsetenv("XDG_RUNTIME_DIR");
}

// Killed at random moments of a stream of edits: what was acknowledged is there, all of it can be
// taken back, and the layer is that of the journal.
TEST_F(StudioProgram, AKillOfTheServerLosesNoEditThatWasAcknowledged) {
  use("filming/castle_flyover.lua");
  std::mt19937 random(5);
  const int rounds = std::getenv("LAPWING_MANY_KILLS") ? 100 : 12;
  double margin = 0.5, slowest = 0;
  std::int64_t acknowledged = 0;
  for (int round = 0; round < rounds; ++round) {
    const auto began = std::chrono::steady_clock::now();
    std::optional<PageClient> page;
    page.emplace(serve(), "a");
    slowest = std::max(
        slowest, std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
    std::int64_t revision = page->welcome.at("revision").as_integer();
    ASSERT_GE(revision, acknowledged) << round;
    ASSERT_LE(revision, acknowledged + 1);  // one may have been written and not yet told
    const double now = value_at(page->welcome.at("document"), "margin")->as_number();
    ASSERT_TRUE(now == margin || (revision == acknowledged + 1 && now == margin + 0.001)) << now;
    margin = now;
    acknowledged = revision;
    // After none to four acknowledged edits, and a part of another.
    std::atomic<std::int64_t> told_of = 0;
    std::thread killer([&, edits = random() % 5, pause = random() % 100] {
      while (told_of < static_cast<std::int64_t>(edits))
        std::this_thread::sleep_for(milliseconds(1));
      std::this_thread::sleep_for(milliseconds(pause));
      ::kill(server_->process, SIGKILL);
    });
    for (;;) {
      const double next = margin + 0.001;
      page->send(gesture("g" + std::to_string(round) + "." + std::to_string(revision), revision,
                         {change("margin", next)}));
      Value told;
      do {
        told = page->receive();
      } while (!told.is_null() && told.at("type") != Value("document") &&
               told.at("type") != Value("refused"));
      if (told.is_null()) break;
      EXPECT_EQ(told.at("type"), Value("document")) << to_json(told);
      margin = next;
      acknowledged = ++revision;
      ++told_of;
    }
    killer.join();
    server_->end(SIGKILL);
  }
  EXPECT_GT(acknowledged, rounds);
  EXPECT_LT(slowest, 20) << "s until reconnected";  // 0.1 on an idle machine
  std::printf("%d kills of the server: %lld edits, at most %.2f s until connected again\n", rounds,
              static_cast<long long>(acknowledged), slowest);
  PageClient page(serve(), "a");
  std::int64_t revision = page.welcome.at("revision").as_integer();
  for (std::int64_t left = revision, end = revision; left > 0; --left) {
    page.send_text(R"({"type": "undo", "id": "u)" + std::to_string(left) + R"(", "base": )" +
                   std::to_string(end++) + "}");
    const Value told = page.until_type("document");
    ASSERT_EQ(told.at("can_undo"), Value(left > 1));
    revision = end;
  }
  EXPECT_EQ(page.until_judged(revision).at("grade"), Value("certified"));
  server_->end(SIGTERM);
  EXPECT_FALSE(fs::exists(folder_ / "castle_flyover.studio.yaml"));
}

TEST_F(StudioProgram, AKillOfAWorkerCostsASolveAndNothingElse) {
  use("filming/castle_flyover.lua");
  PageClient page(serve(), "a");
  page.until_judged(0);
  std::mt19937 random(6);
  const int rounds = std::getenv("LAPWING_MANY_KILLS") ? 100 : 12;
  std::int64_t revision = 0;
  int crashes = 0;
  for (int round = 0; round < rounds; ++round) {
    page.send(gesture("g" + std::to_string(round), revision,
                      {change("keyframes[2].position", place(0, -2.1 - 0.1 * round, 14))}));
    std::this_thread::sleep_for(milliseconds(random() % 150));
    const std::vector<pid_t> workers = server_->workers();
    if (workers.empty()) continue;
    ::kill(workers[random() % workers.size()], SIGKILL);
    const Value judged = page.until([&](const Value& m) {
      crashes += m.at("type") == Value("worker") && m.at("state") == Value("crashed");
      EXPECT_NE(m.at("type"), Value("refused")) << to_json(m);
      return m.at("type") == Value("answer") && m.at("revision") == Value(revision + 1) &&
             m.at("grade") == Value("certified");
    });
    ++revision;
    // Time between: many crashes in a short time are answered by a pause.
    std::this_thread::sleep_for(milliseconds(100));
  }
  EXPECT_GE(crashes, rounds / 2);
  EXPECT_EQ(revision, rounds);
}

// What a plugin breaks while its edit is solved costs that edit's answer.
TEST_F(StudioProgram, APluginThatCrashesCostsItsEdit) {
  use("filming/castle_flyover.lua");
  const std::string rogues = std::string(LAPWING_BUILD_DIR) + "/tests/plugin_fixtures/rogue";
  PageClient page(serve({"--plugin-path", rogues}), "a");
  page.until_judged(0);
  page.send_text(R"({"type": "gesture", "id": "g", "base": 0, "label": "", "patch": [{"path":
    "solver", "value": {"type": "rogue_solver", "where": "solve", "how": "crashes"}}]})");
  std::string why;
  const Value judged = page.until([&](const Value& m) {
    if (m.at("type") == Value("worker") && m.at("state") == Value("crashed"))
      why = m.at("message").as_text();
    return m.at("type") == Value("answer") && m.at("revision") == Value(1) &&
           m.at("grade") == Value("refused");
  });
  EXPECT_NE(why.find("rogue_solver"), std::string::npos) << why;
  page.send_text(R"({"type": "undo", "id": "u", "base": 1})");
  EXPECT_EQ(page.until_judged(2).at("grade"), Value("certified"));
}

TEST_F(StudioProgram, AFullDiskIsSaidAndNothingIsHalfWritten) {
  use("filming/castle_flyover.lua");
  PageClient page(serve(), "a");
  page.until_judged(0);
  page.send(gesture("g1", 0, {change("margin", 0.6)}));
  page.until_judged(1);
  const std::string before = journal();
  rlimit old{};
  const rlimit full{before.size() + 10, RLIM_INFINITY};
  ASSERT_EQ(::prlimit(server_->process, RLIMIT_FSIZE, &full, &old), 0);
  page.send(gesture("g2", 1, {change("margin", 0.7)}));
  const Value refused = page.until_type("refused");
  EXPECT_EQ(refused.at("id"), Value("g2"));
  EXPECT_NE(refused.at("why").as_text().find("nothing was changed"), std::string::npos);
  EXPECT_EQ(journal(), before);
  EXPECT_EQ(page.until_judged(1).at("grade"), Value("certified"));
  ASSERT_EQ(::prlimit(server_->process, RLIMIT_FSIZE, &old, nullptr), 0);
  page.send(gesture("g2", 1, {change("margin", 0.7)}));
  EXPECT_EQ(page.until_type("document").at("revision"), Value(2));
  server_->end(SIGTERM);
  ASSERT_EQ(run({"config", "castle_flyover.lua", "--config", "castle_flyover.studio.yaml"}), 0);
}

// ---- two tabs, and time -------------------------------------------------------------------------

struct EditingTab {
  EditingTab(const StudioAddress& address, const std::string& tab)
      : page(address, tab),
        document(page.welcome.at("document")),
        revision(page.welcome.at("revision").as_integer()) {}
  // Takes one message; false where none came for so long.
  bool hear(milliseconds patience) {
    const Value message = page.receive(patience);
    if (message.is_null()) return false;
    if (message.at("type") == Value("refused")) ++answered;
    if (message.at("type") != Value("document")) return true;
    apply_patch(document, patch_from(message.at("patch"), "patch"));
    revision = message.at("revision").as_integer();
    heard_at = std::chrono::steady_clock::now();
    const std::string& by = message.at("by").as_text();
    if (by.starts_with(own)) ++answered;
    return true;
  }
  PageClient page;
  Value document;
  std::int64_t revision;
  std::string own;
  int sent = 0, answered = 0;
  std::chrono::steady_clock::time_point heard_at;
};

TEST_F(StudioProgram, TwoTabsEndEqual) {
  use("filming/castle_flyover.lua");
  const StudioAddress address = serve();
  EditingTab tabs[2] = {{address, "a"}, {address, "b"}};
  tabs[0].own = "a";
  tabs[1].own = "b";
  std::mt19937 random(8);
  const int edits = std::getenv("LAPWING_MANY_KILLS") ? 1000 : 150;
  for (int k = 0; k < edits; ++k) {
    EditingTab& tab = tabs[random() % 2];
    const char* paths[] = {"margin", "weights.yaw", "weights.camera", "keyframes[2].position",
                           "obstacles[1].radius"};
    const std::string path = paths[random() % 5];
    const double number = 1 + static_cast<double>(random() % 100) / 50;
    tab.page.send(gesture(
        tab.own + std::to_string(k), tab.revision,
        {change(path, path.ends_with("position") ? place(number, -2, 14) : Value(number))}));
    ++tab.sent;
    for (EditingTab& each : tabs)
      while (each.sent - each.answered > 3) ASSERT_TRUE(each.hear(milliseconds(20000)));
  }
  for (EditingTab& each : tabs)
    while (each.answered < each.sent) ASSERT_TRUE(each.hear(milliseconds(20000)));
  // The newest revision reaches both.
  std::chrono::duration<double, std::milli> apart{0};
  while (tabs[0].revision != tabs[1].revision) {
    EditingTab& behind = tabs[0].revision < tabs[1].revision ? tabs[0] : tabs[1];
    ASSERT_TRUE(behind.hear(milliseconds(20000)));
    apart = tabs[0].heard_at - tabs[1].heard_at;
  }
  EXPECT_LT(std::abs(apart.count()), 100);
  EXPECT_TRUE(same_options(tabs[0].document, tabs[1].document));
  EXPECT_TRUE(same_options(PageClient(address, "c").welcome.at("document"), tabs[0].document));
  EXPECT_GT(tabs[0].revision, edits / 4);
}

double median(std::vector<double> numbers) {
  std::sort(numbers.begin(), numbers.end());
  return numbers[numbers.size() / 2];
}

// From a move of a keyframe to each grade, as the page would see it.
TEST_F(StudioProgram, TellsHowLongAnEditTakes) {
  use("filming/castle_flyover.lua");
  const auto began = std::chrono::steady_clock::now();
  const auto since = [](auto begin) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
        .count();
  };
  PageClient page(serve(), "a");
  page.until_judged(0);
  const double first = since(began);
  std::map<std::string, std::vector<double>> times;
  for (int k = 0; k < 20; ++k) {
    const auto sent = std::chrono::steady_clock::now();
    page.send(preview(k, {change("keyframes[2].position", place(0, -2 - 0.2 * (k % 7), 14))}));
    std::map<std::string, double> first_of;
    page.until([&](const Value& m) {
      if (m.at("type") != Value("answer") || m.at("edit") != Value(k)) return false;
      first_of.emplace(m.at("grade").as_text(), since(sent));
      first_of.emplace("any", since(sent));
      return m.at("grade") == Value("certified");
    });
    for (const auto& [grade, time] : first_of) times[grade].push_back(time);
  }
  std::printf("castle_flyover: certified %.0f ms after the command; after an edit (medians):",
              first);
  for (const auto& [grade, all] : times) std::printf(" %s %.0f ms,", grade.c_str(), median(all));
  std::printf(" of 20\n");
  EXPECT_EQ(times.at("certified").size(), 20u);
  EXPECT_LT(median(times.at("certified")), 2000);
}

}  // namespace
}  // namespace lapwing
