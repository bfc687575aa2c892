// SPDX-License-Identifier: Apache-2.0
// Point clouds from files: .ply, .pcd, .xyz (also .txt, .csv, .asc, .pts), .las.
//
// A file is read from front to back, so that a cloud need not fit in memory. The exception is
// compressed .pcd, whose points are compressed as one. Colours and intensities are left aside.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <Eigen/Geometry>

#include "framework/survey/stream_bytes.h"

namespace lapwing {

struct CloudPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // in the file's coordinates; may be NaN
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();    // as the file says; zero where it has none
  int classification = -1;                             // of LAS (2: ground); -1 where it has none
  bool withheld = false;                               // the file says: not to be used
};

struct CloudHeader {
  std::string format;                   // "LAS 1.4, point format 6"
  std::optional<std::uint64_t> points;  // as the file says, and as its size can hold
  bool normals = false, classes = false;
  std::optional<Eigen::AlignedBox3d> bounds = std::nullopt;  // as the file says
  // The reference system of x, y, z as the file states it, for ReferenceSystem::of; "" without.
  std::string system = {};
  // m; the unit of z where the file states it apart from the system; 0 without.
  double height_unit = 0;
  // What the file says of its system that `system` cannot hold; "" where there is nothing.
  std::string system_note = {};
  // From where a .pcd says that it was measured.
  std::optional<Eigen::Vector3d> viewpoint = std::nullopt;
};

// Not thread-safe.
class CloudReader {
 public:
  virtual ~CloudReader() = default;
  const CloudHeader& header() const { return header_; }
  // The next points; fewer than there is room for only at the end, then 0. InputError, naming the
  // file and the point or the line, for a file that is cut short and for what is not as its header
  // says.
  virtual std::size_t read(std::span<CloudPoint> points) = 0;

 protected:
  CloudHeader header_;
};

struct CloudFileOptions {
  // Of texts (.xyz): what is in the columns, as "x y z" or "- y x z classification", with "-" for
  // what is left aside and nx, ny, nz for normals; "" where the file says, or x y z.
  std::string columns = {};
};

// By the name's ending. InputError, naming the file: another ending; .laz, with the command that
// unpacks it; a header that is none, or claims more points than the file can hold.
std::unique_ptr<CloudReader> open_cloud(const std::filesystem::path& path,
                                        const CloudFileOptions& options = {});
// The same of bytes; `ending` is ".las" and so on.
std::unique_ptr<CloudReader> open_cloud(StreamBytes bytes, const std::string& ending,
                                        const CloudFileOptions& options = {});

// Single formats.
std::unique_ptr<CloudReader> open_ply_cloud(StreamBytes bytes);
std::unique_ptr<CloudReader> open_pcd_cloud(StreamBytes bytes);
std::unique_ptr<CloudReader> open_las_cloud(StreamBytes bytes);
std::unique_ptr<CloudReader> open_text_cloud(StreamBytes bytes, const std::string& columns);

// The field of a point that a column's name means, in the spellings of common programs.
enum class CloudField { none, x, y, z, nx, ny, nz, classification };
CloudField cloud_field_named(const std::string& name);
// Puts one number of a column into its place.
void set_cloud_field(CloudPoint& point, CloudField field, double value);

}  // namespace lapwing
