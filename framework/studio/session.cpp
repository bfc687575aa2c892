// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/session.h"

#include "framework/core/json.h"
#include "framework/studio/layer_file.h"

namespace lapwing {
namespace {

using Type = PageMessageType;

// Without a hint of where they differ.
bool same_token(const std::string& a, const std::string& b) {
  unsigned differences = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i)
    differences |= static_cast<unsigned>(a[i] ^ b[i]);
  return differences == 0 && !a.empty();
}

Value typed(const char* type) {
  Value value = Value::map();
  value.set("type", type);
  return value;
}

void set_name(Value& value, const PageMessage& message) {
  if (!message.id.empty())
    value.set("id", message.id);
  else
    value.set("edit", static_cast<std::int64_t>(message.edit));
}

}  // namespace

const char* to_string(WorkerRole role) {
  switch (role) {
    case WorkerRole::solver:
      return "solver";
    case WorkerRole::checker:
      return "checker";
    case WorkerRole::errands:
      return "errands";
  }
  return "";
}

StudioSession::StudioSession(EventLoop& loop, SessionSettings settings,
                             std::unique_ptr<Journal> journal, std::string why_not)
    : loop_(loop),
      settings_(std::move(settings)),
      journal_(std::move(journal)),
      why_not_(std::move(why_not)) {}

StudioSession::~StudioSession() {
  *alive_ = false;
}

void StudioSession::begin(Worker& solver, Worker& checker, Worker& errands) {
  solver_ = &solver;
  checker_ = &checker;
  errands_ = &errands;
  glance();
}

void StudioSession::finish() {
  if (layer_waits_) write_layer_now();
}

bool StudioSession::editable() const {
  return why_not().empty();
}

std::string StudioSession::why_not() const {
  if (!why_not_.empty()) return why_not_;
  if (mission_kind_ == "map")
    return "a mission of kind 'map' has no flight to be edited; change it in its script";
  return "";
}

void StudioSession::opened(const std::shared_ptr<PageSocket>& page) {
  pages_[page.get()] = {page, "", false, false};
  // Who says nothing is not kept.
  loop_.after(std::chrono::seconds(10), [this, alive = alive_, weak = std::weak_ptr(page)] {
    const auto held = weak.lock();
    if (!*alive || !held) return;
    const auto found = pages_.find(held.get());
    if (found != pages_.end() && !found->second.greeted) held->close("expected hello");
  });
}

void StudioSession::closed(PageSocket& page) {
  for (Check& check : checks_)
    if (check.proposal.from == &page) check.proposal.from = nullptr;
  for (auto& [role, line] : errand_lines_)
    for (Errand& errand : line.queue)
      if (errand.from == &page) errand.from = nullptr;
  pages_.erase(&page);
  if (pages_.empty()) pace(Pace::run);  // nobody is left who could
}

void StudioSession::received(PageSocket& page, std::string_view text) {
  const auto found = pages_.find(&page);
  if (found == pages_.end()) return;
  PageMessage message;
  try {
    message = page_message(text);
  } catch (const InputError& error) {
    if (!found->second.greeted) return page.close("expected hello");
    Value answer = typed("failed");
    answer.set("why", as_utf8(error.what()));
    return tell(&page, answer);
  }
  if (!found->second.greeted || message.type == Type::hello) return greet(page, message);
  take(page, message);
}

void StudioSession::greet(PageSocket& socket, const PageMessage& message) {
  Page& page = pages_[&socket];
  if (page.greeted || message.type != Type::hello) return socket.close("expected hello");
  if (!same_token(message.token, settings_.token)) return socket.close("wrong token");
  page.greeted = true;
  page.tab = message.tab;
  welcome(page);
}

