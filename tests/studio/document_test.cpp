// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/document.h"

#include <deque>
#include <random>

#include "framework/core/json.h"

namespace lapwing {
namespace {

Value read_document(const std::string& json) {
  return without_origins(from_json(json, "test"));
}

const char* const kFilm = R"({"margin": 0.5, "weights": {"yaw": 1, "camera": 2},
  "keyframes": [{"time": 0, "position": [0, 0, 2]}, {"time": 5, "position": [4, 0, 2]}]})";

Gesture made(const std::string& id, std::uint64_t base, const char* path, Value value) {
  return {id, base, "label " + id, {{option_path(path), std::move(value)}}};
}

void do_gesture(StudioDocument& document, const Gesture& gesture) {
  document.add(document.entry_for(EntryKind::gesture, gesture.id, gesture.label,
                                  document.proposed(gesture)));
}

void undo(StudioDocument& document) {
  document.add(document.entry_for(EntryKind::undo, "", document.undo_label(), document.undone()));
}

void redo(StudioDocument& document) {
  document.add(document.entry_for(EntryKind::redo, "", document.redo_label(), document.redone()));
}

double at(const StudioDocument& document, const char* path) {
  const OptionPath parsed = option_path(path);
  return find_at(document.current(), parsed, parsed.size())->as_number();
}

TEST(StudioDocument, CountsRevisionsAndTakesThemBack) {
  StudioDocument document(read_document(kFilm));
  EXPECT_THROW(document.undone(), InputError);
  do_gesture(document, made("a", 0, "margin", 0.6));
  do_gesture(document, made("b", 1, "keyframes[2].time", 6));
  EXPECT_EQ(document.revision(), 2u);
  EXPECT_EQ(document.undo_label(), "label b");
  undo(document);
  EXPECT_EQ(at(document, "keyframes[2].time"), 5);
  undo(document);
  EXPECT_FALSE(document.can_undo());
  EXPECT_TRUE(document.layer().as_map().empty());
  redo(document);
  redo(document);
  EXPECT_EQ(at(document, "keyframes[2].time"), 6);
  EXPECT_EQ(at(document, "margin"), 0.6);
  EXPECT_EQ(document.revision(), 6u);
  undo(document);
  do_gesture(document, made("c", 7, "weights.yaw", 3));
  EXPECT_FALSE(document.can_redo());  // another way was taken
  EXPECT_TRUE(document.has("b"));
  EXPECT_FALSE(document.has("d"));
}

TEST(StudioDocument, LaysAnOlderGestureOnTheNewestWhereNothingIsInItsWay) {
  StudioDocument document(read_document(kFilm));
  do_gesture(document, made("a", 0, "margin", 0.6));
  do_gesture(document, made("b", 0, "keyframes[2].time", 6));
  EXPECT_EQ(at(document, "margin"), 0.6);
  EXPECT_THROW(document.proposed(made("c", 0, "margin", 0.7)), InputError);
  EXPECT_THROW(document.proposed(made("c", 1, "keyframes", Value::list())), InputError);
  EXPECT_NO_THROW(document.proposed(made("c", 2, "keyframes", Value::list())));
  EXPECT_THROW(document.proposed(made("c", 3, "margin", 1)), InputError);  // of no revision
}

TEST(StudioDocument, WhatTheScriptSetsIsNotRemoved) {
  StudioDocument document(read_document(kFilm));
  EXPECT_THROW(document.proposed(Patch{{option_path("margin"), std::nullopt}}), InputError);
  do_gesture(document, made("a", 0, "speed", 3));
  do_gesture(document, {"b", 1, "", {{option_path("speed"), std::nullopt}}});
  EXPECT_FALSE(document.current().find("speed"));
  undo(document);
  EXPECT_EQ(at(document, "speed"), 3);
}

TEST(StudioDocument, TakesAChangedScriptThreeWays) {
  const auto edited = [] {
    StudioDocument document(read_document(kFilm));
    do_gesture(document, made("a", 0, "keyframes[2].time", 6));
    do_gesture(document, made("b", 1, "weights.yaw", 3));
    return document;
  };
  Value script = read_document(kFilm);
  apply_patch(script,
              {{option_path("margin"), Value(1)}, {option_path("keyframes[1].time"), Value(1)}});
  using Take = StudioDocument::Take;
  StudioDocument document = edited();
  EXPECT_FALSE(document.conflicts(script));
  EXPECT_TRUE(same_options(document.taken(script, Take::theirs), script));
  EXPECT_TRUE(same_options(document.taken(script, Take::mine), document.current()));
  const Value both = document.taken(script, Take::both);
  EXPECT_EQ(both.at("margin").as_number(), 1);
  EXPECT_EQ(both.at("weights").at("yaw").as_number(), 3);
  EXPECT_EQ(both.at("keyframes").as_list()[0].at("time").as_number(), 1);
  EXPECT_EQ(both.at("keyframes").as_list()[1].at("time").as_number(), 6);
  // A keyframe of ours is gone in theirs: the list is ours whole.
  Value shorter = read_document(kFilm);
  shorter.find("keyframes")->as_list().pop_back();
  EXPECT_TRUE(document.conflicts(shorter));
  EXPECT_EQ(document.taken(shorter, Take::both).at("keyframes").as_list().size(), 2u);
  // Undo of it is a document for the new script.
  document.add(document.entry_for(EntryKind::script, "", "script",
                                  document.taken(script, Take::theirs), script));
  EXPECT_TRUE(document.layer().as_map().empty());
  undo(document);
  EXPECT_EQ(at(document, "keyframes[2].time"), 6);
  EXPECT_EQ(document.layer().at("margin").as_number(), 0.5);
}

