// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "framework/core/error.h"
#include "framework/geometry/mesh_readers.h"
#include "framework/geometry/ply_header.h"

namespace lapwing {
namespace {

[[noreturn]] void fail_ply(const std::string& name, const std::string& why) {
  throw InputError("'" + name + "': " + why);
}

// The numbers after the header, one after the other.
class Numbers {
 public:
  Numbers(std::string_view bytes, PlyEncoding encoding, const std::string& name)
      : bytes_(bytes), encoding_(encoding), name_(name) {}

  double next(const PlyType& type) {
    return encoding_ == PlyEncoding::text ? next_word() : next_binary(type);
  }
  std::size_t left() const { return bytes_.size() - at_; }

 private:
  double next_word() {
    const auto space = [](char c) { return c == ' ' || (c >= '\t' && c <= '\r'); };
    while (at_ < bytes_.size() && space(bytes_[at_])) ++at_;
    const std::size_t begin = at_;
    while (at_ < bytes_.size() && !space(bytes_[at_])) ++at_;
    if (begin == at_) fail_ply(name_, "it ends before the data that its header claims");
    double value = 0;
    const char* first = bytes_.data() + begin;
    const char* last = bytes_.data() + at_;
    const auto [end, error] = std::from_chars(*first == '+' ? first + 1 : first, last, value);
    if (error != std::errc{} || end != last) {
      fail_ply(name_,
               "'" + std::string(bytes_.substr(begin, std::min<std::size_t>(at_ - begin, 40))) +
                   "' is not a number");
    }
    return value;
  }

  double next_binary(const PlyType& type) {
    const auto size = static_cast<std::size_t>(type.bytes);
    if (left() < size) fail_ply(name_, "it ends before the data that its header claims");
    const char* at = bytes_.data() + at_;
    at_ += size;
    return ply_number(at, type, encoding_);
  }

  std::string_view bytes_;
  PlyEncoding encoding_;
  const std::string& name_;
  std::size_t at_ = 0;
};

// One element of a kind: single numbers by the place of their property, the first list of the
// wanted name.
struct Item {
  std::vector<double> singles;
  std::vector<std::int32_t> corners;
};

class PlyBody {
 public:
  PlyBody(const PlyHeader& header, std::string_view bytes, const std::string& name)
      : header_(header), name_(name), numbers_(bytes.substr(header.size), header.encoding, name) {}

  TriangleMesh read() {
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex")
        read_vertices(element);
      else if (element.name == "face")
        read_faces(element);
      else
        for (std::uint64_t i = 0; i < element.count; ++i) read_item(element);
    }
    return std::move(mesh_);
  }

 private:
  void read_vertices(const PlyElement& element) {
    const int x = element.place_of("x"), y = element.place_of("y"), z = element.place_of("z");
    if (x < 0 || y < 0 || z < 0) fail_ply(name_, "its vertices lack x, y or z");
    for (std::uint64_t i = 0; i < element.count; ++i) {
      read_item(element);
      const auto at = [&](int place) { return item_.singles[static_cast<std::size_t>(place)]; };
      mesh_.vertices.emplace_back(at(x), at(y), at(z));
    }
  }

  void read_faces(const PlyElement& element) {
    const int red = element.place_of("red"), green = element.place_of("green");
    const int blue = element.place_of("blue");
    const bool colored = red >= 0 && green >= 0 && blue >= 0;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      read_item(element);
      Rgb color{178, 178, 178};
      if (colored) color = {byte(red), byte(green), byte(blue)};
      append_polygon(item_.corners, color, mesh_);
    }
    if (!colored) mesh_.colors.clear();
  }

  std::uint8_t byte(int place) const {
    const double v = item_.singles[static_cast<std::size_t>(place)];
    return v >= 0 && v <= 255 ? static_cast<std::uint8_t>(v) : 0;
  }

  void read_item(const PlyElement& element) {
    item_.singles.assign(element.properties.size(), 0);
    item_.corners.clear();
    for (std::size_t k = 0; k < element.properties.size(); ++k) {
      const PlyProperty& property = element.properties[k];
      if (!property.length.bytes) {
        item_.singles[k] = numbers_.next(property.type);
      } else {
        read_list(property);
      }
    }
  }

  void read_list(const PlyProperty& property) {
    const double length = numbers_.next(property.length);
    if (!(length >= 0) || length != std::floor(length) ||
        length > static_cast<double>(numbers_.left()) + 1) {
      fail_ply(name_, "a list claims more entries than the file has");
    }
    const bool wanted = property.name == "vertex_indices" || property.name == "vertex_index";
    for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(length); ++i) {
      const double v = numbers_.next(property.type);
      if (!wanted) continue;
      const bool place = v >= 0 && v < 2147483647.0 && v == std::floor(v);
      item_.corners.push_back(place ? static_cast<std::int32_t>(v) : -1);
    }
  }

  const PlyHeader& header_;
  const std::string& name_;
  Numbers numbers_;
  TriangleMesh mesh_;
  Item item_;
};

}  // namespace

TriangleMesh read_ply(std::string_view bytes, const std::string& name) {
  const PlyHeader header = read_ply_header(bytes, name);
  check_ply_counts(header, bytes.size() - header.size, name);
  return PlyBody(header, bytes, name).read();
}

}  // namespace lapwing
