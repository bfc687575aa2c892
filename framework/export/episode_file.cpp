// SPDX-License-Identifier: Apache-2.0
#include "framework/export/episode_file.h"

#include <bit>
#include <cstring>

#include "framework/core/checksum.h"
#include "framework/core/error.h"
#include "framework/core/fields.h"
#include "framework/core/files.h"
#include "framework/core/json.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little);

constexpr int kFormat = 1;
constexpr const char* kEpisode = "episode.json";
constexpr const char* kGrowth = "episode_growth.bin";
constexpr const char* kSights = "episode_sights.bin";
constexpr std::size_t kHead = 4;  // bytes, of the text that a binary file begins with

Value triple(const Eigen::Vector3d& v) {
  return Value(Value::List{v.x(), v.y(), v.z()});
}

template <class Number>
void add_number(std::string& bytes, Number number) {
  static_assert(sizeof number == 4);
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

template <class Number>
Number number_at(const std::string& bytes, std::size_t place) {
  Number number;
  std::memcpy(&number, bytes.data() + place, sizeof number);
  return number;
}

void add_slices(std::string& bytes, const std::vector<Picture>& slices) {
  for (const Picture& slice : slices)
    for (std::size_t i = 0; i < slice.rgb.size(); i += 3)
      bytes.push_back(static_cast<char>(slice.rgb[i]));
}

// What read_episode reads back of exploration_value.
ExplorationRecord record_from(Fields fields) {
  ExplorationRecord record;
  record.utility = fields.text("utility");
  record.end = fields.text("end");
  record.surface = fields.number("surface");
  record.efficiency = fields.number("efficiency");
  record.per_second = fields.boolean("per_second");
  record.resolution = fields.number("resolution");
  for (Fields image : fields.tables("images")) {
    ExplorationImage one;
    one.time = image.number("time");
    one.position = image.vector3("position");
    one.yaw = image.number("yaw");
    one.pitch = image.number("pitch");
    one.value = image.number("value");
    one.scored = image.integer("scored", 0, std::numeric_limits<int>::max());
    record.observed.push_back(image.number("observed"));
    image.finish();
    record.images.push_back(one);
  }
  record.oracle = fields.numbers("oracle");
  for (Fields candidate : fields.tables("candidates")) {
    ExplorationCandidate one;
    one.position = candidate.vector3("position");
    one.direction = candidate.vector3("direction");
    one.value = candidate.number("value");
    candidate.finish();
    record.candidates.push_back(one);
  }
  fields.finish();
  return record;
}

std::string part_of(const fs::path& folder, const std::string& name, const std::string& checksum) {
  std::string bytes = read_file(folder / name);
  if (sha256(bytes) != checksum)
    throw InputError("'" + (folder / name).string() +
                     "' is not the file that episode.json was written with: it was changed or "
                     "damaged; run the mission again");
  return bytes;
}

// Whether the head of a binary file of so many entries fits its size.
void require_whole(const std::string& bytes, const char* head, std::size_t size,
                   const fs::path& path) {
  if (!bytes.starts_with(head) || bytes.size() != size)
    throw InputError("'" + path.string() + "' is damaged: it has " + std::to_string(bytes.size()) +
                     " bytes, not " + std::to_string(size));
}

void require_growth(const std::string& bytes, const fs::path& path) {
  constexpr std::size_t kStart = kHead + 8;
  const std::size_t count = bytes.size() < kStart ? 0 : number_at<std::uint32_t>(bytes, kHead);
  require_whole(bytes, "WLG1", kStart + sizeof(GrownVoxel) * count, path);
}

void require_sights(const std::string& bytes, std::size_t images, const fs::path& path) {
  constexpr std::size_t kStart = kHead + 16;
  const auto count = [&](std::size_t k) -> std::size_t {
    return bytes.size() < kStart ? 0 : number_at<std::uint32_t>(bytes, kHead + 4 * k);
  };
  const std::size_t each = 2 * count(2) * count(1) * count(1) + sizeof(ExplorationRay) * count(3);
  require_whole(bytes, "WLE1", kStart + 4 * count(2) + each * images, path);
  if (count(0) != images)
    throw InputError("'" + path.string() + "' is of " + std::to_string(count(0)) +
                     " images, episode.json of " + std::to_string(images));
}

// With why there is none.
std::string episode_text(const fs::path& folder) {
  std::error_code code;
  const std::string named = "'" + folder.string() + "'";
  if (!fs::is_directory(folder, code)) throw InputError(named + " is no folder");
  if (fs::exists(folder / kEpisode, code)) return read_file(folder / kEpisode);
  if (!fs::exists(folder / "plan.json", code))
    throw InputError(named + " is not the folder of a run: it has no plan.json");
  const std::string kind = read_plan(folder / "plan.json").kind;
  if (kind != "explore")
    throw InputError(named + " is of a mission of kind '" + kind + "': only explorations have " +
                     "episodes");
  throw InputError(named +
                   " has no episode.json: a version of lapwing that wrote none has run it; " +
                   "run the mission again");
}

}  // namespace

