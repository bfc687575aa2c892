// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/page_message.h"

#include <algorithm>
#include <cmath>

#include "framework/core/json.h"

namespace lapwing {
namespace {

using Type = PageMessageType;

constexpr std::size_t kLongestName = 128;  // bytes, of ids, tabs and formats
constexpr std::size_t kLongestLabel = 400;
constexpr std::size_t kLongestFolder = 255;
constexpr std::size_t kMostAfter = 64;  // as many as may wait
constexpr std::size_t kMostPlayers = 8;
constexpr std::int64_t kLargestNumber = (std::int64_t{1} << 53) - 1;

constexpr std::array kTypes{
    Type::hello,       Type::preview,        Type::gesture, Type::undo,      Type::redo,
    Type::rest,        Type::resolve_script, Type::fly,     Type::picture,   Type::export_plan,
    Type::save_report, Type::export_lua,     Type::race,    Type::stick,     Type::voxel,
    Type::slice,       Type::left_out,       Type::view,    Type::list_runs, Type::open_run,
    Type::pace};

Type type_named(const std::string& name) {
  for (const Type type : kTypes)
    if (name == to_string(type)) return type;
  throw InputError("type: '" + name.substr(0, kLongestName) + "' is not a message of a page");
}

// Reads each field once, and tells what nobody read.
class MessageFields {
 public:
  explicit MessageFields(const Value& message) : message_(message) {}

  const Value& at(const char* name) {
    const Value* found = find(name);
    if (!found) throw InputError(std::string(name) + ": missing");
    return *found;
  }
  const Value* find(const char* name) {
    ++read_;
    const Value* found = message_.find(name);
    if (!found) --read_;
    return found;
  }
  bool has(const char* name) const { return message_.find(name) != nullptr; }
  std::string text(const char* name, std::size_t longest, bool may_be_empty = false) {
    const Value& value = at(name);
    const bool fits = value.is_text() && value.as_text().size() <= longest &&
                      (may_be_empty || !value.as_text().empty());
    if (!fits)
      throw InputError(std::string(name) + ": expected a text of at most " +
                       std::to_string(longest) + " bytes");
    return value.as_text();
  }
  std::int64_t count(const char* name, std::int64_t least, std::int64_t most) {
    const Value& value = at(name);
    const bool whole = value.is_number() && std::abs(value.as_number()) <= kLargestNumber &&
                       value.as_number() == std::floor(value.as_number());
    if (!whole || value.as_number() < static_cast<double>(least) ||
        value.as_number() > static_cast<double>(most))
      throw InputError(std::string(name) + ": expected a whole number from " +
                       std::to_string(least) + " to " + std::to_string(most));
    return static_cast<std::int64_t>(value.as_number());
  }
  double number(const char* name, double least, double most) {
    return checked(at(name), name, least, most);
  }
  static double checked(const Value& value, const char* name, double least, double most) {
    if (!value.is_number() || !(value.as_number() >= least && value.as_number() <= most))
      throw InputError(std::string(name) + ": expected a number from " + std::to_string(least) +
                       " to " + std::to_string(most));
    return value.as_number();
  }
  void require_all_read() const {
    if (message_.as_map().size() == read_) return;
    throw InputError("a field that '" + message_.at("type").as_text() + "' does not have");
  }

