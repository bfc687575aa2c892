// SPDX-License-Identifier: Apache-2.0
// What images will show of a surface, before they are taken: how many show each triangle, at which
// angle, how finely, and how accurately its middle can be triangulated from them.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "framework/core/progress.h"
#include "framework/geometry/camera_view.h"
#include "framework/geometry/mesh_scene.h"
#include "framework/geometry/pose.h"

namespace lapwing {

struct ImagingSettings {
  Pinhole pinhole;
  double range = 60;       // m, of a surface that an image still shows well enough
  double incidence = 1.3;  // rad, likewise, of a ray against the normal; at most pi / 2
  // Standard deviation of a point's place in an image, pixels, both ways. Cameras count as exactly
  // known: errors of the whole block (scale, position) are not part of the prediction.
  double pixel_error = 0.5;
};

// rad: rays that differ by less, as of several images of one place, do not locate a point.
inline constexpr float kLeastParallax = 0.0174533f;

// Of the middle of a triangle.
struct TrianglePrediction {
  int images = 0;        // that show it
  float incidence = 0;   // rad, the smallest angle of a ray against the normal; without images 0
  float pixel_size = 0;  // m of the surface, the longer way, in the finest image; likewise
  float parallax = 0;    // rad, the largest angle between two rays; 0 below two images
  float accuracy = 0;    // m, standard deviation in the worst direction; infinite where two images
                         // are missing or all rays are parallel

  // Whether the images locate it: two at least, with rays that differ enough.
  bool located() const { return images >= 2 && parallax >= kLeastParallax; }
};

// A set of images of one surface. Immutable; thread-safe.
class ImageSet {
 public:
  // InputError for a camera without pixels or focal lengths, and numbers that are not above 0.
  // A camera's pose: x right, y down, z forward.
  ImageSet(std::shared_ptr<const MeshScene> surface, std::vector<Pose> cameras,
           const ImagingSettings& settings);

  // Whether an image shows the middle of a triangle: inside the image, within range and angle, and
  // nothing of the surface before it. Either side of a triangle shows.
  bool shows(std::size_t camera, std::size_t triangle) const;
  // Whether they locate it, as TrianglePrediction::located says.
  bool locates(std::size_t triangle) const;
  TrianglePrediction predict(std::size_t triangle) const;

 private:
  struct Camera {
    Eigen::Vector3d position;
    Eigen::Matrix3d to_camera;
  };
  // Of the cameras that may be within range of a place, their numbers, ascending.
  std::span<const std::uint32_t> near(const Eigen::Vector3d& place) const;
  std::uint64_t cell_of(const Eigen::Vector3d& place, int x, int y, int z) const;

  std::shared_ptr<const MeshScene> surface_;
  std::vector<Camera> cameras_;
  ImagingSettings settings_;
  // By cubes with the range as edge: the cameras in them and in those around.
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> near_;
};

// Of the triangles that `counted` names, by their place in the mesh; the others have 0 images. The
// same for any number of threads. Cancelled when told to stop.
std::vector<TrianglePrediction> predict_surface(const ImageSet& images,
                                                std::span<const char> counted, int threads,
                                                const CancellationToken* cancellation = nullptr);

// Per unit of area, over triangles that the images locate: the value that `share` of the
// area does not exceed; NaN where there is no such area.
double quantile_by_area(const TriangleMesh& mesh, std::span<const TrianglePrediction> predictions,
                        float TrianglePrediction::*value, double share);

// Why a surface is not reconstructed: candidate views locate it, and the images that were chosen do
// not; or candidates do so only together with views that zones and the like forbid; or not even
// those do.
enum class HoleReason { not_chosen, zone, no_view };
// "not_chosen", "zone", "no_view"
const char* to_string(HoleReason reason);

// Triangles that share vertices and a reason, none of which the images locate.
struct SurfaceHole {
  HoleReason reason = HoleReason::no_view;
  double area = 0;                                  // m^2
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  // m, of the middle nearest to the mean
};

// Of the counted triangles, the largest hole first; those of equal areas in the order of the mesh.
// `candidates` are all views that could have been chosen, `with_forbidden` these and those that
// something else than obstacles forbids; null where nothing does.
std::vector<SurfaceHole> holes_of(const MeshScene& surface, std::span<const char> counted,
                                  std::span<const TrianglePrediction> predictions,
                                  const ImageSet& candidates, const ImageSet* with_forbidden,
                                  int threads, const CancellationToken* cancellation = nullptr);

}  // namespace lapwing