void StudioSession::welcome(Page& page) {
  const bool known = (document_ && !description_.empty()) || !script_error_.empty();
  if (page.welcomed || !page.greeted || !known) return;
  page.welcomed = true;
  page.socket->send(std::make_shared<const std::string>(welcome_text()));
  if (!script_error_.empty()) {
    Value error = typed("script_error");
    error.set("message", script_error_);
    error.set("line", error_line_);
    tell(page.socket.get(), error);
  }
  if (pending_script_) {
    Value changed = typed("script_changed");
    changed.set("conflict", document_->conflicts(*pending_script_));
    changed.set("message", "the script changed on disk; your edits are kept until you choose");
    tell(page.socket.get(), changed);
  }
  if (solve_ && solve_->revision && !solve_->held && solve_->rank < 1) {
    for (const std::string& image : solve_->images)
      page.socket->send(std::make_shared<const std::string>(image_text(image)));
    if (solve_->paused) page.socket->send(std::make_shared<const std::string>(pace_text()));
  }
  if (!backdrop_message_.empty())
    page.socket->send(std::make_shared<const std::string>(backdrop_message_));
  std::vector<std::string> remarks = remarks_;
  if (journal_ && !journal_->remark().empty()) remarks.push_back(journal_->remark());
  for (const std::string& what : remarks) {
    Value remark = typed("remark");
    remark.set("message", as_utf8(what));
    tell(page.socket.get(), remark);
  }
}

void StudioSession::welcome_all() {
  for (auto& [socket, page] : pages_) welcome(page);
}

Value StudioSession::mission_value() const {
  Value mission = Value::map();
  mission.set("name", mission_name_);
  mission.set("kind", mission_kind_);
  mission.set("script", settings_.script.string());
  mission.set("editable", editable());
  mission.set("why_not", why_not().empty() ? Value() : Value(why_not()));
  return mission;
}

std::string StudioSession::welcome_text() const {
  Value head = typed("welcome");
  head.set("mission", mission_value());
  head.set("document", document_ ? document_->current() : Value());
  head.set("revision", static_cast<std::int64_t>(document_ ? document_->revision() : 0));
  head.set("can_undo", document_ && document_->can_undo());
  head.set("can_redo", document_ && document_->can_redo());
  head.set("undo_label", document_ ? document_->undo_label() : "");
  head.set("redo_label", document_ ? document_->redo_label() : "");
  std::string text = to_json(head, -1);
  text.pop_back();
  text += "," + (description_.empty() ? "\"schema\":null,\"choices\":null" : description_);
  text += ",\"world\":" + (world_.empty() ? "null" : world_);
  text += ",\"answer\":" + (document_answer_.empty() ? "null" : document_answer_) + "}";
  return text;
}

void StudioSession::take(PageSocket& page, const PageMessage& message) {
  if (message.type == Type::rest) return rest();
  if (message.type == Type::pace) {
    if (mission_kind_ != "explore")
      return refuse(&page, message, "only the planning of an exploration can be paused");
    return pace(message.pace);
  }
  if (!document_)
    return refuse(&page, message, "the script could not be loaded yet: " + script_error_);
  switch (message.type) {
    case Type::preview:
      return preview(page, message);
    case Type::gesture:
    case Type::undo:
    case Type::redo:
    case Type::resolve_script: {
      if (!editable()) return refuse(&page, message, why_not());
      Proposal proposal;
      proposal.from = &page;
      proposal.bytes = message.bytes;
      proposal.gesture = {message.id, message.base, message.label, message.patch, message.after};
      proposal.take = message.take;
      proposal.kind = message.type == Type::gesture ? EntryKind::gesture
                      : message.type == Type::undo  ? EntryKind::undo
                      : message.type == Type::redo  ? EntryKind::redo
                                                    : EntryKind::script;
      return propose(std::move(proposal));
    }
    default:
      return add_errand(page, message);
  }
}

void StudioSession::tell(PageSocket* page, const Value& message) {
  if (!page || !pages_.count(page)) return;
  page->send(std::make_shared<const std::string>(to_json(message, -1)));
}

void StudioSession::tell_all(const std::string& text, bool replaceable) {
  const auto shared = std::make_shared<const std::string>(text);
  // A page that is too slow is closed by sending, and leaves the map.
  std::vector<std::shared_ptr<PageSocket>> all;
  for (const auto& [socket, page] : pages_)
    if (page.welcomed) all.push_back(page.socket);
  for (const auto& socket : all) socket->send(shared, replaceable);
}

