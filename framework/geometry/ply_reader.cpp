// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>

#include "framework/core/error.h"
#include "framework/geometry/mesh_readers.h"

namespace lapwing {
namespace {

[[noreturn]] void fail_ply(const std::string& name, const std::string& why) {
  throw InputError("'" + name + "': " + why);
}

enum class Encoding { text, little, big };

struct Type {
  int bytes = 0;  // 0: none
  bool is_signed = false, is_float = false;
};

Type type_named(const std::string& word) {
  if (word == "char" || word == "int8") return {1, true, false};
  if (word == "uchar" || word == "uint8") return {1, false, false};
  if (word == "short" || word == "int16") return {2, true, false};
  if (word == "ushort" || word == "uint16") return {2, false, false};
  if (word == "int" || word == "int32") return {4, true, false};
  if (word == "uint" || word == "uint32") return {4, false, false};
  if (word == "float" || word == "float32") return {4, true, true};
  if (word == "double" || word == "float64") return {8, true, true};
  return {};
}

struct Property {
  std::string name;
  Type type;
  Type length;  // of a list; none for a single number
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;

  // That one of them takes at least; a number in a text takes two.
  std::uint64_t least_bytes(Encoding encoding) const {
    std::uint64_t sum = 0;
    for (const Property& p : properties) {
      const Type& first = p.length.bytes ? p.length : p.type;
      sum += encoding == Encoding::text ? 2 : static_cast<std::uint64_t>(first.bytes);
    }
    return sum;
  }
};

// The numbers after the header, one after the other.
class Numbers {
 public:
  Numbers(std::string_view bytes, Encoding encoding, const std::string& name)
      : bytes_(bytes), encoding_(encoding), name_(name) {}

  double next(const Type& type) {
    return encoding_ == Encoding::text ? next_word() : next_binary(type);
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

  double next_binary(const Type& type) {
    const auto size = static_cast<std::size_t>(type.bytes);
    if (left() < size) fail_ply(name_, "it ends before the data that its header claims");
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const auto byte = static_cast<unsigned char>(bytes_[at_ + i]);
      const std::size_t place = encoding_ == Encoding::little ? i : size - 1 - i;
      bits |= static_cast<std::uint64_t>(byte) << (8 * place);
    }
    at_ += size;
    if (type.is_float) {
      if (size == 8) return std::bit_cast<double>(bits);
      return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
    }
    if (!type.is_signed) return static_cast<double>(bits);
    const std::uint64_t sign = std::uint64_t{1} << (8 * size - 1);
    return static_cast<double>(static_cast<std::int64_t>((bits ^ sign) - sign));
  }

