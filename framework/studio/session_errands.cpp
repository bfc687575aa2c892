// SPDX-License-Identifier: Apache-2.0
// Errands: flights, pictures, files, races by hand, runs' folders, and questions about a planned
// scan. Those of one process are done one after the other.
#include <cmath>

#include "framework/core/json.h"
#include "framework/studio/file_look.h"
#include "framework/studio/layer_file.h"
#include "framework/studio/session.h"

namespace lapwing {
namespace {

using Type = PageMessageType;

constexpr std::size_t kMostErrands = 32;

bool is_look(PageMessageType type) {
  return type == Type::voxel || type == Type::slice || type == Type::left_out || type == Type::view;
}

}  // namespace

void StudioSession::add_errand(PageSocket& page, const PageMessage& message) {
  const bool look = is_look(message.type);
  // The process that plans has the maps of its plans; runs' folders are read elsewhere.
  const WorkerRole role = look && message.folder.empty() ? WorkerRole::solver : WorkerRole::errands;
  ErrandLine& line = errand_lines_[role];
  // Of pictures, flights and looks a page wants the newest alone.
  const bool newest_alone = look || message.type == Type::picture || message.type == Type::fly;
  for (std::size_t i = line.under_way ? 1 : 0; newest_alone && i < line.queue.size(); ++i) {
    if (line.queue[i].from != &page || line.queue[i].type != message.type) continue;
    line.queue.erase(line.queue.begin() + static_cast<std::ptrdiff_t>(i));
    break;
  }
  if (line.queue.size() >= kMostErrands) return fail(&page, message, "too much is asked for");
  Errand errand;
  errand.type = message.type;
  errand.from = &page;
  errand.message = message;
  line.queue.push_back(std::move(errand));
  next_errand(role);
}

// Whose map is asked about: that of the plan on display, of an exploration that is being planned,
// as far as it has come, or of a run's folder.
void StudioSession::add_map(const PageMessage& message, Frame& frame) const {
  const bool explored = mission_kind_ == "explore";
  const bool of_map = message.type == Type::voxel || message.type == Type::slice;
  if (mission_kind_ != "scan" && !(explored && of_map))
    throw InputError("a mission of kind '" + mission_kind_ + "' has no map of a first flight");
  if (explored != message.images.has_value())
    throw InputError(explored ? "image: missing; the map of an exploration is one after each image"
                              : "image: a scan has one map, that of its first flight");
  if (message.images) frame.header.set("image", std::int64_t{*message.images});
  if (!message.folder.empty()) {
    frame.header.set("run", message.folder);
    return;
  }
  const bool live = explored && solve_ && solve_->settled && !solve_->images.empty();
  if (!live && !displayed_)
    throw InputError(std::string("the ") + (explored ? "exploration" : "scan") +
                     " is not planned yet");
  frame.header.set("folder", live ? "" : displayed_->folder);
}

// A question about the plan on display.
void StudioSession::add_look(const PageMessage& message, Frame& frame) const {
  add_map(message, frame);
  switch (message.type) {
    case Type::voxel:
      frame.header.set("at", Value(Value::List(message.at.begin(), message.at.end())));
      break;
    case Type::slice:
      frame.header.set("axis", std::int64_t{message.axis});
      frame.header.set("at", message.at.front());
      break;
    case Type::view:
      frame.header.set(message.of_tour ? "image" : "candidate",
                       static_cast<std::int64_t>(message.view));
      frame.header.set("tour", static_cast<std::int64_t>(message.tour));
      break;
    default:
      break;
  }
}

Frame StudioSession::errand_frame(const PageMessage& message) {
  Frame frame;
  frame.header.set("do", to_string(message.type));
  if (is_look(message.type)) {
    add_look(message, frame);
    return frame;
  }
  const auto use = [&](const std::optional<Settled>& settled, const char* lacking) {
    if (!settled) throw InputError(lacking);
    frame.header.set("layer", settled->layer);
    frame.header.set("folder", settled->folder);
    if (message.tour > settled->further.size())
      throw InputError("tour: there is no tour " + std::to_string(message.tour + 1));
    if (!settled->further.empty())
      frame.header.set("number", static_cast<std::int64_t>(message.tour + 1));
    frame.parts = {message.tour == 0 ? settled->document : settled->further[message.tour - 1]};
  };
  switch (message.type) {
    case Type::backdrop:
      use(settled_, "the document is not solved yet");
      frame.header.set("file", std::filesystem::absolute(settings_.backdrop).string());
      break;
    case Type::fly:
      use(certified_, "there is no certified plan to fly yet");
      frame.header.set("wind_mean", std::hypot(message.wind[0], message.wind[1]));
      frame.header.set("wind_yaw", std::atan2(message.wind[1], message.wind[0]));
      frame.header.set("wind_gust", message.gust);
      frame.header.set("mass", message.mass);
      frame.header.set("runs", std::int64_t{message.runs});
      frame.header.set("seed", static_cast<std::int64_t>(message.seed));
      break;
    case Type::picture:
      use(displayed_, "there is no plan to picture yet");
      frame.header.set("time", message.time);
      frame.header.set("width", message.width);
      frame.header.set("height", message.height);
      break;
    case Type::export_plan:
      use(settled_, "the document is not solved yet");
      frame.header.set("format", message.format);
      frame.header.set("parameters", message.parameters);
      frame.header.set("uncertified", message.uncertified);
      break;
    case Type::export_lua:
      frame.header.set("layer", document_layer());
      frame.header.set("target", beside_script(settings_.script, ".studio.lua").string());
      break;
    case Type::save_report: {
      if (const std::string why = write_layer_now(); !why.empty()) throw InputError(why);
      Value words = Value::list();
      for (const std::string& word : settings_.run_words) words.push_back(word);
      if (!document_layer().as_map().empty()) {
        words.push_back("--config");
        words.push_back(beside_script(settings_.script, ".studio.yaml").string());
      }
      frame.header.set("words", std::move(words));
      if (settled_) {
        frame.parts = {settled_->document};
        frame.parts.insert(frame.parts.end(), settled_->further.begin(), settled_->further.end());
      }
      break;
    }
    case Type::race:
      use(settled_, "there is no plan to race on yet");
      frame.header.set("id", message.id);
      frame.header.set("players", message.players);
      break;
    case Type::stick: {
      frame.header.set("id", message.id);
      frame.header.set("time", message.time);
      Value& sticks = frame.header.set("sticks", Value::list());
      for (const auto& [forward, left] : message.sticks)
        sticks.push_back(Value(Value::List{forward, left}));
      break;
    }
    case Type::list_runs:
      break;
    case Type::open_run:
      frame.header.set("run", message.folder);
      break;
    default:
      throw InputError("not an errand");
  }
  return frame;
}

// For the document's plan as it is. The process that does it tells nothing where the backdrop is as
// it was.
void StudioSession::ask_for_backdrop() {
  if (settings_.backdrop.empty() || !settled_) return;
  backdrop_looks_ = look_of(settings_.backdrop);
  ErrandLine& line = errand_lines_[WorkerRole::errands];
  for (std::size_t i = line.under_way ? 1 : 0; i < line.queue.size(); ++i)
    if (line.queue[i].type == Type::backdrop) return;  // its turn comes
  Errand errand;
  errand.type = errand.message.type = Type::backdrop;
  line.queue.push_back(std::move(errand));
  next_errand(WorkerRole::errands);
}

// Whether it was one. Without an answer nothing of the backdrop before is shown.
bool StudioSession::tell_backdrop(const Errand& errand, Frame& frame) {
  if (errand.type != Type::backdrop) return false;
  const bool done = frame.header.at("said") == Value("done");
  if (done && frame.parts.size() < 2) return true;
  Value message = Value::map();
  message.set("type", "backdrop");
  if (done)
    message.set("picture", backdrops_.put(std::move(frame.parts[1])));
  else
    message.set("why", frame.header.at("why"));
  std::string text = to_json(message, -1);
  if (done) text.insert(text.size() - 1, "," + frame.parts[0]);
  if (text == backdrop_message_) return true;
  backdrop_message_ = std::move(text);
  tell_all(backdrop_message_);
  return true;
}

void StudioSession::next_errand(WorkerRole role) {
  ErrandLine& line = errand_lines_[role];
  while (!line.under_way && !line.queue.empty()) {
    Errand& errand = line.queue.front();
    try {
      errand.frame = errand_frame(errand.message);
    } catch (const InputError& error) {
      fail(errand.from, errand.message, error.what());
      line.queue.pop_front();
      continue;
    }
    errand.serial = ++serial_;
    errand.frame.header.set("serial", errand.serial);
    (role == WorkerRole::solver ? solver_ : errands_)->send(errand.frame);
    line.under_way = true;
  }
}

// Of a process that had crashed: once more, but not a third time.
void StudioSession::errands_started(WorkerRole role) {
  ErrandLine& line = errand_lines_[role];
  if (!line.under_way) return;
  Errand& errand = line.queue.front();
  if (errand.crashes <= 1)
    return (role == WorkerRole::solver ? solver_ : errands_)->send(errand.frame);
  Frame failed;
  failed.header.set("said", "failed");
  failed.header.set("why", "the process that does it crashed twice");
  if (!tell_backdrop(errand, failed))
    fail(errand.from, errand.message, failed.header.at("why").as_text());
  line.queue.pop_front();
  line.under_way = false;
  next_errand(role);
}

void StudioSession::errand_done(WorkerRole role, Frame frame) {
  ErrandLine& line = errand_lines_[role];
  if (!line.under_way || frame.header.at("serial") != Value(line.queue.front().serial)) return;
  const Errand errand = std::move(line.queue.front());
  line.queue.pop_front();
  line.under_way = false;
  if (tell_backdrop(errand, frame)) return next_errand(role);
  if (frame.header.at("said") != Value("done")) {
    fail(errand.from, errand.message, frame.header.at("why").as_text());
    return next_errand(role);
  }
  const std::string text = answer_of_errand(errand, std::move(frame));
  if (errand.from && pages_.count(errand.from))
    errand.from->send(std::make_shared<const std::string>(text));
  next_errand(role);
}

std::string StudioSession::answer_of_errand(const Errand& errand, Frame frame) {
  Value message = Value::map();
  std::string raw;
  if (is_look(errand.type)) {
    message.set("type", to_string(errand.type));
    message.set("id", errand.message.id);
    const Value::List& blobs = frame.header.at("blobs").as_list();
    for (std::size_t i = 0; i < blobs.size(); ++i)
      message.set(blobs[i].as_text(), pictures_.put(std::move(frame.parts.at(i + 1))));
    raw = "," + frame.parts.at(0).substr(1, frame.parts.at(0).size() - 2);
  } else if (errand.type == Type::fly) {
    message.set("type", "flown");
    message.set("edit", static_cast<std::int64_t>(errand.message.edit));
    for (const char* key : {"lost", "finished", "kept", "worst"})
      message.set(key, frame.header.at(key));
    if (const Value* runs = frame.header.find("runs")) message.set("runs", *runs);
    raw = ",\"samples\":" + frame.parts.at(0);
    if (frame.parts.size() > 1) raw += ",\"ways\":" + frame.parts[1];
  } else if (errand.type == Type::picture) {
    message.set("type", "picture");
    message.set("edit", static_cast<std::int64_t>(errand.message.edit));
    message.set("time", errand.message.time);
    message.set("blob", pictures_.put(std::move(frame.parts.at(0))));
  } else if (errand.type == Type::race || errand.type == Type::stick) {
    message.set("type", "raced");
    message.set("id", errand.message.id);
    if (const Value* files = frame.header.find("files")) message.set("files", *files);
    raw = "," + frame.parts.at(0).substr(1, frame.parts.at(0).size() - 2);
  } else if (errand.type == Type::list_runs) {
    message.set("type", "runs");
    message.set("id", errand.message.id);
    message.set("folders", frame.header.at("folders"));
  } else if (errand.type == Type::open_run) {
    message.set("type", "run");
    message.set("id", errand.message.id);
    message.set("folder", frame.header.at("folder"));
    Value exploration = frame.header.at("exploration");
    exploration.set("growth", surfaces_.put(std::move(frame.parts.at(2))));
    exploration.set("sights", surfaces_.put(std::move(frame.parts.at(3))));
    message.set("exploration", std::move(exploration));
    raw = ",\"plan\":" + frame.parts.at(0) + ",\"certificate\":" + frame.parts.at(1);
  } else {
    message.set("type", "wrote");
    message.set("id", errand.message.id);
    message.set("files", frame.header.at("files"));
    message.set("loss", frame.header.at("loss"));
    if (const Value* status = frame.header.find("status")) message.set("status", *status);
  }
  std::string text = to_json(message, -1);
  text.insert(text.size() - 1, raw);
  return text;
}

}  // namespace lapwing
