// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/worker_looks.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "framework/core/json.h"
#include "framework/core/number_text.h"
#include "framework/core/png.h"
#include "framework/core/units.h"
#include "framework/geometry/camera_axes.h"
#include "framework/map/map_look.h"
#include "framework/picture/mesh_picture.h"

namespace lapwing {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kMostLookedAt = 4;
constexpr std::size_t kSmall = std::size_t{64} << 20;     // bytes of a graph
constexpr std::size_t kMostCells = std::size_t{1} << 20;  // of a slice
constexpr int kPictureAcross = 320, kPictureDown = 240;   // pixels at most

Value list_of(const Eigen::Vector3d& v) {
  return Value(Value::List{v.x(), v.y(), v.z()});
}

Eigen::Vector3d vector_in(const Value& list, std::size_t first = 0) {
  const auto& numbers = list.as_list();
  return {numbers.at(first).as_number(), numbers.at(first + 1).as_number(),
          numbers.at(first + 2).as_number()};
}

// Bytes of a blob: a text of four letters, then 32-bit little-endian numbers.
class BlobBytes {
 public:
  explicit BlobBytes(const char* name) : bytes_(name) {}
  template <class Number>
  BlobBytes& add(Number number) {
    static_assert(sizeof number == 4);
    bytes_.append(reinterpret_cast<const char*>(&number), sizeof number);
    return *this;
  }
  BlobBytes& add(const Eigen::Vector3d& v) {
    for (int i = 0; i < 3; ++i) add(static_cast<float>(v[i]));
    return *this;
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

// `parts`: the members of the answer as an object, then the blobs that `blobs` names.
Frame told(const Value& members) {
  Frame frame;
  frame.header.set("said", "done");
  frame.header.set("blobs", Value::list());
  frame.parts.push_back(to_json(members, -1));
  return frame;
}

void add_blob(Frame& frame, const char* name, std::string bytes) {
  frame.header.find("blobs")->push_back(name);
  frame.parts.push_back(std::move(bytes));
}

const char* name_of(const VoxelReading& reading) {
  if (!reading.known) return "unknown";
  return reading.state == VoxelState::free       ? "free"
         : reading.state == VoxelState::occupied ? "occupied"
                                                 : "between";
}

VoxelKey asked_voxel(const Frame& question, const Map& map) {
  const Value& at = question.header.at("at");
  if (at.as_list().size() == 3) {
    const Eigen::Vector3d p = vector_in(at);
    if (!map.grid().contains(p))
      throw InputError("the place lies beyond the largest map, which reaches " +
                       plain_number(map.grid().reach()) + " m from the origin");
    return map.grid().key(p);
  }
  const Eigen::Vector3d direction = vector_in(at, 3);
  if (!(direction.norm() > 0)) throw InputError("ray: its direction has no length");
  const auto hit = first_occupied(map, vector_in(at), direction.normalized());
  if (!hit)
    throw InputError(
        "no occupied voxel lies there; free and unknown ones are found on a slice of the map");
  return *hit;
}

Frame voxel_answer(const Frame& question, const std::vector<KeptTour>& tours, int threads) {
  const Map& map = *tours.front().work->prior->mapping.map;
  const VoxelKey key = asked_voxel(question, map);
  const VoxelLook look = look_at_voxel(tours, key, threads);
  Value value = Value::map();
  value.set("key",
            Value(Value::List{std::int64_t{key.x}, std::int64_t{key.y}, std::int64_t{key.z}}));
  value.set("middle", list_of(map.grid().center(key)));
  value.set("edge", map.grid().resolution());
  value.set("state", name_of(look.reading));
  value.set("log_odds", static_cast<double>(look.reading.log_odds));
  value.set("observations",
            map.settings().observations ? Value(std::int64_t{look.reading.observations}) : Value());
  value.set("weight", look.weight);
  value.set("share", static_cast<double>(look.share));
  Value& images = value.set("images", Value::list());
  for (const ImageOfVoxel& image : look.images) {
    Value one = Value::map();
    if (tours.size() > 1) one.set("tour", static_cast<std::int64_t>(image.tour));
    one.set("number", static_cast<std::int64_t>(image.image + 1));
    one.set("distance", static_cast<double>(image.sight.distance));
    one.set("pixels", static_cast<double>(image.sight.pixels));
    one.set("mm_per_pixel", 1000 * map.grid().resolution() / image.sight.pixels);
    if (image.sight.incidence) one.set("incidence_deg", degrees(*image.sight.incidence));
    one.set("told", static_cast<double>(image.told));
    images.push_back(std::move(one));
  }
  return told(value);
}

// Of each cell its log odds as a number of 0 to 255 between the clamps, then its state.
std::string bytes_of_slice(const MapSlice& slice, const MapSettings& settings) {
  BlobBytes head("WLS1");
  head.add(static_cast<std::uint32_t>(slice.columns)).add(static_cast<std::uint32_t>(slice.rows));
  std::string bytes = head.take();
  const float low = settings.clamp_min, wide = settings.clamp_max - settings.clamp_min;
  for (const float odds : slice.log_odds)
    bytes += static_cast<char>(
        static_cast<std::uint8_t>(std::lround(255 * std::clamp((odds - low) / wide, 0.0f, 1.0f))));
  for (const CellState state : slice.states) bytes += static_cast<char>(state);
  return bytes;
}

Frame slice_answer(const Frame& question, const std::vector<KeptTour>& tours) {
  const Map& map = *tours.front().work->prior->mapping.map;
  const VoxelGrid& grid = map.grid();
  const auto axis = static_cast<int>(question.header.at("axis").as_integer());
  const MapSlice slice = slice_of(map, axis, question.header.at("at").as_number(), kMostCells);
  constexpr const char* kAxes[3] = {"x", "y", "z"};
  Value value = Value::map();
  value.set("axis", kAxes[axis]);
  value.set("at", grid.center(slice.layer));
  value.set("edge", grid.resolution());
  value.set("level", std::int64_t{slice.level});
  value.set("lower", Value(Value::List{grid.face(slice.first[0]), grid.face(slice.first[1])}));
  value.set("columns", std::int64_t{slice.columns});
  value.set("rows", std::int64_t{slice.rows});
  Value& counts = value.set("counts", Value::map());
  counts.set("free", static_cast<std::int64_t>(slice.free));
  counts.set("occupied", static_cast<std::int64_t>(slice.occupied));
  counts.set("between", static_cast<std::int64_t>(slice.between));
  counts.set("unknown", static_cast<std::int64_t>(slice.unknown));
  value.set("clamps", Value(Value::List{static_cast<double>(map.settings().clamp_min),
                                        static_cast<double>(map.settings().clamp_max)}));
  Frame frame = told(value);
  add_blob(frame, "cells", bytes_of_slice(slice, map.settings()));
  return frame;
}

Frame left_out_answer(const std::vector<KeptTour>& tours, int threads) {
  const LeftOut left = left_out_of(tours, threads);
  std::array<std::int64_t, kLeftOutReasons> counts{};
  BlobBytes bytes("WLL1");
  bytes.add(static_cast<std::uint32_t>(left.places.size()));
  for (const LeftOutPlace& place : left.places) {
    ++counts[static_cast<std::size_t>(place.why)];
    bytes.add(place.position).add(static_cast<std::uint32_t>(place.why));
  }
  Value value = Value::map();
  Value& reasons = value.set("reasons", Value::list());
  for (int k = 0; k < kLeftOutReasons; ++k) {
    Value one = Value::map();
    one.set("reason", to_string(static_cast<LeftOutReason>(k)));
    one.set("count", counts[static_cast<std::size_t>(k)]);
    reasons.push_back(std::move(one));
  }
  value.set("beyond", left.beyond);
  Frame frame = told(value);
  add_blob(frame, "places", bytes.take());
  return frame;
}

// The view that is asked for: a candidate, or an image of a tour.
std::pair<const ScanWork*, int> asked_view(const Frame& question,
                                           const std::vector<KeptTour>& tours) {
  const auto number_below = [&](const char* name, std::size_t count) {
    const std::int64_t number = question.header.at(name).as_integer();
    if (number >= static_cast<std::int64_t>(count))
      throw InputError(std::string(name) + ": there is no number " + std::to_string(number) +
                       "; expected 0 to " + std::to_string(count - 1));
    return static_cast<std::size_t>(number);
  };
  if (question.header.find("candidate")) {
    const ScanWork& work = *tours.front().work;
    return {&work,
            static_cast<int>(number_below("candidate", work.graph.candidates.viewpoints.size()))};
  }
  const KeptTour& tour = tours[number_below("tour", tours.size())];
  return {tour.work.get(), tour.images[number_below("image", tour.images.size())]};
}

Frame view_answer(const Frame& question, const std::vector<KeptTour>& tours, int threads) {
  const auto [work, number] = asked_view(question, tours);
  const ViewLook look = look_from_view(*work, number);
  const VoxelGrid& grid = work->prior->mapping.map->grid();
  Value value = Value::map();
  value.set("candidate", std::int64_t{number});
  value.set("position", list_of(look.view.position));
  value.set("yaw", look.view.yaw);
  value.set("pitch", look.view.pitch);
  value.set("score", look.score);
  Value& ways = value.set("ways", Value::list());
  for (const WayToView& way : look.ways) {
    Value one = Value::map();
    one.set("candidate", std::int64_t{way.view});
    one.set("seconds", way.seconds);
    Value& points = one.set("points", Value::list());
    for (const Eigen::Vector3d& p : way.points) points.push_back(list_of(p));
    ways.push_back(std::move(one));
  }
  value.set("voxels", static_cast<std::int64_t>(look.told.size()));
  BlobBytes bytes("WLV1");
  bytes.add(static_cast<std::uint32_t>(look.told.size()))
      .add(static_cast<float>(grid.resolution()));
  for (const VoxelShare& voxel : look.told) bytes.add(grid.center(voxel.voxel)).add(voxel.share);
  const Pinhole& camera = work->visible->settings().pinhole;
  const CameraView view{camera.fitted(kPictureAcross, kPictureDown), look.view.position,
                        camera_axes(look.view.yaw, look.view.pitch)};
  Frame frame = told(value);
  add_blob(frame, "told", bytes.take());
  add_blob(frame, "picture", encode_png(mesh_picture(*work->prior->mesh, view, threads)));
  return frame;
}

}  // namespace

WorkerLooks::WorkerLooks(Send send, int threads)
    : send_(std::move(send)), threads_(threads), thread_([this] { work(); }) {}

WorkerLooks::~WorkerLooks() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

bool WorkerLooks::answers(const std::string& what) {
  return what == "voxel" || what == "slice" || what == "left_out" || what == "view";
}

void WorkerLooks::keep(const std::string& folder, std::vector<KeptTour> tours) {
  const bool small = bytes_of(*tours.front().work) <= kSmall;
  const std::lock_guard lock(mutex_);
  std::erase_if(kept_, [&](const Kept& one) {
    return one.folder == folder || !small || bytes_of(*one.tours.front().work) > kSmall;
  });
  kept_.push_back({folder, std::move(tours)});
  if (kept_.size() > kMostLookedAt) kept_.pop_front();
}

void WorkerLooks::ask(Frame question) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(question));
  }
  changed_.notify_all();
}

