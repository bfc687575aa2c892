// SPDX-License-Identifier: Apache-2.0
// A session with workers that answer when and as a test says.
#pragma once

#include "framework/studio/session.h"

#include <unistd.h>

#include "framework/core/files.h"
#include "framework/core/json.h"
#include "tests/studio/page_client.h"

namespace lapwing {

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

inline const char* const kScript = R"({"margin": 0.5, "weights": {"yaw": 1},
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

  // The script of the question that waits fails so.
  void fail_script(const std::string& why, int line) {
    Frame broken;
    broken.header.set("said", "refused");
    broken.header.set("serial", checker_.frames.front().header.at("serial"));
    broken.header.set("why", why);
    broken.header.set("line", line);
    broken.header.set("files", Value::list());
    checker_.frames.clear();
    session_->heard(WorkerRole::checker, broken);
  }

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

}  // namespace lapwing
