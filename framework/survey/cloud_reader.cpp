// SPDX-License-Identifier: Apache-2.0
#include "framework/survey/cloud_reader.h"

#include <algorithm>
#include <cctype>
#include <limits>

namespace lapwing {
namespace {

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

struct FieldName {
  const char* name;
  CloudField field;
};
constexpr FieldName kFieldNames[] = {{"x", CloudField::x},
                                     {"easting", CloudField::x},
                                     {"longitude", CloudField::x},
                                     {"lon", CloudField::x},
                                     {"y", CloudField::y},
                                     {"northing", CloudField::y},
                                     {"latitude", CloudField::y},
                                     {"lat", CloudField::y},
                                     {"z", CloudField::z},
                                     {"height", CloudField::z},
                                     {"elevation", CloudField::z},
                                     {"altitude", CloudField::z},
                                     {"nx", CloudField::nx},
                                     {"normal_x", CloudField::nx},
                                     {"ny", CloudField::ny},
                                     {"normal_y", CloudField::ny},
                                     {"nz", CloudField::nz},
                                     {"normal_z", CloudField::nz},
                                     {"class", CloudField::classification},
                                     {"classification", CloudField::classification},
                                     {"scalar_classification", CloudField::classification}};

}  // namespace

CloudField cloud_field_named(const std::string& name) {
  const std::string plain = lower_case(name);
  for (const FieldName& known : kFieldNames)
    if (plain == known.name) return known.field;
  return CloudField::none;
}

void set_cloud_field(CloudPoint& point, CloudField field, double value) {
  switch (field) {
    case CloudField::none:
      return;
    case CloudField::x:
      point.position.x() = value;
      return;
    case CloudField::y:
      point.position.y() = value;
      return;
    case CloudField::z:
      point.position.z() = value;
      return;
    case CloudField::nx:
      point.normal.x() = static_cast<float>(value);
      return;
    case CloudField::ny:
      point.normal.y() = static_cast<float>(value);
      return;
    case CloudField::nz:
      point.normal.z() = static_cast<float>(value);
      return;
    case CloudField::classification:
      point.classification = value >= 0 && value <= 255 ? static_cast<int>(value) : -1;
      return;
  }
}

std::unique_ptr<CloudReader> open_cloud(StreamBytes bytes, const std::string& ending,
                                        const CloudFileOptions& options) {
  const std::string plain = lower_case(ending);
  const bool text =
      plain == ".xyz" || plain == ".txt" || plain == ".csv" || plain == ".asc" || plain == ".pts";
  if (!text && !options.columns.empty())
    bytes.fail("columns are stated of texts alone, such as .xyz");
  if (text) return open_text_cloud(std::move(bytes), options.columns);
  if (plain == ".ply") return open_ply_cloud(std::move(bytes));
  if (plain == ".pcd") return open_pcd_cloud(std::move(bytes));
  if (plain == ".las" || plain == ".laz") return open_las_cloud(std::move(bytes));
  bytes.fail(
      "it is no point cloud that can be read: expected .ply, .pcd, .xyz, .txt, .csv, .asc, "
      ".pts or .las");
}

std::unique_ptr<CloudReader> open_cloud(const std::filesystem::path& path,
                                        const CloudFileOptions& options) {
  return open_cloud(StreamBytes(path), path.extension().string(), options);
}

}  // namespace lapwing