void WorkerLooks::work() {
  for (;;) {
    Frame question;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return ended_ || !waiting_.empty(); });
      if (ended_) return;
      question = std::move(waiting_.front());
      waiting_.pop_front();
    }
    Frame frame;
    try {
      frame = answer(question);
    } catch (const std::exception& error) {
      frame = {};
      frame.header.set("said", "failed");
      frame.header.set("why", as_utf8(error.what()));
    }
    send_(std::move(frame), question.header.at("serial").as_integer());
  }
}

std::vector<KeptTour> WorkerLooks::tours_of(const std::string& folder) const {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(kept_.begin(), kept_.end(),
                                  [&](const Kept& one) { return one.folder == folder; });
  if (found == kept_.end())
    throw InputError(
        "the map of this plan is no longer held: it is held of the last plans, and of a large map "
        "of the last one alone; edit the scan to plan it again");
  return found->tours;
}

Frame WorkerLooks::answer(const Frame& question) const {
  const std::vector<KeptTour> tours = tours_of(question.header.at("folder").as_text());
  const std::string& what = question.header.at("do").as_text();
  if (what == "voxel") return voxel_answer(question, tours, threads_);
  if (what == "slice") return slice_answer(question, tours);
  if (what == "left_out") return left_out_answer(tours, threads_);
  return view_answer(question, tours, threads_);
}

}  // namespace lapwing
