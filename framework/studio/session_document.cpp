// SPDX-License-Identifier: Apache-2.0
// Changes of the document and of its script.
#include "framework/core/json.h"
#include "framework/studio/file_look.h"
#include "framework/studio/layer_file.h"
#include "framework/studio/session.h"

namespace lapwing {
namespace {

constexpr const char* kWordsLabel = "--config and --set";

// Edits of pages that wait to be checked, all pages together (PROTOCOL.md).
constexpr std::size_t kMostWaiting = 64, kMostWaitingBytes = std::size_t{8} << 20;

}  // namespace

// ---- the script ---------------------------------------------------------------------------------

void StudioSession::glance() {
  std::string look = look_of_all();
  if (look != watched_) {
    watched_ = std::move(look);
    check_script();
  }
  if (!settings_.backdrop.empty() && look_of(settings_.backdrop) != backdrop_looks_)
    ask_for_backdrop();
  loop_.after(settings_.glance, [this, alive = alive_] {
    if (*alive) glance();
  });
}

std::string StudioSession::look_of_all() const {
  return look_of(settings_.script) + looks_of(script_files_) + looks_of(data_files_);
}

// Files that a working process has read: in the place of those before, or beside them where it
// failed before it had read all.
void StudioSession::watch(const Value* files, bool all, std::set<std::filesystem::path>& watched) {
  if (!files) return;
  std::set<std::filesystem::path> found;
  if (!all) found = watched;
  for (const Value& file : files->as_list()) found.insert(file.as_text());
  if (found == watched) return;
  watched = std::move(found);
  watched_ = look_of_all();
}

// The script's modules.
void StudioSession::watch(const Frame& frame) {
  watch(frame.header.find("files"), frame.header.at("said") != Value("refused"), script_files_);
}

void StudioSession::check_script() {
  Check check;
  check.of_script = true;
  checks_.push_back(std::move(check));
  advance();
}

const Value& StudioSession::base_options() const {
  return pending_script_ ? *pending_script_ : document_->script();
}

Value StudioSession::document_layer() const {
  return layer_of(base_options(), document_->current());
}

// To be looked at: without a journal, and without checks beyond those of the command line.
void StudioSession::look_at(const Value& options) {
  document_.emplace(options);
  if (settings_.laid.as_map().empty()) return;
  Value next = options;
  merge(next, settings_.laid);
  document_->add(document_->entry_for(EntryKind::gesture, "", kWordsLabel, next));
}

void StudioSession::begin_document(const Value& options) {
  if (!editable()) return look_at(options);
  if (journal_->document()) {
    document_ = journal_->document();
  } else {
    try {
      journal_->begin(options);
    } catch (const InputError& error) {  // a full disk: to be looked at
      why_not_ = error.what();
    }
    document_.emplace(options);
  }
  adopt_layer();
  lay_words();
}

// What the command line sets is an edit like another: it stands in the layer, and can be undone.
void StudioSession::lay_words() {
  if (settings_.laid.as_map().empty()) return;
  Proposal proposal;
  proposal.gesture.label = kWordsLabel;
  proposal.of_words = proposal.quiet = true;
  propose(std::move(proposal));
}

// What somebody wrote into the layer's file by hand is an edit. What a studio wrote last may be
// older than its journal: it is written again.
void StudioSession::adopt_layer() {
  if (!why_not_.empty()) return;
  std::optional<LayerFile> file;
  try {
    file = read_layer(settings_.script);
  } catch (const InputError& error) {
    why_not_ = std::string(error.what()) + "; mend or remove it";
    return;
  }
  const bool from_journal = document_->revision() > 0;
  if (!file || (file->as_written && from_journal)) {
    if (from_journal) layer_changed();
    return;
  }
  Proposal proposal;
  proposal.gesture.label = beside_script(settings_.script, ".studio.yaml").filename().string() +
                           (from_journal ? " was edited" : " was found");
  Value next = document_->script();
  merge(next, file->layer);
  proposal.next = std::move(next);
  proposal.quiet = true;
  propose(std::move(proposal));
}

void StudioSession::found_script(const Value& options) {
  if (!script_error_.empty()) {
    script_error_.clear();
    Value loaded = Value::map();
    loaded.set("type", "script_loaded");
    tell_all(loaded);
  }
  remembered_.clear();
  if (!document_) {
    begin_document(options);
    // Whoever was let in while there was none is welcomed again.
    for (auto& [socket, page] : pages_) page.welcomed = false;
  }
  if (description_.empty()) ask_for_description();
  if (same_options(document_->script(), options)) {
    pending_script_.reset();
    solve_document(true);
  } else if (document_->layer().as_map().empty() || !editable()) {
    Proposal proposal;
    proposal.kind = EntryKind::script;
    proposal.gesture.label = "the script changed";
    proposal.script = options;
    proposal.take = StudioDocument::Take::theirs;
    proposal.quiet = true;
    if (editable()) {
      propose(std::move(proposal));
    } else {  // to be looked at: without a history
      const Value before = document_->current();
      look_at(options);
      const Patch patch = difference(before, document_->current());
      Value message = Value::map();
      message.set("type", "document");
      message.set("revision", static_cast<std::int64_t>(document_->revision()));
      message.set("patch", to_value(patch));
      message.set("by", "");
      message.set("label", "the script changed");
      message.set("can_undo", false);
      message.set("can_redo", false);
      tell_all(message);
      solve_document(true);
    }
  } else {
    pending_script_ = options;
    Value message = Value::map();
    message.set("type", "script_changed");
    message.set("conflict", document_->conflicts(options));
    message.set("message", "the script changed on disk; your edits are kept until you choose");
    tell_all(message);
    solve_document(true);
  }
  welcome_all();
}

// ---- proposals ----------------------------------------------------------------------------------

bool StudioSession::take_in(Proposal& proposal) {
  std::size_t waiting = 1, bytes = proposal.bytes;
  Proposal* same = nullptr;
  for (Check& check : checks_) {
    if (check.of_script || check.proposal.quiet) continue;
    ++waiting;
    bytes += check.proposal.bytes;
    const std::string& id = check.proposal.gesture.id;
    if (!id.empty() && id == proposal.gesture.id) same = &check.proposal;
  }
  if (waiting <= kMostWaiting && bytes <= kMostWaitingBytes) return true;
  if (same) {  // said again: whoever said it last is answered
    same->from = proposal.from;
  } else if (!proposal.gesture.id.empty() && document_->has(proposal.gesture.id)) {
    acknowledge(proposal);
  } else {
    const std::string most = waiting > kMostWaiting
                                 ? std::to_string(kMostWaiting) + " edits"
                                 : std::to_string(kMostWaitingBytes >> 20) + " MiB of edits";
    refuse_gesture(proposal, "too many edits at once: " + most +
                                 " may wait to be checked; try again when they are");
  }
  return false;
}

void StudioSession::propose(Proposal proposal) {
  if (!proposal.quiet && !take_in(proposal)) return;
  Check check;
  check.proposal = std::move(proposal);
  checks_.push_back(std::move(check));
  advance();
}

Value StudioSession::next_of(const Proposal& proposal) const {
  const Gesture& gesture = proposal.gesture;
  if (proposal.next) return *proposal.next;
  if (proposal.of_words) {
    Value next = document_->current();
    merge(next, settings_.laid);
    return next;
  }
  switch (proposal.kind) {
    case EntryKind::gesture:
      return document_->proposed(gesture);
    case EntryKind::undo:
    case EntryKind::redo:
      if (gesture.base != document_->revision())
        throw InputError("something else was changed meanwhile: look at it, and ask again");
      return proposal.kind == EntryKind::undo ? document_->undone() : document_->redone();
    case EntryKind::script:
      break;
  }
  if (!proposal.script && !pending_script_)
    throw InputError("the script has not changed, or it was answered already");
  return document_->taken(proposal.script ? *proposal.script : *pending_script_, proposal.take);
}

// Sends the next check, one at a time: each is of the document that the one before left.
void StudioSession::advance() {
  while (!checks_.empty() && checks_.front().serial == 0) {
    Check& check = checks_.front();
    Proposal& proposal = check.proposal;
    if (!check.of_script) {
      if (!proposal.gesture.id.empty() && document_->has(proposal.gesture.id)) {
        acknowledge(proposal);
        checks_.pop_front();
        continue;
      }
      try {
        if (!proposal.quiet && !why_not_.empty()) throw InputError(why_not_);  // found meanwhile
        proposal.next = next_of(proposal);
        if (proposal.kind == EntryKind::script && !proposal.script)
          proposal.script = *pending_script_;
      } catch (const InputError& error) {
        if (proposal.of_words) remark_words(error.what());
        refuse_gesture(proposal, error.what());
        checks_.pop_front();
        continue;
      }
    }
    check.serial = ++serial_;
    const Value& base = proposal.script ? *proposal.script : document_ ? base_options() : Value();
    const Value layer = check.of_script ? Value::map() : layer_of(base, *proposal.next);
    check.frame.header.set("do", "check");
    check.frame.header.set("serial", check.serial);
    check.frame.header.set("layer", layer);
    // What was done before is done again, whatever the mission says of it.
    check.frame.header.set(
        "judge", !check.of_script && proposal.kind == EntryKind::gesture && !proposal.quiet);
    checker_->send(check.frame);
    // Most proposals hold: it is solved meanwhile, where its answer is not known.
    if (!check.of_script && !remembered(to_json(layer, -1))) {
      Solve solve;
      solve.held = true;
      post_solve(layer, std::move(solve));
      check.solve = solve_->serial;
    }
  }
}

void StudioSession::checked(const Frame& frame) {
  if (checks_.empty() || frame.header.at("serial") != Value(checks_.front().serial)) return;
  const Check check = std::move(checks_.front());
  checks_.pop_front();
  mission_name_ = frame.header.at("mission").at("name").as_text();
  mission_kind_ = frame.header.at("mission").at("kind").as_text();
  watch(frame);
  if (check.of_script)
    found_script(frame.header.at("document"));
  else
    commit(check, frame.header.at("document"));
  advance();
}

void StudioSession::not_checked(const Frame& frame) {
  if (checks_.empty() || frame.header.at("serial") != Value(checks_.front().serial)) return;
  const Check check = std::move(checks_.front());
  checks_.pop_front();
  const std::string& why = frame.header.at("why").as_text();
  if (check.of_script) watch(frame);
  if (check.of_script) {
    const Value* line = frame.header.find("line");
    script_error_ = as_utf8(why);
    error_line_ = line ? static_cast<int>(line->as_integer()) : 0;
    Value message = Value::map();
    message.set("type", "script_error");
    message.set("message", script_error_);
    message.set("line", error_line_);
    tell_all(message);
    welcome_all();
  } else {
    refuse_gesture(check.proposal, why);
    // A layer that was found and does not hold is left alone, and nothing is written over it.
    if (check.proposal.of_words)
      remark_words(why);
    else if (check.proposal.quiet && check.proposal.kind == EntryKind::gesture)
      why_not_ = beside_script(settings_.script, ".studio.yaml").string() + ": " + why;
    solve_document();
  }
  advance();
}

void StudioSession::commit(const Check& check, const Value& next) {
  const Proposal& proposal = check.proposal;
  const Gesture& gesture = proposal.gesture;
  const char* label = proposal.kind == EntryKind::script ? "the script changed" : "";
  const std::string said = proposal.kind == EntryKind::undo   ? document_->undo_label()
                           : proposal.kind == EntryKind::redo ? document_->redo_label()
                           : gesture.label.empty()            ? label
                                                              : gesture.label;
  HistoryEntry entry = document_->entry_for(proposal.kind, gesture.id, said, next, proposal.script);
  if (entry.patch.empty() && proposal.kind == EntryKind::gesture) {
    acknowledge(proposal);  // it changes nothing
    return solve_document();
  }
  try {
    if (journal_) journal_->append(entry);
  } catch (const InputError& error) {
    refuse_gesture(proposal, std::string(error.what()) + "; nothing was changed");
    return solve_document();
  }
  Value message = Value::map();
  message.set("type", "document");
  message.set("revision", static_cast<std::int64_t>(entry.revision));
  message.set("patch", to_value(entry.patch));
  message.set("by", gesture.id);
  message.set("label", said);
  document_->add(std::move(entry));
  if (proposal.script) pending_script_.reset();
  message.set("can_undo", document_->can_undo());
  message.set("can_redo", document_->can_redo());
  message.set("undo_label", document_->undo_label());
  message.set("redo_label", document_->redo_label());
  tell_all(message);
  layer_changed();
  document_changed(check.solve);
}

// Whoever asked is told that it is done; nobody else need know.
void StudioSession::acknowledge(const Proposal& proposal) {
  Value message = Value::map();
  message.set("type", "document");
  message.set("revision", static_cast<std::int64_t>(document_->revision()));
  message.set("patch", Value::list());
  message.set("by", proposal.gesture.id);
  message.set("label", proposal.gesture.label);
  message.set("can_undo", document_->can_undo());
  message.set("can_redo", document_->can_redo());
  message.set("undo_label", document_->undo_label());
  message.set("redo_label", document_->redo_label());
  tell(proposal.from, message);
}

// ---- the layer ----------------------------------------------------------------------------------

void StudioSession::layer_changed() {
  if (layer_waits_) return;
  layer_waits_ = true;
  loop_.after(settings_.pause, [this, alive = alive_] {
    if (!*alive || !layer_waits_) return;
    const std::string why = write_layer_now();
    if (!why.empty()) remark(why + "; the journal has every edit, and the next one tries again");
  });
}

void StudioSession::remark_words(const std::string& why) {
  remarks_.push_back(std::string(kWordsLabel) + " were not laid on the film: " + why);
  remark(remarks_.back());
}

void StudioSession::remark(const std::string& what) {
  Value message = Value::map();
  message.set("type", "remark");
  message.set("message", as_utf8(what));
  tell_all(message);
}

std::string StudioSession::write_layer_now() {
  if (!document_ || !journal_) return "";
  layer_waits_ = false;
  if (!why_not_.empty()) return why_not_;  // a layer that is to be mended stays as it is
  try {
    write_layer(settings_.script, document_->revision(), document_layer(), base_options());
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

}  // namespace lapwing
