// SPDX-License-Identifier: Apache-2.0
// What a working process tells the server of its plans (worker.h). Internal to this room.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <set>
#include <string>

#include "framework/mission/mission_editor.h"
#include "framework/studio/frames.h"
#include "framework/studio/plan_message.h"
#include "framework/studio/worker.h"

namespace lapwing {

class WorkerAnswers {
 public:
  // Keeps a reference: `reads` are the data files that the mission has read, also for graphs that
  // are kept. A plan on one of those does not read them again.
  explicit WorkerAnswers(const std::set<std::string>& reads) : reads_(reads) {}

  // From any thread. Without a serial: of the solve under way. Ends the process where nobody is
  // left to tell.
  void send(Frame frame, std::int64_t serial);
  void send(Frame frame) { send(std::move(frame), serial_); }

  // The seconds in answers count from here.
  void begin_solve(std::int64_t serial) {
    serial_ = serial;
    began_ = Clock::now();
  }
  void forget_world() { told_world_.clear(); }  // it is told again

  void refuse(std::int64_t serial, const std::string& why);
  // `folder`: of the files that the page may ask for; empty where it may not.
  void tell(const EditedPlan& edited, const std::filesystem::path& folder);
  // A plan of several batteries. `verdict`: null while it is judged.
  void tell_tours(const MissionResult& result, const FleetVerdict* verdict, AnswerGrade grade,
                  const std::string& message);
  void tell_image(const TakenImage& image);
  void tell_first_flight(const Value& told);
  void tell_estimate(Value estimate);

 private:
  using Clock = std::chrono::steady_clock;
  void set_reads(Frame& answer) const;
  Frame answer_frame(AnswerGrade grade, const std::string& message,
                     const std::filesystem::path& folder) const;
  void tell_world(const Plan& plan, const std::filesystem::path& folder, const PlannedOn& on);

  const std::set<std::string>& reads_;
  std::atomic<std::int64_t> serial_ = 0;  // of the solve under way
  Clock::time_point began_;
  DrawnSurfaces drawn_;
  std::string told_world_;
  std::mutex sending_;  // of frames to the server
};

}  // namespace lapwing
