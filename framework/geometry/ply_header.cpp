// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/ply_header.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <sstream>

#include "framework/core/error.h"

namespace lapwing {
namespace {

[[noreturn]] void fail_ply_header(const std::string& name, const std::string& why) {
  throw InputError("'" + name + "': " + why);
}

PlyType ply_type_named(const std::string& word) {
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

PlyProperty read_ply_property(std::istringstream& words, const std::string& line,
                              const std::string& name) {
  PlyProperty property;
  std::string type;
  words >> type;
  if (type == "list") {
    std::string length;
    words >> length >> type;
    property.length = ply_type_named(length);
    if (!property.length.bytes || property.length.is_float) type.clear();
  }
  property.type = ply_type_named(type);
  words >> property.name;
  if (!property.type.bytes || property.name.empty()) {
    fail_ply_header(name, "its header states '" + line + "', which is not a property");
  }
  return property;
}

void read_ply_line(const std::string& line, const std::string& name, bool& has_format,
                   PlyHeader& header) {
  std::istringstream words(line);
  std::string first, second, third;
  words >> first;
  if (first == "format") {
    words >> second;
    has_format =
        second == "ascii" || second == "binary_little_endian" || second == "binary_big_endian";
    if (!has_format) fail_ply_header(name, "its format '" + second + "' is unknown");
    header.encoding = second == "ascii"                  ? PlyEncoding::text
                      : second == "binary_little_endian" ? PlyEncoding::little
                                                         : PlyEncoding::big;
  } else if (first == "element") {
    words >> second >> third;
    PlyElement element{second, 0, {}};
    const char* last = third.data() + third.size();
    const auto [end, error] = std::from_chars(third.data(), last, element.count);
    if (error != std::errc{} || end != last) {
      fail_ply_header(name, "'" + third + "' in its header is not a number of elements");
    }
    header.elements.push_back(std::move(element));
  } else if (first == "property") {
    if (header.elements.empty()) fail_ply_header(name, "its header has a property of no element");
    header.elements.back().properties.push_back(read_ply_property(words, line, name));
  } else if (!first.empty() && first != "comment" && first != "obj_info") {
    fail_ply_header(name, "its header states '" + line + "', which means nothing");
  }
}

}  // namespace

std::uint64_t PlyElement::least_bytes(PlyEncoding encoding) const {
  std::uint64_t sum = 0;
  for (const PlyProperty& p : properties) {
    const PlyType& first = p.length.bytes ? p.length : p.type;
    sum += encoding == PlyEncoding::text ? 2 : static_cast<std::uint64_t>(first.bytes);
  }
  return sum;
}

int PlyElement::place_of(std::string_view property) const {
  for (std::size_t i = 0; i < properties.size(); ++i)
    if (properties[i].name == property && !properties[i].length.bytes) return static_cast<int>(i);
  return -1;
}

PlyHeader read_ply_header(std::string_view bytes, const std::string& name) {
  if (!bytes.starts_with("ply")) fail_ply_header(name, "it does not begin with 'ply'");
  PlyHeader header;
  bool has_format = false;
  for (std::size_t at = 3; at < std::min(bytes.size(), kLongestPlyHeader);) {
    const std::size_t end = bytes.find('\n', at);
    if (end == std::string_view::npos) break;
    std::string line(bytes.substr(at, end - at));
    if (!line.empty() && line.back() == '\r') line.pop_back();
    at = end + 1;
    if (line == "end_header") {
      if (!has_format) fail_ply_header(name, "its header states no format");
      header.size = at;
      return header;
    }
    read_ply_line(line, name, has_format, header);
  }
  fail_ply_header(name, "its header has no end");
}

void check_ply_counts(const PlyHeader& header, std::uint64_t room, const std::string& name) {
  std::string claim;
  double needed = 0;
  for (const PlyElement& e : header.elements) {
    claim += (claim.empty() ? "" : " and ") + std::to_string(e.count) + " " + e.name;
    if (e.count > 0 && e.properties.empty()) {
      fail_ply_header(
          name, "its " + std::to_string(e.count) + " elements '" + e.name + "' have no property");
    }
    needed += static_cast<double>(e.count) * static_cast<double>(e.least_bytes(header.encoding));
  }
  // A text may lack the last line's end.
  if (needed > static_cast<double>(room) + 1) {
    fail_ply_header(name, "its header claims " + claim + ", which cannot fit in the " +
                              std::to_string(room) + " bytes that follow");
  }
}

double ply_number(const char* bytes, const PlyType& type, PlyEncoding encoding) {
  const auto size = static_cast<std::size_t>(type.bytes);
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const auto byte = static_cast<unsigned char>(bytes[i]);
    const std::size_t place = encoding == PlyEncoding::little ? i : size - 1 - i;
    bits |= static_cast<std::uint64_t>(byte) << (8 * place);
  }
  if (type.is_float) {
    if (size == 8) return std::bit_cast<double>(bits);
    return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
  }
  if (!type.is_signed) return static_cast<double>(bits);
  const std::uint64_t sign = std::uint64_t{1} << (8 * size - 1);
  return static_cast<double>(static_cast<std::int64_t>((bits ^ sign) - sign));
}

}  // namespace lapwing
