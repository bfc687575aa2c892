// SPDX-License-Identifier: Apache-2.0
// What a page says to the server (PROTOCOL.md).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "framework/studio/document.h"

namespace lapwing {

enum class PageMessageType {
  hello,
  preview,
  gesture,
  undo,
  redo,
  rest,
  resolve_script,
  fly,
  picture,
  export_plan,  // "export"
  save_report,
  export_lua,
  race,
  stick,
  list_runs,
  open_run,
  pace,
  voxel,
  slice,
  left_out,
  view,
  backdrop,  // no page says it: the server's own errand
};
// Of the planning of an exploration.
enum class Pace { run, pause, step };
const char* to_string(PageMessageType type);

struct PageMessage {
  PageMessageType type = PageMessageType::hello;
  std::string token, tab;  // hello
  std::uint64_t seen = 0;  // hello
  // Of gesture and what follows it one each; of `stick` that of its `race`.
  std::string id, label;
  std::uint64_t base = 0;               // revision
  std::uint64_t edit = 0;               // preview, fly, picture
  Patch patch;                          // preview, gesture
  std::vector<std::string> after = {};  // gesture: the ids that it was made on top of
  StudioDocument::Take take = StudioDocument::Take::mine;
  std::array<double, 3> wind{};  // m/s
  double gust = 0;               // m/s
  double mass = 0;               // largest error, a share
  int runs = 1;                  // flights
  std::uint64_t seed = 1;
  double time = 0;                  // s; of stick, from the start of the race
  int width = 0, height = 0;        // pixels
  std::size_t tour = 0;             // fly, picture, export: of several batteries, from 0
  std::string format;               // of export
  Value parameters = Value::map();  // of the exporter
  bool uncertified = false;
  Pace pace = Pace::run;
  std::string folder;                              // open_run: a name in out/
  Value players = Value::list();                   // race: names and numbers of each
  std::vector<std::array<double, 2>> sticks = {};  // of stick: forward and left, -1 to 1
  std::vector<double> at = {};  // voxel: a place, or where a ray begins and whither; slice: m
  int axis = 2;                 // of slice: 0 is x
  bool of_tour = false;         // view: `view` is an image of `tour`, else a candidate
  std::size_t view = 0;         // from 0
  // voxel, slice, of explorations: so many images are in the map; `folder` names a run, or none.
  std::optional<int> images = {};
  std::size_t bytes = 0;  // of its text
};

// Of a picture, each way.
inline constexpr int kLargestPicture = 2048;  // pixels

// Throws InputError naming the field for what is no message: JSON that is not one, unknown types,
// fields that are missing, unknown, of another type or out of range.
PageMessage page_message(std::string_view text);

}  // namespace lapwing
