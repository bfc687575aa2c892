// SPDX-License-Identifier: Apache-2.0
// The header of a PLY file, and the numbers that follow it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lapwing {

enum class PlyEncoding { text, little, big };

struct PlyType {
  int bytes = 0;  // 0: none
  bool is_signed = false, is_float = false;
};

struct PlyProperty {
  std::string name;
  PlyType type;
  PlyType length;  // of a list; none for a single number
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  // That one of them takes at least; a number in a text takes two.
  std::uint64_t least_bytes(PlyEncoding encoding) const;
  // The place of a property that is a single number; -1 where there is none.
  int place_of(std::string_view property) const;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::text;
  std::vector<PlyElement> elements;
  std::size_t size = 0;  // bytes
};

// Bytes that a header has at most.
inline constexpr std::size_t kLongestPlyHeader = 64 << 10;

// From the beginning of a file. InputError, naming the file, for anything that is no PLY header.
PlyHeader read_ply_header(std::string_view bytes, const std::string& name);
// InputError, naming the file, where its elements cannot fit in the bytes after the header.
void check_ply_counts(const PlyHeader& header, std::uint64_t bytes_after, const std::string& name);

// A number of `type.bytes` bytes; not for texts.
double ply_number(const char* bytes, const PlyType& type, PlyEncoding encoding);

}  // namespace lapwing
