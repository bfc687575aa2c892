// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/worker.h"

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <deque>
#include <mutex>
#include <thread>

#include "framework/core/json.h"
#include "framework/mission/controller_source.h"
#include "framework/mission/mission_editor.h"
#include "framework/studio/plan_message.h"
#include "framework/studio/worker_errands.h"
#include "framework/studio/worker_link.h"
#include "framework/verify/verify.h"

namespace lapwing {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kBetweenSteps = std::chrono::milliseconds(40);

std::string all_failures(const Certificate& certificate) {
  std::string all;
  for (const Check& check : certificate.failures())
    all += (all.empty() ? "" : "; ") + to_line(check);
  return all;
}

class StudioWorker {
 public:
  StudioWorker(const std::filesystem::path& script, const MissionSettings& settings)
      : script_(script),
        settings_(settings),
        errands_(script, settings_),
        editor_(script, settings_, [this](const EditedPlan& edited) { hear(edited); }) {}

  void run() {
    std::thread reader([this] { read(); });
    while (std::optional<Frame> frame = next()) do_work(*frame);
    reader.join();
  }

 private:
  // On a thread of its own: what is newer ends what is under way.
  void read() {
    try {
      while (std::optional<Frame> frame = read_frame(STDIN_FILENO)) take(std::move(*frame));
    } catch (const std::exception&) {  // the server is no server any more
    }
    const std::lock_guard lock(mutex_);
    ended_ = true;
    end_solve();
    changed_.notify_all();
  }

  void take(Frame frame) {
    const std::string what = frame.header.at("do").as_text();
    const std::lock_guard lock(mutex_);
    if (what == "solve" || what == "drop") {
      end_solve();
      solve_.reset();
      if (what == "solve") solve_ = std::move(frame);
    } else {
      waiting_.push_back(std::move(frame));
    }
    changed_.notify_all();
  }

  void end_solve() {
    editor_.cancel();
    if (whole_) whole_->cancel();
  }