TEST(StudioDocument, RefusesAHistoryThatDoesNotFollow) {
  StudioDocument document(read_document(kFilm));
  HistoryEntry entry =
      document.entry_for(EntryKind::gesture, "a", "", document.proposed(made("a", 0, "margin", 1)));
  entry.revision = 3;
  EXPECT_THROW(document.add(entry), InputError);
  entry.revision = 1;
  entry.kind = EntryKind::undo;
  EXPECT_THROW(document.add(entry), InputError);
  EXPECT_EQ(document.revision(), 0u);
  for (const char* bad : {"{}", R"({"revision": 1, "kind": "joke", "id": "", "label": "",
                                    "patch": [], "inverse": []})"})
    EXPECT_THROW(history_entry(read_document(bad)), InputError);
}

// Two tabs edit at random. What the server tells each comes late, and each makes its gestures on
// what it has seen. At the end all three are equal, a replay of the history comes to the same, and
// taking everything back leads to the beginning.
struct Tab {
  Value document;
  std::uint64_t revision = 0;
  std::deque<HistoryEntry> coming;

  void hear_one() {
    if (coming.empty()) return;
    ASSERT_EQ(coming.front().revision, revision + 1);
    apply_patch(document, coming.front().patch);
    revision = coming.front().revision;
    coming.pop_front();
  }
};

Gesture random_gesture(std::mt19937& random, const Tab& tab, int number) {
  const auto below = [&](std::size_t n) { return random() % n; };
  const Value::List& keyframes = tab.document.at("keyframes").as_list();
  Value value(static_cast<double>(below(1000)) / 16);
  std::string path;
  switch (below(6)) {
    case 0:
      path = "margin";
      break;
    case 1:
      path = below(2) == 0 ? "weights.yaw" : "weights.camera";
      break;
    case 2: {
      path = "keyframes";
      Value list(keyframes);
      if (below(2) == 0 && keyframes.size() > 1)
        list.as_list().erase(list.as_list().begin() +
                             static_cast<std::ptrdiff_t>(below(keyframes.size())));
      else
        list.push_back(keyframes[below(keyframes.size())]);
      value = std::move(list);
      break;
    }
    default:
      path = "keyframes[" + std::to_string(1 + below(keyframes.size())) + "]." +
             (below(2) == 0 ? "time" : "position");
      if (path.ends_with("position")) value = Value(Value::List{value, 0.0, 2.0});
  }
  return made(std::to_string(number), tab.revision, path.c_str(), std::move(value));
}

TEST(StudioDocument, AThousandInterleavedEditsOfTwoTabsEndEqual) {
  std::mt19937 random(11);
  const Value script = read_document(kFilm);
  StudioDocument server(script);
  Tab tabs[2] = {{script, 0, {}}, {script, 0, {}}};
  int done = 0, refused = 0, undone = 0;
  for (int k = 0; k < 1000; ++k) {
    Tab& tab = tabs[random() % 2];
    std::optional<HistoryEntry> entry;
    try {
      const auto what = random() % 10;
      if (what == 0 && server.can_undo() && tab.revision == server.revision()) {
        entry = server.entry_for(EntryKind::undo, "", "", server.undone());
        ++undone;
      } else if (what == 1 && server.can_redo() && tab.revision == server.revision()) {
        entry = server.entry_for(EntryKind::redo, "", "", server.redone());
      } else {
        const Gesture gesture = random_gesture(random, tab, k);
        const Value next = server.proposed(gesture);
        entry = server.entry_for(EntryKind::gesture, gesture.id, "", next);
        ++done;
      }
    } catch (const InputError&) {
      ++refused;  // and told: the tab hears of what was in its way
    }
    if (entry) {
      for (Tab& each : tabs) each.coming.push_back(*entry);
      server.add(*entry);
    }
    for (Tab& each : tabs)
      for (auto n = random() % 4; n > 0; --n) each.hear_one();
  }
  for (Tab& each : tabs)
    while (!each.coming.empty()) each.hear_one();
  EXPECT_TRUE(same_options(tabs[0].document, server.current()));
  EXPECT_TRUE(same_options(tabs[1].document, server.current()));
  EXPECT_GT(done, 500);
  EXPECT_GT(refused, 20);
  EXPECT_GT(undone, 20);
  StudioDocument replayed(script);
  for (const HistoryEntry& entry : server.history())
    replayed.add(
        history_entry(without_origins(from_json(to_json(to_value(entry), -1), "journal"))));
  EXPECT_EQ(to_json(replayed.current()), to_json(server.current()));
  while (server.can_undo()) undo(server);
  EXPECT_TRUE(same_options(server.current(), script));
}

}  // namespace
}  // namespace lapwing