void StudioSession::tell_all(const Value& message) {
  tell_all(to_json(message, -1));
}

// Once for every change of what can be edited.
void StudioSession::tell_mission() {
  Value message = typed("mission");
  message.set("mission", mission_value());
  std::string text = to_json(message, -1);
  if (text == told_mission_) return;
  const bool first = told_mission_.empty();
  told_mission_ = std::move(text);
  if (!first) tell_all(told_mission_);
}

void StudioSession::refuse(PageSocket* page, const PageMessage& message, const std::string& why) {
  Value answer = typed("refused");
  set_name(answer, message);
  answer.set("why", as_utf8(why));
  tell(page, answer);
}

void StudioSession::refuse_gesture(const Proposal& proposal, const std::string& why) {
  PageMessage message;
  message.id = proposal.gesture.id;
  if (proposal.kind == EntryKind::script && message.id.empty()) message.id = "resolve_script";
  refuse(proposal.from, message, why);
}

void StudioSession::fail(PageSocket* page, const PageMessage& message, const std::string& why) {
  Value answer = typed("failed");
  set_name(answer, message);
  answer.set("why", as_utf8(why));
  tell(page, answer);
}

void StudioSession::heard(WorkerRole role, Frame frame) {
  const Value* said = frame.header.find("said");
  if (!said || !said->is_text()) return;
  const std::string& what = said->as_text();
  if (role == WorkerRole::solver) {
    if (what == "answer") answered(std::move(frame));
    if (what == "world") world(frame);
    if (what == "progress") progress(frame);
    if (what == "estimate") estimated(frame);
    if (what == "image") took_image(std::move(frame));
    if (what == "first_flight") first_flight(frame);
    if (what == "done" || what == "failed") errand_done(role, std::move(frame));
    return;
  }
  if (role == WorkerRole::errands) return errand_done(role, std::move(frame));
  if (what == "checked") checked(frame);
  if (what == "refused") not_checked(frame);
  if (what == "checked" || what == "refused") tell_mission();
  if (what == "described") {
    Value description = Value::map();
    description.set("schema", frame.header.at("schema"));
    description.set("choices", frame.header.at("choices"));
    description_ = to_json(description, -1);
    description_ = description_.substr(1, description_.size() - 2);
    welcome_all();
  }
}

void StudioSession::started(WorkerRole role) {
  Value message = typed("worker");
  message.set("role", to_string(role));
  message.set("state", "started");
  message.set("message", "");
  tell_all(message);
  if (crashed_.erase(role) == 0) return;  // the first time
  if (role == WorkerRole::solver) solver_started();
  if (errand_lines_.contains(role)) errands_started(role);
  if (role != WorkerRole::checker) return;
  if (document_ && description_.empty()) ask_for_description();
  if (checks_.empty() || checks_.front().serial == 0) return;
  Check& check = checks_.front();
  if (check.crashes <= 1) return checker_->send(check.frame);
  Frame refused;
  refused.header.set("serial", check.serial);
  refused.header.set("why", "the process that checks it crashed twice");
  not_checked(refused);
}

void StudioSession::ask_for_description() {
  Frame frame;
  frame.header.set("do", "describe");
  frame.header.set("serial", 0);
  checker_->send(std::move(frame));
}

void StudioSession::crashed(WorkerRole role, const std::string& why) {
  Value message = typed("worker");
  message.set("role", to_string(role));
  crashed_.insert(role);
  // What was sent to it and is not done; what comes from now on waits for the next process.
  if (role == WorkerRole::solver && solve_ && solve_->rank < 2) ++solve_->crashes;
  if (role == WorkerRole::checker && !checks_.empty()) ++checks_.front().crashes;
  if (const auto line = errand_lines_.find(role);
      line != errand_lines_.end() && line->second.under_way)
    ++line->second.queue.front().crashes;
  message.set("state", "crashed");
  message.set("message", as_utf8(why));
  tell_all(message);
}

}  // namespace lapwing