  std::optional<Frame> next() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return ended_ || solve_ || !waiting_.empty(); });
    if (ended_) return std::nullopt;
    if (!waiting_.empty()) {
      Frame frame = std::move(waiting_.front());
      waiting_.pop_front();
      return frame;
    }
    Frame frame = std::move(*solve_);
    solve_.reset();
    // With the lock: from here on `take` ends this one.
    serial_ = frame.header.at("serial").as_integer();
    whole_ = std::make_shared<CancellationToken>();
    if (kind_ == "film") edit(frame.header.at("layer"));
    return frame;
  }

  void edit(const Value& layer) { editor_.edit({{layer_of_page(layer, script_)}, {}}); }

  void do_work(const Frame& frame) {
    try {
      if (frame.header.at("do").as_text() == "solve")
        solve(frame);
      else
        send(errands_.answer(frame), frame.header.at("serial").as_integer());
    } catch (const Cancelled&) {
    } catch (const Error& error) {
      failed(frame, error.what());
    }
  }

  void failed(const Frame& frame, const std::string& why) {
    const std::int64_t serial = frame.header.at("serial").as_integer();
    if (frame.header.at("do").as_text() == "solve") return refuse(serial, why);
    Frame answer;
    answer.header.set("said", frame.header.at("do") == Value("check") ? "refused" : "failed");
    answer.header.set("why", as_utf8(why));
    answer.header.set("line", line_in(why, script_));
    send(std::move(answer), serial);
  }

  void refuse(std::int64_t serial, const std::string& why) {
    Frame answer;
    answer.header.set("said", "answer");
    answer.header.set("grade", to_string(AnswerGrade::refused));
    answer.header.set("message", as_utf8(why));
    send(std::move(answer), serial);
  }

  void send(Frame answer, std::int64_t serial) {
    answer.header.set("serial", serial);
    if (!write_frame(kWorkerOutput, answer)) ::_exit(0);  // nobody is left to tell
  }

  void solve(const Frame& frame) {
    const Value& layer = frame.header.at("layer");
    began_ = Clock::now();
    last_step_ = {};
    refused_.reset();
    if (kind_.empty()) {  // of the first one
      kind_ = Mission(script_, settings_).kind();
      if (kind_ == "film") {
        const std::lock_guard lock(mutex_);
        if (!solve_ && !whole_->cancelled()) edit(layer);
      }
    }
    if (kind_ == "film") {
      while (editor_.work()) {
      }
      if (!refused_) return;
    }
    if (!whole_->cancelled()) plan_whole(layer);
  }

  // What is no problem by itself (times that are sought, missions of other kinds) is planned as
  // `lapwing run` does, and drawn when it is done.
  void plan_whole(const Value& layer) {
    MissionSettings settings = settings_;
    settings.cancellation = whole_.get();
    const std::unique_ptr<Mission> mission = configured_mission(script_, settings, layer);
    MissionResult result = mission->plan();
    if (whole_->cancelled()) return;
    if (result.mapping)
      throw InputError("a mission of kind '" + mission->kind() +
                       "' makes a map and no flight that could be drawn; lapwing run plans it");
    EditedPlan edited;
    edited.answer.grade = AnswerGrade::converged;
    edited.answer.result.report = result.report;
    edited.folder = result.obstacle_folder;
    result.plan.solver = to_value(result.report, result.solver);
    edited.plan = std::make_shared<const Plan>(result.plan);
    for (const std::string& note : result.notes)
      edited.answer.message += (edited.answer.message.empty() ? "" : "; ") + note;
    tell(edited);
    edited.certificate = verify(*edited.plan, {.folder = edited.folder,
                                               .cancellation = whole_.get(),
                                               .controllers = controllers_of(*settings_.registry)});
    const std::string failures = all_failures(*edited.certificate);
    edited.answer.grade = failures.empty() ? AnswerGrade::certified : AnswerGrade::rejected;
    if (!failures.empty()) edited.answer.message = failures;
    tell(edited);
  }

  void hear(const EditedPlan& edited) {
    if (edited.answer.grade == AnswerGrade::refused) {
      refused_ = edited.answer.message;
      return;
    }
    if (edited.answer.grade == AnswerGrade::step) {
      if (Clock::now() - last_step_ < kBetweenSteps) return;
      last_step_ = Clock::now();
    }
    tell(edited);
  }

  void tell(const EditedPlan& edited) {
    const AnswerGrade grade = edited.answer.grade;
    tell_world(edited);
    Frame frame;
    frame.header.set("said", "answer");
    frame.header.set("grade", to_string(grade));
    frame.header.set("message", as_utf8(edited.answer.message));
    frame.header.set("seconds", std::chrono::duration<double>(Clock::now() - began_).count());
    const bool ended = grade != AnswerGrade::step;
    frame.parts.push_back(plan_message(*edited.plan, edited.answer.result.report, ended));
    Plan whole = *edited.plan;
    if (edited.certificate) whole.certificate = edited.certificate->to_value();
    frame.parts.push_back(edited.certificate ? certificate_message(*edited.certificate) : "");
    frame.parts.push_back(ended ? plan_text(whole) : "");
    send(std::move(frame), serial_);
  }

  // Once for every change of it.
  void tell_world(const EditedPlan& edited) {
    WorldMessage world = world_message(*edited.plan, edited.folder, drawn_);
    if (world.text == told_world_) return;
    told_world_ = world.text;
    Frame frame;
    frame.header.set("said", "world");
    Value& names = frame.header.set("blobs", Value::list());
    frame.parts.push_back(world.text);
    for (auto& [name, bytes] : world.blobs) {
      names.push_back(name);
      frame.parts.push_back(std::move(bytes));
    }
    send(std::move(frame), serial_);
  }

  std::filesystem::path script_;
  MissionSettings settings_;
  WorkerErrands errands_;
  MissionEditor editor_;
  std::string kind_;  // of the mission, once it is known
  Clock::time_point began_, last_step_;
  std::optional<std::string> refused_;
  DrawnSurfaces drawn_;
  std::string told_world_;

  std::mutex mutex_;  // of what follows
  std::condition_variable changed_;
  std::deque<Frame> waiting_;
  std::optional<Frame> solve_;
  std::int64_t serial_ = 0;                   // of the solve under way
  std::shared_ptr<CancellationToken> whole_;  // likewise, where it is planned whole
  bool ended_ = false;
};

}  // namespace

void run_studio_worker(const std::filesystem::path& script, const MissionSettings& settings) {
  std::signal(SIGINT, SIG_IGN);  // the server ends it
  StudioWorker(script, settings).run();
}

}  // namespace lapwing
