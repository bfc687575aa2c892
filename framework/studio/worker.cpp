// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/worker.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <deque>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "framework/config/read_note.h"
#include "framework/core/json.h"
#include "framework/mission/environment_source.h"
#include "framework/studio/file_look.h"
#include "framework/studio/worker_answers.h"
#include "framework/studio/worker_errands.h"
#include "framework/studio/worker_looks.h"
#include "framework/studio/worker_progress.h"
#include "framework/trajectory/interpolate.h"

namespace lapwing {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kBetweenSteps = std::chrono::milliseconds(40);

// A film of more stages is dragged with fewer, so that a move is drawn in time.
constexpr std::size_t kMostDragged = 800, kDraggedStages = 600;

// Missions whose plans a page may still want a picture of: the last, and those that undo comes to.
constexpr std::size_t kMostKept = 4;

// The reasons of all checks that fail, in one line; empty where none does.
std::string all_failures(const Certificate& certificate) {
  std::string all;
  for (const Check& check : certificate.failures())
    all += (all.empty() ? "" : "; ") + to_line(check);
  return all;
}

// m between two flights: beyond the first they are two to who looks at them, up to the second the
// solver had better begin at its own point, which has multipliers.
constexpr double kAnotherWay = 0.5, kSameWay = 0.05;

// The largest distance at equal times, m; infinite between flights of other durations.
double apart(const Trajectory& a, const Trajectory& b) {
  if (a.samples.empty() || b.samples.empty() || std::abs(a.duration() - b.duration()) > 1e-6)
    return std::numeric_limits<double>::infinity();
  double most = 0;
  for (const Sample& s : a.samples)
    most = std::max(most, (sample_at(b, s.time).position - s.position).norm());
  return most;
}

class StudioWorker {
 public:
  StudioWorker(const std::filesystem::path& script, const MissionSettings& settings,
               MissionEditor::Judge judge, JudgeFleet judge_fleet, std::string program)
      : script_(script),
        settings_(settings),
        judge_(std::move(judge)),
        judge_fleet_(std::move(judge_fleet)),
        errands_(script, settings_, std::move(program)),
        editor_(
            script, settings_, [this](const EditedPlan& edited) { hear(edited); }, judge_),
        looks_(
            [this](Frame frame, std::int64_t serial) { answers_.send(std::move(frame), serial); },
            settings.threads) {}

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
    if (WorkerLooks::answers(what) && !frame.header.find("run"))
      return looks_.ask(std::move(frame));
    const std::lock_guard lock(mutex_);
    if (what == "pace") {
      paused_ = frame.header.at("paused").as_boolean();
      steps_ = paused_ ? steps_ + frame.header.at("step").as_boolean() : 0;
    } else if (what == "solve" || what == "drop") {
      end_solve();
      solve_.reset();
      paused_ = false;
      steps_ = 0;
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
    answers_.begin_solve(frame.header.at("serial").as_integer());
    whole_ = std::make_shared<CancellationToken>();
    if (kind_ == "film") edit(frame);
    return frame;
  }

  void edit(const Frame& frame) {
    const bool settled = frame.header.at("settled").as_boolean();
    // What was drawn last of the same options is told again.
    if (settled && drawn_last_ && drawn_layer_ == to_json(frame.header.at("layer"), -1)) return;
    Value layer = layer_of_page(frame.header.at("layer"), script_);
    const bool coarse = !settled && dragged_step_ > 0;
    if (coarse) layer.set("step", dragged_step_);
    editor_.edit({{std::move(layer)}, {}, !settled && !coarse});
  }

  void do_work(const Frame& frame) {
    try {
      const std::string& what = frame.header.at("do").as_text();
      if (what == "solve")
        solve(frame);
      else if (what == "begin_at")
        begin_at(frame);
      else
        answers_.send(errands_.answer(frame), frame.header.at("serial").as_integer());
    } catch (const Cancelled&) {
    } catch (const Error& error) {
      failed(frame, error.what());
    }
  }

