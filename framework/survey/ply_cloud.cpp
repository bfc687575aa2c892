// SPDX-License-Identifier: Apache-2.0
// PLY files (Turk 1994) as point clouds: the element `vertex`. Elements before it are passed over,
// elements behind it are not read.
#include <algorithm>
#include <cmath>

#include "framework/geometry/ply_header.h"
#include "framework/survey/cloud_reader.h"

namespace lapwing {
namespace {

class PlyCloud final : public CloudReader {
 public:
  explicit PlyCloud(StreamBytes bytes) : bytes_(std::move(bytes)) {
    ply_ = read_ply_header(bytes_.peek(kLongestPlyHeader), bytes_.name());
    bytes_.take(ply_.size, "its header");
    check_ply_counts(ply_, bytes_.left(), bytes_.name());
    const auto vertex = std::find_if(ply_.elements.begin(), ply_.elements.end(),
                                     [](const PlyElement& e) { return e.name == "vertex"; });
    if (vertex == ply_.elements.end()) bytes_.fail("it has no element 'vertex'");
    for (auto before = ply_.elements.begin(); before != vertex; ++before) pass_over(*before);
    vertex_ = &*vertex;
    for (const char* axis : {"x", "y", "z"})
      if (vertex_->place_of(axis) < 0) bytes_.fail("its vertices lack " + std::string(axis));
    for (const PlyProperty& p : vertex_->properties)
      fields_.push_back(p.length.bytes ? CloudField::none : cloud_field_named(p.name));
    const auto has = [&](CloudField field) {
      return std::find(fields_.begin(), fields_.end(), field) != fields_.end();
    };
    header_.format = "PLY";
    header_.points = vertex_->count;
    header_.normals = has(CloudField::nx) && has(CloudField::ny) && has(CloudField::nz);
    header_.classes = has(CloudField::classification);
    left_ = vertex_->count;
  }

  std::size_t read(std::span<CloudPoint> points) override {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(points.size(), left_));
    for (CloudPoint& point : points.first(count)) {
      point = {};
      for (std::size_t i = 0; i < fields_.size(); ++i) {
        const PlyProperty& property = vertex_->properties[i];
        if (property.length.bytes)
          pass_over_list(property);
        else
          set_cloud_field(point, fields_[i], next(property.type));
      }
    }
    left_ -= count;
    return count;
  }

 private:
  double next(const PlyType& type) {
    constexpr const char* kWithin = "its points";
    if (ply_.encoding != PlyEncoding::text) {
      const auto size = static_cast<std::size_t>(type.bytes);
      return ply_number(bytes_.take(size, kWithin), type, ply_.encoding);
    }
    std::string_view word;
    if (!bytes_.word(word)) bytes_.fail("it is cut short: it ends within its points");
    double value = 0;
    if (!number_in(word, value))
      bytes_.fail("'" + std::string(word.substr(0, 40)) + "' is not a number");
    return value;
  }

  void pass_over_list(const PlyProperty& property) {
    const double length = next(property.length);
    if (!(length >= 0) || length != std::floor(length) ||
        length > static_cast<double>(bytes_.left()) + 1)
      bytes_.fail("a list claims more entries than the file has");
    for (double i = 0; i < length; ++i) next(property.type);
  }

  void pass_over(const PlyElement& element) {
    for (std::uint64_t i = 0; i < element.count; ++i)
      for (const PlyProperty& property : element.properties)
        if (property.length.bytes)
          pass_over_list(property);
        else
          next(property.type);
  }

  StreamBytes bytes_;
  PlyHeader ply_;
  const PlyElement* vertex_ = nullptr;
  std::vector<CloudField> fields_;  // of its properties
  std::uint64_t left_ = 0;
};

}  // namespace

std::unique_ptr<CloudReader> open_ply_cloud(StreamBytes bytes) {
  return std::make_unique<PlyCloud>(std::move(bytes));
}

}  // namespace lapwing
