// SPDX-License-Identifier: Apache-2.0
// Solves and their answers.
#include <algorithm>
#include <filesystem>

#include "framework/core/json.h"
#include "framework/studio/layer_file.h"
#include "framework/studio/session.h"

namespace lapwing {
namespace {

using Type = PageMessageType;

constexpr std::size_t kMostRemembered = 64, kMostRememberedBytes = std::size_t{128} << 20;

int rank_of(const std::string& grade) {
  return grade == "step" ? 0 : grade == "converged" ? 1 : 2;
}

// Of the files that planning wrote and the plan of this answer names; empty where there are none.
std::string folder_of(const Frame& answer) {
  const Value* folder = answer.header.find("folder");
  return folder ? folder->as_text() : "";
}

// The folder goes with the mission that planned, which the solving process keeps for a while.
bool has_its_files(const Frame& answer) {
  const std::string folder = folder_of(answer);
  std::error_code ignored;
  return folder.empty() || std::filesystem::is_directory(folder, ignored);
}

}  // namespace

void StudioSession::post_solve(const Value& layer, Solve solve) {
  solve.serial = ++serial_;
  solve.layer = to_json(layer, -1);
  if (solve.came == Clock::time_point{}) solve.came = Clock::now();
  next_drag_.reset();
  solve.posted = Clock::now();
  solve.frame.header.set("do", "solve");
  solve.frame.header.set("serial", solve.serial);
  solve.frame.header.set("layer", layer);
  solve.frame.header.set("settled", solve.settled);
  solver_->send(solve.frame);
  solve_ = std::move(solve);
}

void StudioSession::preview(PageSocket& page, const PageMessage& message) {
  Solve solve;
  try {
    if (!editable()) throw InputError(why_not());
    const Value next = document_->proposed(message.patch);
    solve.base = document_->revision();
    solve.settled = false;
    solve.edit = message.edit;
    solve.tab = pages_.at(&page).tab;
    drag(layer_of(base_options(), next), std::move(solve));
  } catch (const InputError& error) {
    refuse(&page, message, error.what());
  }
}

// A move that ended the solve of the one before would, of quick moves, leave none that is drawn: it
// waits until that one has an answer, or has had time enough. Of those that wait the newest counts.
void StudioSession::drag(const Value& layer, Solve solve) {
  const bool under_way = solve_ && !solve_->revision && !solve_->held && solve_->rank < 0 &&
                         Clock::now() - solve_->posted < settings_.patience;
  if (!under_way) return post_solve(layer, std::move(solve));
  solve.came = Clock::now();
  solve.frame.header.set("layer", layer);
  const bool waited = next_drag_.has_value();
  next_drag_ = std::move(solve);
  if (waited) return;
  loop_.after(settings_.patience, [this, alive = alive_] {
    if (*alive) drag_on();
  });
}

void StudioSession::drag_on() {
  if (!next_drag_) return;
  Solve next = std::move(*next_drag_);
  const Value layer = next.frame.header.at("layer");
  post_solve(layer, std::move(next));
}

// A drag that came to nothing: the document's own answer is told again, or it is solved.
void StudioSession::rest() {
  if (document_) solve_document();
}

// Whatever was said of the document is not about it any more. A solve that began while it was
// checked is its own now; a drag that began since goes on.
void StudioSession::document_changed(std::int64_t solved_meanwhile) {
  document_answer_.clear();
  document_rank_ = -1;
  settled_.reset();
  const bool its_own = solve_ && solve_->serial == solved_meanwhile;
  if (its_own) solve_->layer = to_json(document_layer(), -1);
  const bool dragged = solve_ && !its_own && !solve_->settled;
  if (!dragged) solve_document();
}

// What is solved becomes the document's where it is of the same options.
void StudioSession::solve_document(bool anew) {
  const Value layer = document_layer();
  const std::uint64_t revision = document_->revision();
  const std::string text = to_json(layer, -1);
  if (const Remembered* shown = anew ? nullptr : remembered(text)) return show_again(*shown);
  if (!anew && solve_ && solve_->settled && solve_->layer == text && script_error_.empty()) {
    if (!solve_->held && solve_->revision == revision) return;
    solve_->held = false;
    solve_->revision = revision;
    for (const std::string& image : solve_->images) tell_all(image_text(image));
    for (const Frame& frame : solve_->answers) deliver(frame);
    return;
  }
  Solve solve;
  solve.revision = revision;
  document_answer_.clear();
  document_rank_ = -1;
  settled_.reset();
  post_solve(layer, std::move(solve));
}

// ---- what was shown before
// -----------------------------------------------------------------------

const StudioSession::Remembered* StudioSession::remembered(const std::string& layer) const {
  for (const Remembered& shown : remembered_)
    if (shown.layer == layer) return is_whole(shown) ? &shown : nullptr;
  return nullptr;
}

// Whether all that the page will ask for is still there.
bool StudioSession::is_whole(const Remembered& shown) const {
  return has_its_files(shown.answer) &&
         std::all_of(shown.blobs.begin(), shown.blobs.end(),
                     [&](const std::string& name) { return surfaces_.holds(name); });
}

// What the document ended with. Only what was judged: the same options may be refused for a crash.
void StudioSession::remember(const Frame& frame) {
  if (frame.header.at("grade") == Value("refused") || remembered(solve_->layer)) return;
  std::erase_if(remembered_, [&](const Remembered& one) { return one.layer == solve_->layer; });
  Remembered shown{solve_->layer, frame, world_, world_blobs_};
  for (const std::string& part : frame.parts) shown.bytes += part.size();
  shown.bytes += shown.world.size() + shown.layer.size();
  remembered_.push_front(std::move(shown));
  std::size_t bytes = 0, kept = 0;
  for (const Remembered& one : remembered_) {
    bytes += one.bytes;
    if (kept > 0 && (kept >= kMostRemembered || bytes > kMostRememberedBytes)) break;
    ++kept;
  }
  remembered_.resize(kept);
}

// The very flight again. The process that solves begins the next edit there.
void StudioSession::show_again(const Remembered& shown) {
  const Frame answer = shown.answer;
  next_drag_.reset();
  Solve solve;
  solve.serial = ++serial_;
  solve.layer = shown.layer;
  solve.revision = document_->revision();
  solve.came = solve.posted = Clock::now();
  solve.rank = 2;
  solve.frame.header.set("layer", document_layer());
  solve_ = std::move(solve);
  Frame drop, begin;
  drop.header.set("do", "drop");
  drop.header.set("serial", solve_->serial);
  solver_->send(std::move(drop));
  begin.header.set("do", "begin_at");
  begin.header.set("serial", solve_->serial);
  if (answer.parts.size() > 2) begin.parts = {answer.parts[2]};
  solver_->send(std::move(begin));
  if (shown.world != world_ && !shown.world.empty()) {
    world_ = shown.world;
    world_blobs_ = shown.blobs;
    tell_all(world_);
  }
  deliver(answer);
}

void StudioSession::solver_started() {
  if (!solve_ || solve_->rank >= 2) return;
  solve_->images.clear();  // they are taken again
  if (solve_->paused) {
    solve_->paused = false;
    tell_all(pace_text());
  }
  if (solve_->crashes <= 1) return solver_->send(solve_->frame);
  Frame refused;
  refused.header.set("serial", solve_->serial);
  refused.header.set("grade", "refused");
  refused.header.set("message", "the solving process crashed twice on this edit");
  answered(std::move(refused));
}

void StudioSession::answered(Frame frame) {
  if (!solve_ || frame.header.at("serial") != Value(solve_->serial)) return;
  watch(frame.header.find("reads"), frame.header.at("grade") != Value("refused"), data_files_);
  const int rank = rank_of(frame.header.at("grade").as_text());
  if (rank < solve_->rank || (rank == solve_->rank && rank > 0)) return;  // late, or said again
  if (rank == solve_->rank) solve_->answers.pop_back();
  solve_->rank = rank;
  if (rank > 0) solve_->images.clear();  // the answer has them
  solve_->answers.push_back(frame);
  if (!solve_->held) deliver(solve_->answers.back());
  drag_on();
}

void StudioSession::deliver(const Frame& frame) {
  const Solve& solve = *solve_;
  const std::string& grade = frame.header.at("grade").as_text();
  Value head = Value::map();
  head.set("type", "answer");
  head.set("revision", static_cast<std::int64_t>(solve.revision.value_or(solve.base)));
  head.set("edit", solve.revision ? Value() : Value(static_cast<std::int64_t>(solve.edit)));
  head.set("tab", solve.revision ? Value() : Value(solve.tab));
  head.set("grade", grade);
  head.set("message", frame.header.at("message"));
  head.set("ms",
           std::round(std::chrono::duration<double, std::milli>(Clock::now() - solve.came).count() *
                      10) /
               10);
  const auto part = [&](std::size_t i) {
    return i < frame.parts.size() && !frame.parts[i].empty() ? frame.parts[i] : "null";
  };
  std::string text = to_json(head, -1);
  text.pop_back();
  text += ",\"plan\":" + part(0) + ",\"certificate\":" + part(1);
  // The plan of the first tour is `plan`.
  const Value* tours = frame.header.find("tours");
  for (std::size_t t = 0; tours && t < tours->as_list().size(); ++t) {
    std::string one = to_json(tours->as_list()[t], -1);
    one.pop_back();
    text += (t == 0 ? ",\"tours\":[" : ",") + one + ",\"plan\":" + part(3 + 3 * t) +
            ",\"certificate\":" + part(4 + 3 * t) + "}";
  }
  text += tours && !tours->as_list().empty() ? "]}" : "}";
  if (solve.revision && rank_of(grade) >= document_rank_) {
    document_answer_ = text;
    document_rank_ = rank_of(grade);
    if (rank_of(grade) == 2) remember(frame);
  }
  settle(frame);
  tell_all(text, grade == "step");
}

// Keeps what may be flown, drawn and exported.
void StudioSession::settle(const Frame& frame) {
  if (frame.parts.size() < 3 || frame.parts[2].empty()) return;
  Settled settled{frame.parts[2],
                  solve_->frame.header.at("layer"),
                  solve_->revision.value_or(solve_->base),
                  folder_of(frame),
                  {}};
  for (std::size_t i = 8; i < frame.parts.size(); i += 3) settled.further.push_back(frame.parts[i]);
  if (solve_->revision) {
    settled_ = settled;
    if (frame.header.at("grade") == Value("certified")) certified_ = settled;
  }
  displayed_ = std::move(settled);
  if (solve_->revision) ask_for_backdrop();
}

void StudioSession::world(const Frame& frame) {
  const Value::List& names = frame.header.at("blobs").as_list();
  world_blobs_.clear();
  for (std::size_t i = 0; i < names.size() && i + 1 < frame.parts.size(); ++i) {
    world_blobs_.push_back(names[i].as_text());
    surfaces_.put(names[i].as_text(), frame.parts[i + 1]);
  }
  world_ = frame.parts.at(0);
  tell_all(world_);
}

// How far the planning of the document has come.
void StudioSession::progress(const Frame& frame) {
  if (!solve_ || !solve_->revision || solve_->held || solve_->rank > 0 ||
      frame.header.at("serial") != Value(solve_->serial))
    return;
  Value message = Value::map();
  message.set("type", "progress");
  message.set("revision", static_cast<std::int64_t>(*solve_->revision));
  for (const char* key : {"phase", "fraction", "left"}) message.set(key, frame.header.at(key));
  tell_all(to_json(message, -1), true);
}

// An image of an exploration that is being planned. What was taken before a page came, or before
// the edit had its revision, is told later.
void StudioSession::took_image(Frame frame) {
  if (!solve_ || !solve_->settled || solve_->rank > 0 ||
      frame.header.at("serial") != Value(solve_->serial))
    return;
  std::string text = std::move(frame.parts.at(0));
  text.pop_back();
  text += ",\"sights\":\"" + surfaces_.put(std::move(frame.parts.at(1))) + "\"}";
  solve_->images.push_back(std::move(text));
  if (solve_->revision && !solve_->held) tell_all(image_text(solve_->images.back()));
}

std::string StudioSession::image_text(const std::string& image) const {
  return "{\"type\":\"image\",\"revision\":" + std::to_string(*solve_->revision) + "," +
         image.substr(1);
}

// Goes on, waits after the next image, or takes one more. Of what is planned now alone.
void StudioSession::pace(Pace pace) {
  if (!solve_ || !solve_->settled || solve_->rank > 0) return;
  if (pace == Pace::run && !solve_->paused) return;
  solve_->paused = pace != Pace::run;
  Frame frame;
  frame.header.set("do", "pace");
  frame.header.set("serial", solve_->serial);
  frame.header.set("paused", solve_->paused);
  frame.header.set("step", pace == Pace::step);
  solver_->send(std::move(frame));
  tell_all(pace_text());
}

std::string StudioSession::pace_text() const {
  Value message = Value::map();
  message.set("type", "pace");
  message.set("paused", solve_->paused);
  return to_json(message, -1);
}

// What a drag of a scan comes to; then the next move's turn has come.
void StudioSession::estimated(const Frame& frame) {
  if (!solve_ || solve_->revision || frame.header.at("serial") != Value(solve_->serial)) return;
  Value message = Value::map();
  message.set("type", "estimate");
  message.set("edit", static_cast<std::int64_t>(solve_->edit));
  message.set("tab", solve_->tab);
  for (const auto& [key, value] : frame.header.at("estimate").as_map()) message.set(key, value);
  tell_all(to_json(message, -1), true);
  solve_->rank = std::max(solve_->rank, 0);
  drag_on();
}

// Of a drag, or of an edit whose revision may still come.
void StudioSession::first_flight(const Frame& frame) {
  if (!solve_ || frame.header.at("serial") != Value(solve_->serial)) return;
  Value message = Value::map();
  message.set("type", "first_flight");
  message.set("edit", solve_->settled ? Value() : Value(static_cast<std::int64_t>(solve_->edit)));
  message.set("tab", solve_->settled ? Value() : Value(solve_->tab));
  std::string text = to_json(message, -1);
  text.pop_back();
  tell_all(text + "," + frame.parts.at(0).substr(1), true);
}

}  // namespace lapwing