  void failed(const Frame& frame, const std::string& why) {
    const std::int64_t serial = frame.header.at("serial").as_integer();
    if (frame.header.at("do").as_text() == "solve") return answers_.refuse(serial, why);
    Frame answer;
    answer.header.set("said", frame.header.at("do") == Value("check") ? "refused" : "failed");
    answer.header.set("why", as_utf8(why));
    answer.header.set("line", line_in(why, script_));
    answer.header.set("files", errands_.script_files());
    answers_.send(std::move(answer), serial);
  }

  // What a page sees again without a solve.
  void begin_at(const Frame& frame) {
    drawn_last_.reset();
    answers_.forget_world();
    if (!frame.parts.empty())
      editor_.begin_at(plan_from_value(from_json(frame.parts.front(), "plan")).trajectory);
  }

  void solve(const Frame& frame) {
    const Value& layer = frame.header.at("layer");
    const bool settled = frame.header.at("settled").as_boolean();
    const std::string text = to_json(layer, -1);
    const bool drawn = drawn_last_ && drawn_layer_ == text;
    last_step_ = {};
    refused_.reset();
    if (kind_.empty()) {  // of the first one
      kind_ = Mission(script_, settings_).kind();
      if (kind_ == "film") {
        const std::lock_guard lock(mutex_);
        if (!solve_ && !whole_->cancelled()) edit(frame);
      }
    }
    std::optional<Trajectory> before;
    if (kind_ == "scan" && !settled) return estimate(layer);
    if (kind_ != "film" && !settled) return;  // planned when it is let go of
    if (kind_ == "film") {
      if (settled && drawn) tell(*drawn_last_);
      if (!drawn) drawn_last_.reset();
      drawn_layer_ = text;
      while (editor_.work()) {
      }
      if (!refused_ && !settled) return;
      // A coarse plan is not compared with the whole one.
      if (!refused_ && drawn_last_ && !(dragged_step_ > 0)) before = drawn_last_->plan->trajectory;
    }
    if (!whole_->cancelled()) plan_whole(layer, before);
  }

  // What a drag of a scan comes to: its tours on the graph of a plan before, changed where regions,
  // zones or starts are dragged. What needs another first flight is planned when it is let go of.
  void estimate(const Value& layer) {
    MissionSettings settings = settings_;
    settings.cancellation = whole_.get();
    settings.scan_memory = scan_memory();
    Value estimate = Value::map();
    bool drawn = false;
    settings.observe_estimate = [&](const Value& told) { estimate = told; };
    settings.observe_first_flight = [&](const Value& told) {
      tell_first_flight(told);
      drawn = true;
    };
    try {
      if (!settings.scan_memory->entries.empty())
        configured_mission(script_, settings, layer)->plan();
    } catch (const Cancelled&) {
    } catch (const InputError& error) {
      estimate.set("why", as_utf8(error.what()));
    }
    if (whole_->cancelled()) return;
    const bool other_views = estimate.as_map().empty();
    answers_.tell_estimate(std::move(estimate));
    if (other_views && !drawn) draw_first_flight(layer);
  }

  // Of a drag: the images of the first flight, before it is flown.
  void draw_first_flight(const Value& layer) {
    MissionSettings settings = settings_;
    settings.cancellation = whole_.get();
    settings.observe_first_flight = [&](const Value& told) { tell_first_flight(told); };
    settings.first_flight_alone = true;
    try {
      configured_mission(script_, settings, layer)->plan();
    } catch (const Error&) {
      // What is wrong is said of the document, once it is let go of.
    }
  }

  void tell_first_flight(const Value& told) {
    if (!whole_->cancelled()) answers_.tell_first_flight(told);
  }

