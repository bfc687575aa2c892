// SPDX-License-Identifier: Apache-2.0
// The document of a studio: a mission's effective configuration under edit, with its history.
//
// Nothing here checks what options mean: whoever commits an entry has asked the mission.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "framework/studio/patch.h"

namespace lapwing {

enum class EntryKind {
  gesture,  // an edit by hand
  undo,     // the last gesture that holds is taken back
  redo,     // and done again
  script,   // the script has changed on disk
};
const char* to_string(EntryKind kind);

struct Gesture {
  std::string id;          // unique
  std::uint64_t base = 0;  // the revision that it was made on
  std::string label;
  Patch patch;
  // Gestures that were on their way when it was made, and that it was made on top of.
  std::vector<std::string> after = {};
};

// What made a revision of the one before. `inverse` takes it back.
struct HistoryEntry {
  std::uint64_t revision = 0;
  EntryKind kind = EntryKind::gesture;
  std::string id, label;
  Patch patch, inverse;
  std::optional<Value> script = {};  // its configuration from now on, of kind `script`
};

// One line of a journal; `history_entry` throws InputError naming what is missing or malformed.
Value to_value(const HistoryEntry& entry);
HistoryEntry history_entry(const Value& value);

class StudioDocument {
 public:
  // Of a script with this configuration, and no edits.
  explicit StudioDocument(Value script = Value::map());

  const Value& script() const { return script_; }
  const Value& current() const { return current_; }
  std::uint64_t revision() const { return history_.size(); }
  const std::vector<HistoryEntry>& history() const { return history_; }
  bool can_undo() const { return !undo_.empty(); }
  bool can_redo() const { return !redo_.empty(); }
  // The labels of what undo and redo concern; "" where there is nothing.
  std::string undo_label() const;
  std::string redo_label() const;
  // Whether an entry has this id already.
  bool has(const std::string& id) const { return ids_.count(id) > 0; }
  // What makes the document of its script.
  Value layer() const { return layer_of(script_, current_); }

  // The document after a gesture. One of an older revision is laid on the newest where nothing that
  // changed since is at its paths, but for those that it was made after. Throws InputError for
  // others, for a revision that there is not, for paths that are not there, and for taking away
  // what the script sets.
  Value proposed(const Gesture& gesture) const;
  // As patches alone, of nobody's history: of drags under way.
  Value proposed(const Patch& patch) const;
  // After undo and redo; InputError where there is nothing to take back or do again.
  Value undone() const;
  Value redone() const;
  // The document for a script that came to have this configuration: `theirs` is the script's alone,
  // `mine` the document as it is, `both` the script's with the edits on it, which win.
  enum class Take { mine, theirs, both };
  Value taken(const Value& script, Take take) const;
  // Whether script and edits changed the same options.
  bool conflicts(const Value& script) const;

  // The entry that makes `next` of the document; nothing changes yet.
  HistoryEntry entry_for(EntryKind kind, std::string id, std::string label, const Value& next,
                         std::optional<Value> script = {}) const;
  // Throws InputError where the entry does not follow; the document is then as it was.
  void add(HistoryEntry entry);
  // The script changed without any edit on it being concerned: no entry.
  void replace_script(Value script) { script_ = std::move(script); }

 private:
  Value script_, current_;
  std::vector<HistoryEntry> history_;
  std::vector<std::size_t> undo_, redo_;  // places in the history, of gestures
  std::set<std::string> ids_;
};

}  // namespace lapwing
