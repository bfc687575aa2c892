// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/worker_answers.h"

#include <unistd.h>

#include "framework/core/json.h"
#include "framework/export/episode_file.h"
#include "framework/studio/worker_link.h"

namespace lapwing {

void WorkerAnswers::send(Frame answer, std::int64_t serial) {
  answer.header.set("serial", serial);
  const std::lock_guard lock(sending_);
  if (!write_frame(kWorkerOutput, answer)) ::_exit(0);  // nobody is left to tell
}

void WorkerAnswers::set_reads(Frame& answer) const {
  answer.header.set("reads", Value(Value::List(reads_.begin(), reads_.end())));
}

void WorkerAnswers::refuse(std::int64_t serial, const std::string& why) {
  Frame answer;
  answer.header.set("said", "answer");
  answer.header.set("grade", to_string(AnswerGrade::refused));
  answer.header.set("message", as_utf8(why));
  set_reads(answer);
  send(std::move(answer), serial);
}

void WorkerAnswers::tell(const EditedPlan& edited, const std::filesystem::path& folder) {
  const AnswerGrade grade = edited.answer.grade;
  tell_world(*edited.plan, edited.folder, {edited.scan.get(), edited.exploration.get(), {}});
  Frame frame = answer_frame(grade, edited.answer.message, folder);
  const bool ended = grade != AnswerGrade::step;
  if (edited.certificate) set_reads(frame);
  frame.parts.push_back(plan_message(*edited.plan, edited.answer.result.report, ended));
  Plan whole = *edited.plan;
  if (edited.certificate) whole.certificate = edited.certificate->to_value();
  frame.parts.push_back(edited.certificate ? certificate_message(*edited.certificate) : "");
  frame.parts.push_back(ended ? plan_text(whole) : "");
  send(std::move(frame));
}

void WorkerAnswers::tell_tours(const MissionResult& result, const FleetVerdict* verdict,
                               AnswerGrade grade, const std::string& message) {
  const FleetResult& fleet = *result.fleet;
  PlannedOn on{result.scan.get(), nullptr, {}};
  for (const MissionResult& tour : fleet.tours) on.tours.push_back(&tour.plan);
  tell_world(fleet.tours.front().plan, result.obstacle_folder, on);
  Frame frame = answer_frame(grade, message, result.obstacle_folder);
  if (verdict) set_reads(frame);
  Value& tours = frame.header.set("tours", Value::list());
  frame.parts = {"", verdict ? certificate_message(verdict->all) : "", ""};
  for (std::size_t t = 0; t < fleet.tours.size(); ++t) {
    const Plan& plan = fleet.tours[t].plan;
    const FleetTour& about = fleet.document.tours[t];
    Value one = Value::map();
    one.set("name", as_utf8(name_of_tour(about)));
    one.set("drone", as_utf8(about.drone));
    one.set("battery", std::int64_t{about.battery});
    one.set("start", about.start);
    tours.push_back(std::move(one));
    std::string drawn = plan_message(plan, fleet.tours[t].report, false);
    std::string document = verdict ? verdict->texts[t] : plan_text(plan);
    if (t == 0) {
      frame.parts[0] = std::move(drawn);
      frame.parts[2] = std::move(document);
      drawn = document = "";
    }
    frame.parts.push_back(std::move(drawn));
    frame.parts.push_back(verdict ? certificate_message(verdict->tours[t]) : "");
    frame.parts.push_back(std::move(document));
  }
  send(std::move(frame));
}

void WorkerAnswers::tell_image(const TakenImage& image) {
  Frame frame;
  frame.header.set("said", "image");
  frame.parts = {image_message(image), sights_bytes({image.sight})};
  send(std::move(frame));
}

void WorkerAnswers::tell_first_flight(const Value& told) {
  Frame frame;
  frame.header.set("said", "first_flight");
  frame.parts.push_back(to_json(told, -1));
  send(std::move(frame));
}

void WorkerAnswers::tell_estimate(Value estimate) {
  Frame frame;
  frame.header.set("said", "estimate");
  frame.header.set("estimate", std::move(estimate));
  send(std::move(frame));
}

Frame WorkerAnswers::answer_frame(AnswerGrade grade, const std::string& message,
                                  const std::filesystem::path& folder) const {
  Frame frame;
  frame.header.set("said", "answer");
  frame.header.set("grade", to_string(grade));
  frame.header.set("message", as_utf8(message));
  frame.header.set("folder", folder.string());
  frame.header.set("seconds", std::chrono::duration<double>(Clock::now() - began_).count());
  return frame;
}

// Once for every change of it.
void WorkerAnswers::tell_world(const Plan& plan, const std::filesystem::path& folder,
                               const PlannedOn& on) {
  WorldMessage world = world_message(plan, folder, on, drawn_);
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
  send(std::move(frame));
}

}  // namespace lapwing