  // As `lapwing run` does: what is settled, and what is no problem by itself (times that are
  // sought, missions of other kinds), which is drawn when it is done. `before`: what is drawn of it
  // already.
  void plan_whole(const Value& layer, const std::optional<Trajectory>& before) {
    const ReadListener listener([this](const std::filesystem::path& file) {
      reads_.insert(file.string());
      memory_reads_.try_emplace(file.string(), look_of(file));
    });
    MissionSettings settings = settings_;
    settings.cancellation = whole_.get();
    WorkerProgress progress([this](Frame told) { answers_.send(std::move(told)); });
    settings.progress = &progress;
    settings.record_steps = true;
    settings.observe_image = [this](const TakenImage& image) {
      answers_.tell_image(image);
      wait_while_paused();
    };
    if (kind_ == "explore")
      settings.observe_episode = [this](std::shared_ptr<EpisodeReplay> episode) {
        looks_.begin_episode(std::move(episode));
      };
    settings.keep_tours = true;
    settings.observe_first_flight = [this](const Value& told) { tell_first_flight(told); };
    settings.scan_memory = scan_memory();
    // Modules that are required while it plans, as scenes are.
    settings.observe_script = [this](const std::filesystem::path& file) {
      memory_reads_.try_emplace(file.string(), look_of(file));
      if (file != script_ && is_own_module(file, settings_.scripts))
        reads_.insert(std::filesystem::weakly_canonical(file).string());
    };
    const std::shared_ptr<Mission> mission = configured_mission(script_, settings, layer);
    MissionResult result = mission->plan();
    if (whole_->cancelled()) return;
    if (result.mapping)
      throw InputError("a mission of kind '" + mission->kind() +
                       "' makes a map and no flight that could be drawn; lapwing run plans it");
    keep_tours(result);
    if (result.fleet) {
      keep(mission);
      return judge_tours(result);
    }
    EditedPlan edited;
    edited.answer.grade = AnswerGrade::converged;
    edited.answer.result.report = result.report;
    edited.folder = result.obstacle_folder;
    edited.scan = result.scan;
    edited.exploration = result.exploration;
    if (edited.exploration) looks_.keep_episode(edited.folder.string());
    if (edited.exploration)  // for distances: planning kept the map in its own form
      open_recorded_shapes(result.plan.environment, *settings_.registry, edited.folder);
    edited.plan = std::make_shared<const Plan>(result.plan);
    for (const std::string& note : result.notes)
      edited.answer.message += (edited.answer.message.empty() ? "" : "; ") + note;
    if (kind_ != "film") keep(mission);
    if (!before) tell(edited);
    edited.certificate = judge_(*edited.plan, edited.folder, *whole_);
    if (whole_->cancelled()) return;
    const Trajectory& flight = edited.plan->trajectory;
    dragged_step_ = flight.samples.size() > kMostDragged
                        ? flight.duration() / static_cast<double>(kDraggedStages)
                        : 0;
    const std::string failures = all_failures(*edited.certificate);
    edited.answer.grade = failures.empty() ? AnswerGrade::certified : AnswerGrade::rejected;
    if (!failures.empty()) edited.answer.message = failures;
    const double moved = before ? apart(edited.plan->trajectory, *before) : 0;
    if (failures.empty() && edited.answer.message.empty() && moved > kAnotherWay)
      edited.answer.message =
          "planned from the beginning, as lapwing run does, the flight takes another way";
    if (!before || moved > kSameWay) editor_.begin_at(edited.plan->trajectory);
    drawn_last_.reset();
    tell(edited);
  }

