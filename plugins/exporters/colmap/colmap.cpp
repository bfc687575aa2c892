// SPDX-License-Identifier: Apache-2.0
// The images of a scan as COLMAP's text model: a camera, poses, and no points yet.
//
//   lapwing export out/church/plan.json --format colmap -o church_model
#include <charconv>

#include "framework/export/exporter.h"
#include "framework/export/small_camera.h"
#include "framework/geometry/depth_camera.h"
#include "framework/plugin/plugin.h"

namespace lapwing {
namespace {

// The shortest text that reads back as the same number.
void put(std::string& out, double number) {
  char buffer[32];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, number + 0.0);
  out.append(buffer, result.ptr);
}

std::string image_name(std::size_t number, std::size_t count) {
  const std::size_t digits = std::max<std::size_t>(4, std::to_string(count).size());
  std::string text = std::to_string(number);
  text.insert(0, digits - std::min(digits, text.size()), '0');
  return "view_" + text + ".png";
}

class Colmap final : public Exporter {
 public:
  static constexpr PluginText kText{
      "colmap", "1.0.0", "images of a scan as a COLMAP text model, a folder of three files",
      "https://colmap.github.io/format.html"};
  static ParameterTable parameters() { return {}; }
  explicit Colmap(const Parameters&) {}

  std::string file_extension() const override { return ""; }

  std::string write(const Plan& plan) const override { return write_folder(plan).front().second; }

  NamedContents write_folder(const Plan& plan) const override {
    if (!plan.task.scan) {
      throw InputError("colmap: '" + plan.mission + "' is a plan of kind " + plan.kind +
                       " without views; only scans have images");
    }
    const ScanTask& scan = *plan.task.scan;
    return {{"cameras.txt", cameras(scan.camera)},
            {"images.txt", images(scan.views)},
            {"points3D.txt", "# POINT3D_ID X Y Z R G B ERROR TRACK[]: none yet\n"}};
  }

  std::vector<std::string> remarks(const Plan& plan) const override {
    if (!plan.task.scan) return {};
    const std::string warning = warning_of_small_camera(plan.task.scan->camera);
    return warning.empty() ? std::vector<std::string>() : std::vector<std::string>{warning};
  }

 private:
  // COLMAP's pixels count from the corner of the upper left one, ours from its centre.
  static std::string cameras(const Pinhole& camera) {
    std::string out = "# CAMERA_ID MODEL WIDTH HEIGHT FX FY CX CY\n1 PINHOLE " +
                      std::to_string(camera.width) + ' ' + std::to_string(camera.height);
    for (const double number :
         {camera.focal_x, camera.focal_y, camera.principal_x + 0.5, camera.principal_y + 0.5}) {
      out += ' ';
      put(out, number);
    }
    return out + '\n';
  }

  // Two lines an image: how the world is turned and moved into the camera, then its features.
  static std::string images(const std::vector<PlannedView>& views) {
    std::string out = "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, then a line of features\n";
    for (std::size_t i = 0; i < views.size(); ++i) {
      const PlannedView& view = views[i];
      const Pose pose = camera_pose(view.position, view.yaw, view.pitch);
      Eigen::Quaterniond q = pose.orientation.conjugate();
      if (q.w() < 0) q.coeffs() *= -1;
      const Eigen::Vector3d t = q * -view.position;
      out += std::to_string(i + 1);
      for (const double number : {q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z()}) {
        out += ' ';
        put(out, number);
      }
      out += " 1 " + image_name(i + 1, views.size()) + "\n\n";
    }
    return out;
  }
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Colmap)
