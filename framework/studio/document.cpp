// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/document.h"

#include <algorithm>
#include <array>

namespace lapwing {
namespace {

constexpr std::array kKinds{EntryKind::gesture, EntryKind::undo, EntryKind::redo,
                            EntryKind::script};

EntryKind kind_of(const std::string& name) {
  for (const EntryKind kind : kKinds)
    if (name == to_string(kind)) return kind;
  throw InputError("kind: expected gesture, undo, redo or script, got '" + name + "'");
}

// What the script sets stays there: a configuration can change it, never take it away.
void require_removable(const Patch& patch, const Value& script) {
  for (const Change& change : patch) {
    if (change.value) continue;
    bool in_list = false;
    for (const PathStep& step : change.path) in_list = in_list || step.index > 0;
    if (!in_list && find_at(script, change.path, change.path.size()))
      throw InputError(to_text(change.path) +
                       ": the script sets it, or its kind has a default: it can be changed, and "
                       "not removed");
  }
}

}  // namespace

const char* to_string(EntryKind kind) {
  switch (kind) {
    case EntryKind::gesture:
      return "gesture";
    case EntryKind::undo:
      return "undo";
    case EntryKind::redo:
      return "redo";
    case EntryKind::script:
      return "script";
  }
  return "";
}

Value to_value(const HistoryEntry& entry) {
  Value value = Value::map();
  value.set("revision", static_cast<std::int64_t>(entry.revision));
  value.set("kind", to_string(entry.kind));
  value.set("id", entry.id);
  value.set("label", entry.label);
  value.set("patch", to_value(entry.patch));
  value.set("inverse", to_value(entry.inverse));
  if (entry.script) value.set("script", *entry.script);
  return value;
}

HistoryEntry history_entry(const Value& value) {
  HistoryEntry entry;
  entry.revision = static_cast<std::uint64_t>(value.at("revision").as_integer());
  entry.kind = kind_of(value.at("kind").as_text());
  entry.id = value.at("id").as_text();
  entry.label = value.at("label").as_text();
  entry.patch = patch_from(value.at("patch"), "patch");
  entry.inverse = patch_from(value.at("inverse"), "inverse");
  if (const Value* script = value.find("script")) entry.script = *script;
  return entry;
}

StudioDocument::StudioDocument(Value script) : script_(script), current_(std::move(script)) {}

std::string StudioDocument::undo_label() const {
  return undo_.empty() ? "" : history_[undo_.back()].label;
}
std::string StudioDocument::redo_label() const {
  return redo_.empty() ? "" : history_[redo_.back()].label;
}

Value StudioDocument::proposed(const Patch& patch) const {
  require_removable(patch, script_);
  Value next = current_;
  apply_patch(next, patch);
  return next;
}

Value StudioDocument::proposed(const Gesture& gesture) const {
  if (gesture.base > revision())
    throw InputError("made on revision " + std::to_string(gesture.base) +
                     ", which there is not: the newest is " + std::to_string(revision()));
  for (const std::string& id : gesture.after)
    if (!has(id)) throw InputError("it was made on top of an edit that was refused");
  const auto known = [&](const std::string& id) {
    return !id.empty() &&
           std::find(gesture.after.begin(), gesture.after.end(), id) != gesture.after.end();
  };
  for (std::size_t i = gesture.base; i < history_.size(); ++i)
    if (!known(history_[i].id) && overlap(history_[i].patch, gesture.patch))
      throw InputError("the same was changed meanwhile (" + history_[i].label +
                       "): do it again on what is there now");
  return proposed(gesture.patch);
}

Value StudioDocument::undone() const {
  if (undo_.empty()) throw InputError("there is nothing to undo");
  Value next = current_;
  apply_patch(next, history_[undo_.back()].inverse);
  return next;
}

Value StudioDocument::redone() const {
  if (redo_.empty()) throw InputError("there is nothing to redo");
  Value next = current_;
  apply_patch(next, history_[redo_.back()].patch);
  return next;
}

Value StudioDocument::taken(const Value& script, Take take) const {
  if (take == Take::mine) return current_;
  if (take == Take::theirs) return script;
  Value next = script;
  for (const Change& change : difference(script_, current_)) {
    // What is no longer there as it was: the list that it is in, or the option, is the edited one.
    Patch one{change};
    for (;;) {
      try {
        apply_patch(next, one);
        break;
      } catch (const InputError&) {
        OptionPath& path = one.front().path;
        if (path.size() == 1) break;  // taken away twice
        path.pop_back();
        const Value* edited = find_at(current_, path, path.size());
        one.front().value = edited ? std::optional<Value>(*edited) : std::nullopt;
      }
    }
  }
  return next;
}

bool StudioDocument::conflicts(const Value& script) const {
  return overlap(difference(script_, script), difference(script_, current_));
}

HistoryEntry StudioDocument::entry_for(EntryKind kind, std::string id, std::string label,
                                       const Value& next, std::optional<Value> script) const {
  HistoryEntry entry;
  entry.revision = revision() + 1;
  entry.kind = kind;
  entry.id = std::move(id);
  entry.label = std::move(label);
  entry.patch = difference(current_, next);
  entry.script = std::move(script);
  Value changed = current_;
  entry.inverse = apply_patch(changed, entry.patch);
  return entry;
}

void StudioDocument::add(HistoryEntry entry) {
  if (entry.revision != revision() + 1)
    throw InputError("revision " + std::to_string(entry.revision) + " follows revision " +
                     std::to_string(revision()));
  if (entry.kind == EntryKind::undo && undo_.empty()) throw InputError("an undo of nothing");
  if (entry.kind == EntryKind::redo && redo_.empty()) throw InputError("a redo of nothing");
  apply_patch(current_, entry.patch);
  if (entry.kind == EntryKind::undo) {
    redo_.push_back(undo_.back());
    undo_.pop_back();
  } else if (entry.kind == EntryKind::redo) {
    undo_.push_back(redo_.back());
    redo_.pop_back();
  } else {
    undo_.push_back(history_.size());
    redo_.clear();
  }
  if (entry.script) script_ = *entry.script;
  if (!entry.id.empty()) ids_.insert(entry.id);
  history_.push_back(std::move(entry));
}

}  // namespace lapwing