  void wait_while_paused() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return ended_ || whole_->cancelled() || !paused_ || steps_ > 0; });
    if (paused_ && steps_ > 0) --steps_;
  }

  // Of the plan before, as long as the script and all that it has read are as they were.
  std::shared_ptr<ScanMemory> scan_memory() {
    const bool changed =
        std::any_of(memory_reads_.begin(), memory_reads_.end(),
                    [](const auto& read) { return look_of(read.first) != read.second; });
    if (changed) {
      scan_memory_->entries.clear();
      memory_reads_.clear();
      reads_.clear();
    }
    return scan_memory_;
  }

  // Several batteries: told as they are planned, then with what was judged.
  void judge_tours(MissionResult& result) {
    std::string notes;
    for (const std::string& note : result.notes) notes += (notes.empty() ? "" : "; ") + note;
    answers_.tell_tours(result, nullptr, AnswerGrade::converged, notes);
    const FleetVerdict verdict = judge_fleet_(result, *whole_);
    if (whole_->cancelled()) return;
    std::string failures = all_failures(verdict.all);
    for (std::size_t t = 0; t < verdict.tours.size(); ++t)
      if (const std::string own = all_failures(verdict.tours[t]); !own.empty())
        failures += (failures.empty() ? "" : "; ") + name_of_tour(result.fleet->document.tours[t]) +
                    ": " + own;
    answers_.tell_tours(result, &verdict,
                        failures.empty() ? AnswerGrade::certified : AnswerGrade::rejected,
                        failures.empty() ? notes : failures);
  }

  // Its folder has files that its plan names and that planning wrote, and goes with it.
  void keep(std::shared_ptr<Mission> mission) {
    planned_.push_back(std::move(mission));
    if (planned_.size() > kMostKept) planned_.pop_front();
  }

  // What pages may ask about.
  void keep_tours(const MissionResult& result) {
    std::vector<KeptTour> tours;
    if (result.kept) tours.push_back(*result.kept);
    for (std::size_t t = 0; result.fleet && t < result.fleet->tours.size(); ++t)
      if (const auto& kept = result.fleet->tours[t].kept) tours.push_back(*kept);
    if (!tours.empty()) looks_.keep(result.obstacle_folder.string(), std::move(tours));
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
    if (edited.answer.grade != AnswerGrade::converged) return tell(edited);
    drawn_last_ = edited;
    if (dragged_step_ > 0)
      drawn_last_->answer.message =
          "a coarse plan of a long film; it is planned whole and checked when you let go";
    tell(*drawn_last_);
  }

  // A page asks for no files of a film.
  void tell(const EditedPlan& edited) {
    answers_.tell(edited, kind_ == "film" ? std::filesystem::path() : edited.folder);
  }

  std::filesystem::path script_;
  MissionSettings settings_;
  MissionEditor::Judge judge_;
  JudgeFleet judge_fleet_;
  WorkerErrands errands_;
  MissionEditor editor_;
  std::string kind_;  // of the mission, once it is known
  Clock::time_point last_step_;
  std::optional<std::string> refused_;
  std::optional<EditedPlan> drawn_last_;  // as it converged, from the point before; of this layer:
  std::string drawn_layer_;
  double dragged_step_ = 0;  // s between stages while a long film is dragged; 0: as the film says
  std::deque<std::shared_ptr<Mission>> planned_;  // of other kinds than films, the newest last
  std::shared_ptr<ScanMemory> scan_memory_ = std::make_shared<ScanMemory>();
  std::map<std::string, std::string> memory_reads_;  // for it, and what they looked like
  std::set<std::string> reads_;                      // of the mission planned last

  std::mutex mutex_;  // of what follows
  std::condition_variable changed_;
  std::deque<Frame> waiting_;
  std::optional<Frame> solve_;
  std::shared_ptr<CancellationToken> whole_;  // of the solve under way, where it is planned whole
  bool paused_ = false;                       // an exploration, after each image
  int steps_ = 0;                             // images that it may take all the same
  bool ended_ = false;

  WorkerAnswers answers_{reads_};
  WorkerLooks looks_;
};

}  // namespace

void run_studio_worker(const std::filesystem::path& script, const MissionSettings& settings,
                       MissionEditor::Judge judge, JudgeFleet judge_fleet, std::string program) {
  std::signal(SIGINT, SIG_IGN);  // the server ends it
  StudioWorker(script, settings, std::move(judge), std::move(judge_fleet), std::move(program))
      .run();
}

}  // namespace lapwing
