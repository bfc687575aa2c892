#include "framework/geometry/mesh_header.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <sstream>

#include "framework/core/error.h"

namespace lapwing {
namespace {

[[noreturn]] void fail(const std::string& name, const std::string& why) {
  throw InputError("'" + name + "': " + why);
}

// Bytes of one number of a binary PLY; 0 for a word that is no type.
int size_of_type(const std::string& type) {
  for (const char* one : {"char", "uchar", "int8", "uint8"})
    if (type == one) return 1;
  for (const char* two : {"short", "ushort", "int16", "uint16"})
    if (type == two) return 2;
  for (const char* four : {"int", "uint", "int32", "uint32", "float", "float32"})
    if (type == four) return 4;
  return type == "double" || type == "float64" ? 8 : 0;
}

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  int bytes = 0;    // one of them takes at least, in a binary file
  int numbers = 0;  // one of them holds at least, in a text file: two bytes each
};

std::uint64_t count_of(const std::string& word, const std::string& file) {
  std::uint64_t count = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
  if (error != std::errc{} || end != word.data() + word.size()) {
    fail(file, "'" + word + "' in its header is no number of elements");
  }
  return count;
}

void read_property(std::istringstream& words, PlyElement& element, const std::string& line,
                   const std::string& name) {
  std::string type;
  words >> type;
  if (type == "list") words >> type;  // of which an empty list holds its length alone
  const int size = size_of_type(type);
  if (size == 0) fail(name, "its header states '" + line + "', which is no property");
  element.bytes += size;
  element.numbers += 1;
}

void check_ply(const std::string& bytes, const std::string& name) {
  constexpr std::size_t kLongestHeader = 64 << 10;
  const std::size_t end = bytes.substr(0, kLongestHeader).find("end_header");
  if (bytes.rfind("ply", 0) != 0) fail(name, "it does not begin with 'ply'");
  if (end == std::string::npos) fail(name, "its header has no end");
  std::istringstream header(bytes.substr(0, end));
  std::vector<PlyElement> elements;
  bool binary = false;
  for (std::string line; std::getline(header, line);) {
    std::istringstream words(line);
    std::string first, second, third;
    words >> first;
    if (first == "format") {
      words >> second;
      binary = second != "ascii";
    } else if (first == "element") {
      words >> second >> third;
      elements.push_back({second, count_of(third, name), 0, 0});
    } else if (first == "property") {
      if (elements.empty()) fail(name, "its header has a property of no element");
      read_property(words, elements.back(), line, name);
    }
  }
  const double room = static_cast<double>(bytes.size() - end);
  double needed = 0;
  for (const PlyElement& e : elements) {
    needed += static_cast<double>(e.count) * (binary ? e.bytes : 2 * e.numbers);
    if (e.count == 0 || e.numbers > 0) continue;
    fail(name, "its " + std::to_string(e.count) + " elements '" + e.name + "' have no property");
  }
  // A text may lack the last line's end.
  if (needed > room + 1) {
    std::string claim;
    for (const PlyElement& e : elements) {
      claim += (claim.empty() ? "" : " and ") + std::to_string(e.count) + " " + e.name;
    }
    fail(name, "its header claims " + claim + ", which cannot fit in the " +
                   std::to_string(bytes.size() - end) + " bytes that follow");
  }
}

void check_stl(const std::string& bytes, const std::string& name) {
  const bool text =
      bytes.rfind("solid", 0) == 0 && bytes.substr(0, 4096).find("facet") != std::string::npos;
  if (text) {
    if (bytes.find("endsolid") == std::string::npos) fail(name, "it ends before 'endsolid'");
    return;
  }
  constexpr std::size_t kHeader = 84, kTriangle = 50;
  if (bytes.size() < kHeader) fail(name, "it is too short for a binary STL");
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  const std::size_t held = (bytes.size() - kHeader) / kTriangle;
  if (count > held) {
    fail(name, "its header claims " + std::to_string(count) + " triangles, but it holds " +
                   std::to_string(held));
  }
}

}  // namespace

void check_mesh_header(const std::string& bytes, const std::string& format,
                       const std::string& name) {
  if (bytes.empty()) fail(name, "it is empty");
  if (format == "PLY") check_ply(bytes, name);
  if (format == "STL") check_stl(bytes, name);
}

ColladaFrame collada_frame(const std::string& text) {
  ColladaFrame frame;
  const std::size_t unit = text.find("<unit");
  if (unit != std::string::npos) {
    const std::size_t close = text.find('>', unit);
    const std::string tag = text.substr(unit, std::min<std::size_t>(close, unit + 1024) - unit);
    const std::size_t key = tag.find("meter=");
    if (key != std::string::npos && key + 7 < tag.size()) {
      double value = 0;
      const char* first = tag.data() + key + 7;
      const auto [end, error] = std::from_chars(first, tag.data() + tag.size(), value);
      if (error == std::errc{} && end != first && value > 0 && std::isfinite(value)) {
        frame.unit = value;
      }
    }
  }
  const std::size_t up = text.find("<up_axis>");
  if (up != std::string::npos) {
    const std::string axis = text.substr(up + 9, 1);
    if (axis == "X") frame.up = UpAxis::x;
    if (axis == "Y") frame.up = UpAxis::y;
    if (axis == "Z") frame.up = UpAxis::z;
  }
  return frame;
}

}  // namespace lapwing
