// SPDX-License-Identifier: Apache-2.0
// What networks that were trained on an oracle's scores say of a view.
//
//   utility: learned
//   utility: {type: learned, model: my.model}
//   utility: {type: learned_grid, rays: false}
#include <cmath>
#include <numeric>

#include "framework/core/error.h"
#include "framework/core/library_path.h"
#include "framework/core/parallel.h"
#include "framework/explore/view_rays.h"
#include "framework/plugin/plugin.h"
#include "plugins/utilities/learned/fit.h"
#include "plugins/utilities/learned/model_file.h"

namespace lapwing {
namespace {

using learned::Model;

// The one that is named, or NAME.model beside this library, in a build tree or an installed one.
std::filesystem::path model_path(const std::string& named, const std::string& utility) {
  if (!named.empty()) return named;
  const std::filesystem::path folder = library_folder();
  for (const char* tree : {"plugins", "lapwing/plugins"}) {
    const auto path = folder / tree / "utilities" / (utility + ".model");
    if (std::filesystem::exists(path)) return path;
  }
  throw InputError("utility '" + utility +
                   "': the shipped model is not beside its library; name one with model: FILE");
}

// A model, and the mapping that it is good for.
class Trained : public ViewUtility {
 public:
  void require_fit(const EpisodeView& known) const override {
    const std::string difference = mapping_difference(mapping_of(known), model_.mapping);
    if (!difference.empty())
      throw InputError("utility '" + name_ + "' was trained with another mapping: " + difference +
                       "; set the value of the model in the mission, or use a utility without a " +
                       "model (frontier)");
  }

 protected:
  Trained(const Parameters& p, const std::string& name)
      : name_(name),
        path_(model_path(p.text("model"), name)),
        model_(learned::read_model(path_)),
        blank_(p.boolean("blank")) {}
  // What both have.
  static ParameterTable common_parameters() {
    return ParameterTable()
        .text("model", "", "file of a trained model; empty: the shipped one")
        .boolean("blank", false, "blank input of the network, for comparison");
  }

  std::string name_;
  std::filesystem::path path_;
  Model model_;
  bool blank_;
};

// The network that reads rays (ray_network.h). The value is in voxels of surface.
class Learned final : public Trained {
 public:
  static constexpr PluginText kText{"learned", "2.0.0",
                                    "network that reads rays, trained on the values of the oracle",
                                    "thesis 5.4.3, 5.5.1"};
  static ParameterTable parameters() {
    return common_parameters().number(
        "least", 0.4, "", "a view that would show fewer voxels is worth nothing", between(0, 1e6));
  }
  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kTrainable, &learned::kRayTrainable}};
    return all;
  }
  explicit Learned(const Parameters& p)
      : Trained(p, kText.name),
        network_(learned::RayNetworkLayout(model_.ray_network(path_)), model_.state.parameters),
        least_(p.number("least")) {}

 protected:
  void values_of(const EpisodeView& known, std::span<const Viewpoint> views,
                 std::span<double> values) const override {
    const RayShape& shape = model_.ray_network(path_).rays;
    parallel_for(views.size(), known.threads, [&](std::size_t i) {
      thread_local std::vector<float> image, cells;
      image.resize(shape.size());
      cells.resize(static_cast<std::size_t>(shape.rays()));
      if (blank_)
        std::fill(image.begin(), image.end(), 0.0f);
      else
        sample_rays(known, views[i], shape, image);
      network_.answer(image, cells);
      const double told = std::accumulate(cells.begin(), cells.end(), 0.0);
      values[i] = told < least_ ? 0 : told;
    });
  }

 private:
  learned::RayNetwork network_;
  double least_;
};

