// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/graph_change.h"

#include <limits>
#include <numeric>

#include "framework/core/error.h"
#include "framework/view/changed_graph.h"

namespace lapwing {
namespace {

// Where nothing but rules is asked for.
class OpenSpace final : public FreeSpace {
 public:
  bool point_free(const Eigen::Vector3d&) const override { return true; }
  bool segment_free(const Eigen::Vector3d&, const Eigen::Vector3d&) const override { return true; }
  bool swept_box_free(const Eigen::Vector3d&, const Eigen::Vector3d&,
                      const Eigen::Vector3d&) const override {
    return true;
  }
  Eigen::AlignedBox3d bounds() const override {
    const Eigen::Vector3d all = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    return {-all, all};
  }
};

}  // namespace

double ground_without(const TriangleMesh& mesh, const InterestRegion& region) {
  constexpr double kLeastCell = 1;  // m
  constexpr int kMostCells = 64;    // along either side
  const Eigen::Vector2d low = region.bounds().min().head<2>();
  const Eigen::Vector2d size = region.bounds().sizes().head<2>();
  const Eigen::Array2i count =
      (size / kLeastCell).array().floor().cast<int>().max(1).min(kMostCells);
  const Eigen::Vector2d cell = (size.array() / count.cast<double>()).matrix();
  std::vector<char> known(static_cast<std::size_t>(count.prod()), 0);
  const auto place = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(count.x()) +
           static_cast<std::size_t>(x);
  };
  for (const Eigen::Vector3d& p : mesh.vertices) {
    const Eigen::Array2d at = (p.head<2>() - low).cwiseQuotient(cell).array();
    if ((at >= 0).all() && (at < count.cast<double>()).all())
      known[place(static_cast<int>(at.x()), static_cast<int>(at.y()))] = 1;
  }
  int cells = 0, unknown = 0;
  for (int y = 0; y < count.y(); ++y)
    for (int x = 0; x < count.x(); ++x) {
      if (!region.heights_at(low + cell.cwiseProduct(Eigen::Vector2d(x + 0.5, y + 0.5)))) continue;
      ++cells;
      unknown += !known[place(x, y)];
    }
  return cells > 0 ? static_cast<double>(unknown) / cells : 1;
}

void require_known(const ScanWork& before, const InterestRegion& region, const MissionRun& run) {
  constexpr double kMostUnknown = 0.1;
  const InterestRegion& was = before.visible->settings().region;
  if (!run.settings.observe_estimate || region == was) return;
  const TriangleMesh& mesh = before.prior->mesh->mesh();
  const double unknown = ground_without(mesh, region);
  if (unknown - ground_without(mesh, was) <= kMostUnknown) return;
  char text[200];
  std::snprintf(text, sizeof text,
                "the first flight of the plan before shows nothing of %.0f %% of this region",
                100 * unknown);
  Value told = Value::map();
  told.set("why", text);
  run.settings.observe_estimate(told);
  throw Cancelled();
}

void change_graph(const ScanWork& before, ScanWork& work, const FreeSpace& space,
                  const VisibleVoxels& sight, const std::vector<Viewpoint>& starts,
                  const std::vector<Viewpoint>& pinned, const ScanGraphSettings& settings,
                  const CancellationToken* cancellation) {
  const InterestRegion& was = before.visible->settings().region;
  std::unique_ptr<FreeSpace> rules;
  if (!work.rules->empty())
    rules = ruled(std::make_unique<OpenSpace>(), *work.rules, work.prior->mapping.map);
  work.graph = changed_graph(before.graph, was, before.pinned, space, rules.get(), sight,
                             *work.information, starts, pinned, settings, cancellation);
  const int first = work.graph.candidates.given - static_cast<int>(pinned.size());
  if (first < 1)
    throw InputError(
        "no_fly_zones, flight_zones and regions leave none of the places where the tour of the "
        "plan before could begin: let go to plan it, or set start");
  std::iota(work.pinned.begin(), work.pinned.end(), first);
}

}  // namespace lapwing