Value exploration_value(const ExplorationRecord& record) {
  Value value = Value::map();
  value.set("utility", record.utility);
  value.set("end", record.end);
  value.set("surface", record.surface);
  value.set("efficiency", record.efficiency);
  value.set("per_second", record.per_second);
  value.set("resolution", record.resolution);
  Value& images = value.set("images", Value::list());
  for (std::size_t k = 0; k < record.images.size(); ++k)
    images.push_back(image_value(record.images[k], record.observed[k]));
  value.set("oracle", Value(Value::List(record.oracle.begin(), record.oracle.end())));
  Value& candidates = value.set("candidates", Value::list());
  for (const ExplorationCandidate& candidate : record.candidates) {
    Value one = Value::map();
    one.set("position", triple(candidate.position));
    one.set("direction", triple(candidate.direction));
    one.set("value", candidate.value);
    candidates.push_back(std::move(one));
  }
  return value;
}

Value image_value(const ExplorationImage& image, double observed) {
  Value one = Value::map();
  one.set("time", image.time);
  one.set("position", triple(image.position));
  one.set("yaw", image.yaw);
  one.set("pitch", image.pitch);
  one.set("value", image.value);
  one.set("scored", std::int64_t{image.scored});
  one.set("observed", observed);
  return one;
}

std::string growth_bytes(const ExplorationRecord& record) {
  static_assert(sizeof(GrownVoxel) == 16);
  std::string bytes = "WLG1";
  add_number(bytes, static_cast<std::uint32_t>(record.growth.size()));
  add_number(bytes, static_cast<float>(record.resolution));
  bytes.append(reinterpret_cast<const char*>(record.growth.data()),
               record.growth.size() * sizeof(GrownVoxel));
  return bytes;
}

std::string sights_bytes(const std::vector<ExplorationSight>& sights) {
  static_assert(sizeof(ExplorationRay) == 20);
  const ExplorationSight none;
  const ExplorationSight& first = sights.empty() ? none : sights.front();
  std::string bytes = "WLE1";
  for (const std::size_t count : {sights.size(), static_cast<std::size_t>(first.grid.points),
                                  first.grid.edges.size(), first.rays.size()})
    add_number(bytes, static_cast<std::uint32_t>(count));
  for (const double edge : first.grid.edges) add_number(bytes, static_cast<float>(edge));
  for (const ExplorationSight& sight : sights) {
    add_slices(bytes, sight.grid.occupancy);
    add_slices(bytes, sight.grid.certainty);
    bytes.append(reinterpret_cast<const char*>(sight.rays.data()),
                 sight.rays.size() * sizeof(ExplorationRay));
  }
  return bytes;
}

NamedContents episode_files(const ExplorationRecord& record, const std::string& plan,
                            const std::string& program) {
  NamedContents files{{kGrowth, growth_bytes(record)}, {kSights, sights_bytes(record.sights)}};
  Value value = Value::map();
  value.set("format", kFormat);
  value.set("program", program);
  value.set("plan", sha256(plan));
  value.set("growth", sha256(files[0].second));
  value.set("sights", sha256(files[1].second));
  value.set("exploration", exploration_value(record));
  files.emplace_back(kEpisode, to_json(value) + "\n");
  return files;
}

ShownEpisode read_episode(const fs::path& folder, const std::string& program) {
  const std::string path = (folder / kEpisode).string();
  const Value value = from_json(episode_text(folder), path);
  Diagnostics errors;
  Fields fields(value, path, errors);
  const std::int64_t format = fields.integer("format");
  const std::string writer = fields.text("program");
  errors.throw_if_any();
  if (format != kFormat || writer != program)
    throw InputError("'" + path + "' was written by " + writer + " in format " +
                     std::to_string(format) + "; this is " + program + ", which shows format " +
                     std::to_string(kFormat) +
                     " of its own version: run the mission again, or show it with that version");
  const std::string plan = fields.text("plan"), growth = fields.text("growth"),
                    sights = fields.text("sights");
  const ExplorationRecord record = record_from(fields.table("exploration"));
  fields.finish();
  errors.throw_if_any();
  ShownEpisode shown;
  shown.plan = plan_from_value(
      from_json(part_of(folder, "plan.json", plan), (folder / "plan.json").string()));
  shown.growth = part_of(folder, kGrowth, growth);
  shown.sights = part_of(folder, kSights, sights);
  require_growth(shown.growth, folder / kGrowth);
  require_sights(shown.sights, record.images.size(), folder / kSights);
  shown.exploration = exploration_value(record);
  return shown;
}

}  // namespace lapwing