// Voxels of surface that rays through the map could still observe, weighted as (5.3) weights them.
// A ray that ends in a known surface has as much of its voxels left as observations have left; one
// that ends in the unknown meets a surface `behind` metres further on. Rays graze surfaces as well:
// a known one counts `grazed` times what they end in.
double still_to_observe(const EpisodeView& known, const Viewpoint& view, double behind,
                        double grazed) {
  constexpr int kPixelStep = 4;
  std::vector<MapRay> rays;
  for (const Eigen::Vector3d& direction : view_rays(view, known.pinhole, kPixelStep))
    rays.push_back({view.position, direction, known.range});
  std::vector<MapRayHit> hits(rays.size());
  known.map->cast(rays, hits);
  const MapSettings& settings = known.map->settings();
  const double eta = settings.information;
  const double across = kPixelStep / known.pinhole.focal_x / settings.resolution;  // voxels at 1 m
  // Rays in a row: through the middles of squares of pixels, as view_rays has them.
  const auto row =
      static_cast<std::size_t>((2 * known.pinhole.width - 1 - kPixelStep) / (2 * kPixelStep)) + 1;
  const auto wall = [&](std::size_t at, bool there) {
    return there && hits[at].state == VoxelState::occupied ? 1 : 0;
  };
  double unknown = 0, seen = 0;
  for (std::size_t k = 0; k < hits.size(); ++k) {
    const MapRayHit& hit = hits[k];
    const double distance = static_cast<double>(hit.distance);
    if (hit.state == VoxelState::unknown) {
      // A ray that slips between the voxels of a wall is no way to look through it.
      const int walls = wall(k + 1, k % row + 1 < row) + wall(k - 1, k % row > 0) +
                        wall(k + row, k + row < hits.size()) + wall(k - row, k >= row);
      if (walls > 1) continue;
      const double edge = std::min(distance + behind, known.range) * across;
      unknown += edge * edge;
    } else if (hit.state == VoxelState::occupied) {
      const double edge = distance * across;
      seen += edge * edge * std::exp(-eta * known.map->read(hit.voxel).observations);
    }
  }
  return (1 - std::exp(-eta)) * (unknown + grazed * seen);
}

// The network of the thesis, which reads a grid around the camera (network.h).
class LearnedGrid final : public Trained {
 public:
  static constexpr PluginText kText{
      "learned_grid", "1.0.0", "network that reads a grid, trained on the values of the oracle",
      "thesis 5.4.3, 5.5.1"};
  static ParameterTable parameters() {
    return common_parameters()
        .boolean("rays", true, "combine the network with ray casts of the view")
        .number("behind", 1.5, "m", "assumed distance from unknown space to a surface, for rays",
                between(0, 100))
        .number("grazed", 3, "", "factor on known surface, for voxels that rays graze",
                between(0, 100));
  }
  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kTrainable, &learned::kGridTrainable}};
    return all;
  }
  explicit LearnedGrid(const Parameters& p)
      : Trained(p, kText.name),
        network_(learned::NetworkLayout(model_.grid_network(path_)), model_.state),
        rays_(p.boolean("rays")),
        behind_(p.number("behind")),
        grazed_(p.number("grazed")) {}

 protected:
  void values_of(const EpisodeView& known, std::span<const Viewpoint> views,
                 std::span<double> values) const override {
    const GridShape& shape = model_.grid_network(path_).grid;
    known.means->refresh(shape.levels);
    parallel_for(views.size(), known.threads, [&](std::size_t i) {
      thread_local std::vector<float> grid;
      grid.resize(shape.size());
      if (blank_)
        for (std::size_t k = 0; k < grid.size(); ++k) grid[k] = k % 2 == 0 ? 0.5f : 1.0f;
      else
        sample_grid(known, views[i], shape, grid);
      values[i] = model_.target_of(static_cast<double>(network_.answer(grid)));
      // Half of the harmonic mean: close to the smaller of both where they differ much.
      if (!rays_ || !(values[i] > 0)) return;
      const double left = still_to_observe(known, views[i], behind_, grazed_);
      values[i] *= left / (values[i] + left);
    });
  }

 private:
  learned::FoldedNetwork network_;
  bool rays_;
  double behind_, grazed_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Learned, lapwing::LearnedGrid)