 private:
  const Value& message_;
  std::size_t read_ = 1;  // `type`
};

void read_edit(MessageFields& fields, PageMessage& message) {
  message.edit = static_cast<std::uint64_t>(fields.count("edit", 0, kLargestNumber));
}

void read_id(MessageFields& fields, PageMessage& message) {
  message.id = fields.text("id", kLongestName);
}

void read_base(MessageFields& fields, PageMessage& message) {
  message.base = static_cast<std::uint64_t>(fields.count("base", 0, kLargestNumber));
}

void read_after(MessageFields& fields, PageMessage& message) {
  const Value* after = fields.find("after");
  if (!after) return;
  const auto is_id = [](const Value& id) {
    return id.is_text() && !id.as_text().empty() && id.as_text().size() <= kLongestName;
  };
  if (!after->is_list() || after->as_list().size() > kMostAfter ||
      !std::all_of(after->as_list().begin(), after->as_list().end(), is_id))
    throw InputError("after: expected a list of at most " + std::to_string(kMostAfter) + " ids");
  for (const Value& id : after->as_list()) message.after.push_back(id.as_text());
}

StudioDocument::Take take_named(const std::string& name) {
  if (name == "mine") return StudioDocument::Take::mine;
  if (name == "theirs") return StudioDocument::Take::theirs;
  if (name == "both") return StudioDocument::Take::both;
  throw InputError("take: expected mine, theirs or both");
}

void read_tour(MessageFields& fields, PageMessage& message) {
  const Value* tour = fields.find("tour");
  if (!tour) return;
  const double number = MessageFields::checked(*tour, "tour", 0, 999);
  if (number != std::floor(number)) throw InputError("tour: expected a whole number");
  message.tour = static_cast<std::size_t>(number);
}

void read_flight(MessageFields& fields, PageMessage& message) {
  constexpr double kStrongest = 100;  // m/s
  constexpr double kLargestMassError = 0.5;
  constexpr double kMostRuns = 200;
  read_edit(fields, message);
  const Value& wind = fields.at("wind");
  if (!wind.is_list() || wind.as_list().size() != 3)
    throw InputError("wind: expected three numbers, m/s");
  for (std::size_t i = 0; i < 3; ++i)
    message.wind[i] = MessageFields::checked(wind.as_list()[i], "wind", -kStrongest, kStrongest);
  if (message.wind[2] != 0) throw InputError("wind: it blows horizontally; the third number is 0");
  if (const Value* gust = fields.find("gust"))
    message.gust = MessageFields::checked(*gust, "gust", 0, kStrongest);
  if (const Value* mass = fields.find("mass"))
    message.mass = MessageFields::checked(*mass, "mass", 0, kLargestMassError);
  if (const Value* runs = fields.find("runs")) {
    const double number = MessageFields::checked(*runs, "runs", 1, kMostRuns);
    if (number != std::floor(number)) throw InputError("runs: expected a whole number");
    message.runs = static_cast<int>(number);
  }
  message.seed = static_cast<std::uint64_t>(fields.count("seed", 0, kLargestNumber));
  read_tour(fields, message);
}

void read_picture(MessageFields& fields, PageMessage& message) {
  read_edit(fields, message);
  message.time = fields.number("time", 0, 1e6);
  message.width = static_cast<int>(fields.count("width", 1, kLargestPicture));
  message.height = static_cast<int>(fields.count("height", 1, kLargestPicture));
  read_tour(fields, message);
}

void read_export(MessageFields& fields, PageMessage& message) {
  read_id(fields, message);
  message.format = fields.text("format", kLongestName);
  if (const Value* parameters = fields.find("parameters")) {
    if (!parameters->is_map()) throw InputError("parameters: expected an object");
    message.parameters = *parameters;
  }
  if (const Value* uncertified = fields.find("uncertified")) {
    if (uncertified->type() != Value::Type::boolean)
      throw InputError("uncertified: expected true or false");
    message.uncertified = uncertified->as_boolean();
  }
  read_tour(fields, message);
}

const Value::List& list_of_players(MessageFields& fields, const char* name) {
  const Value& value = fields.at(name);
  if (!value.is_list() || value.as_list().empty() || value.as_list().size() > kMostPlayers)
    throw InputError(std::string(name) + ": expected a list of 1 to " +
                     std::to_string(kMostPlayers));
  return value.as_list();
}

void read_race(MessageFields& fields, PageMessage& message) {
  read_id(fields, message);
  const Value::List& players = list_of_players(fields, "players");
  for (const Value& player : players)
    if (!player.is_map()) throw InputError("players: expected objects");
  message.players = Value(players);
}

void read_sticks(MessageFields& fields, PageMessage& message) {
  read_id(fields, message);
  message.time = fields.number("time", 0, 1e5);
  for (const Value& stick : list_of_players(fields, "sticks")) {
    if (!stick.is_list() || stick.as_list().size() != 2)
      throw InputError("sticks: expected forward and left of each player");
    message.sticks.push_back({MessageFields::checked(stick.as_list()[0], "sticks", -1, 1),
                              MessageFields::checked(stick.as_list()[1], "sticks", -1, 1)});
  }
}

Pace pace_named(const std::string& name) {
  if (name == "run") return Pace::run;
  if (name == "pause") return Pace::pause;
  if (name == "step") return Pace::step;
  throw InputError("pace: expected run, pause or step");
}

// One name: what lies elsewhere is not a page's to read.
void read_folder(MessageFields& fields, PageMessage& message) {
  message.folder = fields.text("folder", kLongestFolder);
  if (message.folder.find('/') != std::string::npos || message.folder.starts_with("."))
    throw InputError("folder: expected the name of a folder in out/, as explore_city, not '" +
                     message.folder + "'");
}

void read_run(MessageFields& fields, PageMessage& message) {
  read_id(fields, message);
  read_folder(fields, message);
}

// Of explorations: the map after so many images.
void read_images(MessageFields& fields, PageMessage& message) {
  constexpr std::int64_t kMostImages = 1000000;
  if (!fields.has("image")) {
    if (fields.has("folder")) throw InputError("image: missing beside folder");
    return;
  }
  message.images = static_cast<int>(fields.count("image", 0, kMostImages));
  if (fields.has("folder")) read_folder(fields, message);
}

constexpr double kFarthest = 1e7;  // m

void read_numbers(MessageFields& fields, const char* name, std::size_t count,
                  PageMessage& message) {
  const Value& numbers = fields.at(name);
  if (!numbers.is_list() || numbers.as_list().size() != count)
    throw InputError(std::string(name) + ": expected " + std::to_string(count) + " numbers");
  for (const Value& number : numbers.as_list())
    message.at.push_back(MessageFields::checked(number, name, -kFarthest, kFarthest));
}

// One field of two.
bool has_first(MessageFields& fields, const char* first, const char* second) {
  const bool one = fields.has(first), two = fields.has(second);
  if (one == two) throw InputError(std::string("expected either ") + first + " or " + second);
  return one;
}

void read_voxel(MessageFields& fields, PageMessage& message) {
  read_id(fields, message);
  if (has_first(fields, "ray", "position"))
    read_numbers(fields, "ray", 6, message);
  else
    read_numbers(fields, "position", 3, message);
  read_images(fields, message);
}

void read_slice(MessageFields& fields, PageMessage& message) {
  read_id(fields, message);
  const std::string axis = fields.text("axis", kLongestName);
  if (axis != "x" && axis != "y" && axis != "z") throw InputError("axis: expected x, y or z");
  message.axis = axis.front() - 'x';
  message.at = {fields.number("at", -kFarthest, kFarthest)};
  read_images(fields, message);
}

void read_view(MessageFields& fields, PageMessage& message) {
  read_id(fields, message);
  message.of_tour = has_first(fields, "image", "candidate");
  message.view = static_cast<std::size_t>(
      fields.count(message.of_tour ? "image" : "candidate", 0, kLargestNumber));
  if (message.of_tour) read_tour(fields, message);
}

void read_fields(MessageFields& fields, PageMessage& message) {
  switch (message.type) {
    case Type::hello:
      message.token = fields.text("token", kLongestName);
      message.tab = fields.text("tab", kLongestName);
      message.seen = static_cast<std::uint64_t>(fields.count("seen", 0, kLargestNumber));
      return;
    case Type::preview:
      read_edit(fields, message);
      message.patch = patch_from(fields.at("patch"), "patch");
      return;
    case Type::gesture:
      read_id(fields, message);
      read_base(fields, message);
      message.label = fields.text("label", kLongestLabel, true);
      message.patch = patch_from(fields.at("patch"), "patch");
      read_after(fields, message);
      return;
    case Type::undo:
    case Type::redo:
      read_id(fields, message);
      read_base(fields, message);
      return;
    case Type::rest:
      return;
    case Type::resolve_script:
      message.take = take_named(fields.text("take", kLongestName));
      return;
    case Type::fly:
      return read_flight(fields, message);
    case Type::picture:
      return read_picture(fields, message);
    case Type::export_plan:
      return read_export(fields, message);
    case Type::save_report:
    case Type::export_lua:
    case Type::list_runs:
      return read_id(fields, message);
    case Type::open_run:
      return read_run(fields, message);
    case Type::pace:
      message.pace = pace_named(fields.text("pace", kLongestName));
      return;
    case Type::race:
      return read_race(fields, message);
    case Type::stick:
      return read_sticks(fields, message);
    case Type::voxel:
      return read_voxel(fields, message);
    case Type::slice:
      return read_slice(fields, message);
    case Type::left_out:
      return read_id(fields, message);
    case Type::view:
      return read_view(fields, message);
    case Type::backdrop:
      return;
  }
}

}  // namespace

const char* to_string(PageMessageType type) {
  switch (type) {
    case Type::hello:
      return "hello";
    case Type::preview:
      return "preview";
    case Type::gesture:
      return "gesture";
    case Type::undo:
      return "undo";
    case Type::redo:
      return "redo";
    case Type::rest:
      return "rest";
    case Type::resolve_script:
      return "resolve_script";
    case Type::fly:
      return "fly";
    case Type::picture:
      return "picture";
    case Type::export_plan:
      return "export";
    case Type::save_report:
      return "save_report";
    case Type::export_lua:
      return "export_lua";
    case Type::race:
      return "race";
    case Type::stick:
      return "stick";
    case Type::list_runs:
      return "list_runs";
    case Type::open_run:
      return "open_run";
    case Type::pace:
      return "pace";
    case Type::voxel:
      return "voxel";
    case Type::slice:
      return "slice";
    case Type::left_out:
      return "left_out";
    case Type::view:
      return "view";
    case Type::backdrop:
      return "backdrop";
  }
  return "";
}

PageMessage page_message(std::string_view text) {
  const Value value = without_origins(from_json(text, "message"));
  const Value* type = value.find("type");
  if (!type || !type->is_text()) throw InputError("expected an object with a text `type`");
  PageMessage message;
  message.bytes = text.size();
  message.type = type_named(type->as_text());
  MessageFields fields(value);
  read_fields(fields, message);
  fields.require_all_read();
  return message;
}

}  // namespace lapwing
