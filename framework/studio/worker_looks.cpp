// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/worker_looks.h"

#include <algorithm>
#include <array>

#include "framework/core/png.h"
#include "framework/core/units.h"
#include "framework/geometry/camera_axes.h"
#include "framework/picture/mesh_picture.h"
#include "framework/studio/episode_answers.h"
#include "framework/studio/map_answers.h"

namespace lapwing {
namespace {

constexpr std::size_t kMostLookedAt = 4;
constexpr std::size_t kSmall = std::size_t{64} << 20;    // bytes of a graph
constexpr int kPictureAcross = 320, kPictureDown = 240;  // pixels at most

Frame voxel_answer(const Frame& question, const std::vector<KeptTour>& tours, int threads) {
  const Map& map = *tours.front().work->prior->mapping.map;
  const VoxelKey key = asked_voxel(question, map);
  const VoxelLook look = look_at_voxel(tours, key, threads);
  Value value = voxel_members(map, key);
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
  return answer_with(value);
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
  Frame frame = answer_with(value);
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
  value.set("position", point_list(look.view.position));
  value.set("yaw", look.view.yaw);
  value.set("pitch", look.view.pitch);
  value.set("score", look.score);
  Value& ways = value.set("ways", Value::list());
  for (const WayToView& way : look.ways) {
    Value one = Value::map();
    one.set("candidate", std::int64_t{way.view});
    one.set("seconds", way.seconds);
    Value& points = one.set("points", Value::list());
    for (const Eigen::Vector3d& p : way.points) points.push_back(point_list(p));
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
  Frame frame = answer_with(value);
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
    return !small || (!one.tours.empty() && bytes_of(*one.tours.front().work) > kSmall);
  });
  add({folder, std::move(tours), nullptr});
}

// With the lock.
void WorkerLooks::add(Kept one) {
  std::erase_if(kept_, [&](const Kept& other) { return other.folder == one.folder; });
  kept_.push_back(std::move(one));
  if (kept_.size() > kMostLookedAt) kept_.pop_front();
}

void WorkerLooks::begin_episode(std::shared_ptr<EpisodeReplay> episode) {
  const std::lock_guard lock(mutex_);
  live_ = std::move(episode);
}

void WorkerLooks::keep_episode(const std::string& folder) {
  const std::lock_guard lock(mutex_);
  if (live_) add({folder, {}, live_});
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

// Of "" what is being planned.
WorkerLooks::Kept WorkerLooks::kept_in(const std::string& folder) const {
  const std::lock_guard lock(mutex_);
  if (folder.empty() && live_) return {"", {}, live_};
  const auto found = std::find_if(kept_.begin(), kept_.end(),
                                  [&](const Kept& one) { return one.folder == folder; });
  if (found == kept_.end())
    throw InputError(
        "the map of this plan is no longer held. It is held of the last plans, and of a scan "
        "with a large map of the last one alone. Edit the mission to plan it again");
  return *found;
}

Frame WorkerLooks::answer(const Frame& question) {
  const Kept kept = kept_in(question.header.at("folder").as_text());
  if (asked_ && asked_ != kept.episode) asked_->forget();
  asked_ = kept.episode;
  if (asked_) return episode_answer(question, *asked_);
  const std::vector<KeptTour>& tours = kept.tours;
  const std::string& what = question.header.at("do").as_text();
  if (what == "voxel") return voxel_answer(question, tours, threads_);
  if (what == "slice") return slice_answer(question, *tours.front().work->prior->mapping.map);
  if (what == "left_out") return left_out_answer(tours, threads_);
  return view_answer(question, tours, threads_);
}

}  // namespace lapwing
