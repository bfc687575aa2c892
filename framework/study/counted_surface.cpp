// SPDX-License-Identifier: Apache-2.0
#include "framework/study/counted_surface.h"

#include <algorithm>
#include <numbers>

#include "framework/core/checksum.h"
#include "framework/core/error.h"
#include "framework/core/files.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHead = "lapwing counted surface 1";
constexpr std::size_t kKeyDigits = 12;
constexpr std::size_t kMostBytes = std::size_t{1} << 30;

std::string key_of(const TriangleMesh& mesh, const ReconstructionSettings& judge,
                   const ViewingSettings& viewing) {
  std::string bytes;
  const auto add = [&](const auto* data, std::size_t count) {
    bytes.append(reinterpret_cast<const char*>(data), count * sizeof *data);
  };
  for (const auto& vertex : mesh.vertices) add(vertex.data(), 3);
  for (const auto& triangle : mesh.triangles) add(triangle.data(), 3);
  for (const Eigen::AlignedBox3d* box : {&judge.region, &viewing.room}) {
    add(box->min().data(), 3);
    add(box->max().data(), 3);
  }
  add(viewing.body.data(), 3);
  for (const double number :
       {judge.grid, judge.near, viewing.range, viewing.incidence, viewing.step})
    add(&number, 1);
  return sha256(bytes);
}

std::string packed(const std::vector<bool>& counted) {
  std::string bits((counted.size() + 7) / 8, 0);
  for (std::size_t k = 0; k < counted.size(); ++k)
    if (counted[k]) bits[k / 8] = static_cast<char>(bits[k / 8] | 1 << k % 8);
  return bits;
}

std::string head_line(const std::string& key, const std::vector<bool>& counted,
                      const std::string& bits) {
  return std::string(kHead) + " " + key + " " + std::to_string(counted.size()) + " " +
         std::to_string(std::count(counted.begin(), counted.end(), true)) + " " + sha256(bits) +
         "\n";
}

std::vector<bool> read_counted(const fs::path& file, const std::string& key, std::size_t points) {
  const std::string text = read_file(file, kMostBytes);
  const std::size_t line_end = std::min(text.find('\n'), text.size());
  const std::string bits = text.substr(std::min(line_end + 1, text.size()));
  std::vector<bool> counted(points);
  if (bits.size() == (points + 7) / 8)
    for (std::size_t k = 0; k < points; ++k) counted[k] = bits[k / 8] >> k % 8 & 1;
  if (text != head_line(key, counted, bits) + packed(counted))
    throw InputError("'" + file.string() +
                     "' is damaged, or of another surface: delete it, and it is made again");
  return counted;
}

}  // namespace

void count_visible(SurfaceSample& sample, const std::shared_ptr<const MeshScene>& surface,
                   const ReconstructionSettings& judge, const ViewingSettings& viewing,
                   std::span<const Eigen::Vector3d> from, const fs::path& folder,
                   const std::string& name, int threads,
                   const std::function<void(const std::string&)>& say) {
  ViewingSettings settings = viewing;
  settings.range = judge.range;
  settings.incidence = judge.incidence;
  const std::string key = key_of(surface->mesh(), judge, settings);
  const fs::path file = folder / (name + "_" + key.substr(0, kKeyDigits) + ".counted");
  const std::size_t points = sample.points().size();
  if (fs::exists(file)) {
    sample.count_only(read_counted(file, key, points));
  } else {
    say(name + ": which part of the surface can be seen from free places");
    const ViewingSpace space(surface, settings, from, threads);
    const std::vector<bool> counted = sample.counted(
        surface->mesh(),
        [&](const Eigen::Vector3d& p, const Eigen::Vector3d& normal) {
          return space.sees(p, normal);
        },
        threads);
    sample.count_only(counted);
    const std::string bits = packed(counted);
    write_file_atomically(file, head_line(key, counted, bits) + bits);
  }
  char text[160];
  std::snprintf(text, sizeof text,
                ": %.1f %% of the surface in the region can be seen from a free place, within "
                "%.4g m and %.4g degrees",
                100 * sample.counted_share(), judge.range,
                judge.incidence * 180 / std::numbers::pi);
  say(name + text);
}

}  // namespace lapwing