  std::string_view bytes_;
  Encoding encoding_;
  const std::string& name_;
  std::size_t at_ = 0;
};

struct Header {
  Encoding encoding = Encoding::text;
  std::vector<Element> elements;
  std::size_t size = 0;  // bytes
};

Property read_property(std::istringstream& words, const std::string& line,
                       const std::string& name) {
  Property property;
  std::string type;
  words >> type;
  if (type == "list") {
    std::string length;
    words >> length >> type;
    property.length = type_named(length);
    if (!property.length.bytes || property.length.is_float) type.clear();
  }
  property.type = type_named(type);
  words >> property.name;
  if (!property.type.bytes || property.name.empty()) {
    fail_ply(name, "its header states '" + line + "', which is not a property");
  }
  return property;
}

void read_line(const std::string& line, const std::string& name, bool& has_format, Header& header) {
  std::istringstream words(line);
  std::string first, second, third;
  words >> first;
  if (first == "format") {
    words >> second;
    has_format =
        second == "ascii" || second == "binary_little_endian" || second == "binary_big_endian";
    if (!has_format) fail_ply(name, "its format '" + second + "' is unknown");
    header.encoding = second == "ascii"                  ? Encoding::text
                      : second == "binary_little_endian" ? Encoding::little
                                                         : Encoding::big;
  } else if (first == "element") {
    words >> second >> third;
    Element element{second, 0, {}};
    const char* last = third.data() + third.size();
    const auto [end, error] = std::from_chars(third.data(), last, element.count);
    if (error != std::errc{} || end != last) {
      fail_ply(name, "'" + third + "' in its header is not a number of elements");
    }
    header.elements.push_back(std::move(element));
  } else if (first == "property") {
    if (header.elements.empty()) fail_ply(name, "its header has a property of no element");
    header.elements.back().properties.push_back(read_property(words, line, name));
  } else if (!first.empty() && first != "comment" && first != "obj_info") {
    fail_ply(name, "its header states '" + line + "', which means nothing");
  }
}

Header read_header(std::string_view bytes, const std::string& name) {
  constexpr std::size_t kLongest = 64 << 10;
  if (!bytes.starts_with("ply")) fail_ply(name, "it does not begin with 'ply'");
  Header header;
  bool has_format = false;
  for (std::size_t at = 3; at < std::min(bytes.size(), kLongest);) {
    const std::size_t end = bytes.find('\n', at);
    if (end == std::string_view::npos) break;
    std::string line(bytes.substr(at, end - at));
    if (!line.empty() && line.back() == '\r') line.pop_back();
    at = end + 1;
    if (line == "end_header") {
      if (!has_format) fail_ply(name, "its header states no format");
      header.size = at;
      return header;
    }
    read_line(line, name, has_format, header);
  }
  fail_ply(name, "its header has no end");
}

void check_counts(const Header& header, std::size_t size, const std::string& name) {
  const std::size_t room = size - header.size;
  std::string claim;
  double needed = 0;
  for (const Element& e : header.elements) {
    claim += (claim.empty() ? "" : " and ") + std::to_string(e.count) + " " + e.name;
    if (e.count > 0 && e.properties.empty()) {
      fail_ply(name,
               "its " + std::to_string(e.count) + " elements '" + e.name + "' have no property");
    }
    needed += static_cast<double>(e.count) * static_cast<double>(e.least_bytes(header.encoding));
  }
  // A text may lack the last line's end.
  if (needed > static_cast<double>(room) + 1) {
    fail_ply(name, "its header claims " + claim + ", which cannot fit in the " +
                       std::to_string(room) + " bytes that follow");
  }
}

// One element of a kind: single numbers by the place of their property, the first list of the
// wanted name.
struct Item {
  std::vector<double> singles;
  std::vector<std::int32_t> corners;
};

class PlyBody {
 public:
  PlyBody(const Header& header, std::string_view bytes, const std::string& name)
      : header_(header), name_(name), numbers_(bytes.substr(header.size), header.encoding, name) {}

  TriangleMesh read() {
    for (const Element& element : header_.elements) {
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
  static int place_of(const Element& element, std::string_view property) {
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const Property& p = element.properties[i];
      if (p.name == property && !p.length.bytes) return static_cast<int>(i);
    }
    return -1;
  }

  void read_vertices(const Element& element) {
    const int x = place_of(element, "x"), y = place_of(element, "y"), z = place_of(element, "z");
    if (x < 0 || y < 0 || z < 0) fail_ply(name_, "its vertices lack x, y or z");
    for (std::uint64_t i = 0; i < element.count; ++i) {
      read_item(element);
      const auto at = [&](int place) { return item_.singles[static_cast<std::size_t>(place)]; };
      mesh_.vertices.emplace_back(at(x), at(y), at(z));
    }
  }

  void read_faces(const Element& element) {
    const int red = place_of(element, "red"), green = place_of(element, "green");
    const int blue = place_of(element, "blue");
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

  void read_item(const Element& element) {
    item_.singles.assign(element.properties.size(), 0);
    item_.corners.clear();
    for (std::size_t k = 0; k < element.properties.size(); ++k) {
      const Property& property = element.properties[k];
      if (!property.length.bytes) {
        item_.singles[k] = numbers_.next(property.type);
      } else {
        read_list(property);
      }
    }
  }

  void read_list(const Property& property) {
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

  const Header& header_;
  const std::string& name_;
  Numbers numbers_;
  TriangleMesh mesh_;
  Item item_;
};

}  // namespace

TriangleMesh read_ply(std::string_view bytes, const std::string& name) {
  const Header header = read_header(bytes, name);
  check_counts(header, bytes.size(), name);
  return PlyBody(header, bytes, name).read();
}

}  // namespace lapwing
