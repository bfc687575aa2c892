// SPDX-License-Identifier: Apache-2.0
// Point clouds that tests make: a house on a slope, and files of all formats with given points.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace lapwing {

// The ground of the house below: a slope of one in ten that rises eastwards.
inline double slope_height(double x) {
  return 0.1 * x;
}

// Points every `step` metres, as an aircraft measures them: a slope of 40 m x 40 m, and on it a
// house of 8 m x 6 m around the origin with a flat roof at z = 5, walls, and a canopy to its south,
// 2 m deep at z = 3, of which only the upper side is measured. There are none under the house, and
// under the canopy none.
inline std::vector<Eigen::Vector3d> house_on_slope(double step) {
  std::vector<Eigen::Vector3d> points;
  const auto steps = [&](double length) { return static_cast<int>(std::lround(length / step)); };
  const auto spaced = [&](double from, int k) { return from + (k + 0.5) * step; };
  for (int i = 0; i < steps(40); ++i)
    for (int k = 0; k < steps(40); ++k) {
      const double x = spaced(-20, i), y = spaced(-20, k);
      const bool house = std::abs(x) < 4 && std::abs(y) < 3;
      const bool canopy = std::abs(x) < 4 && y <= -3 && y > -5;
      points.emplace_back(x, y, house ? 5 : canopy ? 3 : slope_height(x));
    }
  for (int i = 0; i < steps(8); ++i)
    for (double z = slope_height(spaced(-4, i)) + step / 2; z < 5; z += step) {
      if (z > 3) points.emplace_back(spaced(-4, i), -3, z);
      points.emplace_back(spaced(-4, i), 3, z);
    }
  for (int k = 0; k < steps(6); ++k)
    for (const double x : {-4.0, 4.0})
      for (double z = slope_height(x) + step / 2; z < 5; z += step)
        points.emplace_back(x, spaced(-3, k), z);
  return points;
}

// Bytes of files, put together number by number, little-endian unless said otherwise.
class MadeBytes {
 public:
  template <class Number>
  MadeBytes& put(Number value) {
    std::array<char, sizeof value> bytes = std::bit_cast<std::array<char, sizeof value>>(value);
    bytes_.append(bytes.data(), bytes.size());
    return *this;
  }
  template <class Number>
  MadeBytes& put_big(Number value) {
    std::array<char, sizeof value> bytes = std::bit_cast<std::array<char, sizeof value>>(value);
    bytes_.append(bytes.rbegin(), bytes.rend());
    return *this;
  }
  MadeBytes& text(const std::string& text) {
    bytes_ += text;
    return *this;
  }
  // So many bytes, the text first.
  MadeBytes& padded(const std::string& text, std::size_t size) {
    bytes_ += text + std::string(size - text.size(), '\0');
    return *this;
  }
  template <class Number>
  void set(std::size_t place, Number value) {
    const auto bytes = std::bit_cast<std::array<char, sizeof value>>(value);
    bytes_.replace(place, bytes.size(), bytes.data(), bytes.size());
  }
  std::size_t size() const { return bytes_.size(); }
  const std::string& str() const { return bytes_; }

 private:
  std::string bytes_;
};

struct MadeLas {
  int minor = 2, format = 0;
  int extra = 0;  // bytes behind every point
  Eigen::Vector3d scale{0.01, 0.01, 0.001}, offset{0, 0, 0};
  std::vector<int> classes = {};         // of the points; empty: 1
  std::vector<std::uint16_t> keys = {};  // GeoTIFF keys, in a record
  std::string wkt = {};                  // in a record
  bool late = false;                     // the WKT in an extended record
  std::string other_user = {};           // of a record that means nothing here
};

inline constexpr std::array<int, 11> kLasSizes{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

inline std::string las_bytes(const std::vector<Eigen::Vector3d>& points, const MadeLas& las) {
  MadeBytes bytes;
  const int head = las.minor >= 4 ? 375 : las.minor == 3 ? 235 : 227;
  bytes.padded("LASF", static_cast<std::size_t>(head));
  bytes.set<std::uint8_t>(24, 1);
  bytes.set<std::uint8_t>(25, static_cast<std::uint8_t>(las.minor));
  bytes.set<std::uint16_t>(94, static_cast<std::uint16_t>(head));
  std::uint32_t records = 0;
  const auto record = [&](const std::string& user, std::uint16_t id, const std::string& content) {
    bytes.put<std::uint16_t>(0).padded(user, 16).put(id);
    bytes.put(static_cast<std::uint16_t>(content.size())).padded("", 32).text(content);
    ++records;
  };
  if (!las.other_user.empty()) record(las.other_user, 22204, "something");
  if (!las.keys.empty()) {
    MadeBytes keys;
    for (const std::uint16_t number : las.keys) keys.put(number);
    record("LASF_Projection", 34735, keys.str());
  }
  if (!las.wkt.empty() && !las.late) record("LASF_Projection", 2112, las.wkt + '\0');
  if (!las.wkt.empty()) bytes.set<std::uint16_t>(6, 16);
  bytes.set<std::uint32_t>(96, static_cast<std::uint32_t>(bytes.size()));
  bytes.set(100, records);
  const int size = kLasSizes[static_cast<std::size_t>(las.format)] + las.extra;
  bytes.set<std::uint8_t>(104, static_cast<std::uint8_t>(las.format));
  bytes.set<std::uint16_t>(105, static_cast<std::uint16_t>(size));
  if (las.format < 6) bytes.set<std::uint32_t>(107, static_cast<std::uint32_t>(points.size()));
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e300), high = -low;
  for (const Eigen::Vector3d& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<std::size_t>(axis);
    bytes.set(131 + 8 * at, las.scale[axis]);
    bytes.set(155 + 8 * at, las.offset[axis]);
    bytes.set(179 + 16 * at, high[axis]);
    bytes.set(187 + 16 * at, low[axis]);
  }
  if (las.minor >= 4) bytes.set<std::uint64_t>(247, points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t at = bytes.size();
    bytes.padded("", static_cast<std::size_t>(size));
    for (int axis = 0; axis < 3; ++axis)
      bytes.set(at + 4 * static_cast<std::size_t>(axis),
                static_cast<std::int32_t>(
                    std::lround((points[i][axis] - las.offset[axis]) / las.scale[axis])));
    const int kind = las.classes.empty() ? 1 : las.classes[i];
    bytes.set<std::uint8_t>(at + (las.format < 6 ? 15 : 16), static_cast<std::uint8_t>(kind));
  }
  if (!las.wkt.empty() && las.late) {
    bytes.set<std::uint64_t>(235, bytes.size());
    bytes.set<std::uint32_t>(243, 1);
    bytes.put<std::uint16_t>(0).padded("LASF_Projection", 16).put<std::uint16_t>(2112);
    bytes.put<std::uint64_t>(las.wkt.size()).padded("", 32).text(las.wkt);
  }
  return bytes.str();
}

// "1 2 3\n" of every point.
inline std::string lines_of(const std::vector<Eigen::Vector3d>& points, const char* between = " ") {
  std::string text;
  for (const Eigen::Vector3d& p : points) {
    char line[120];
    std::snprintf(line, sizeof line, "%.4f%s%.4f%s%.4f\n", p.x(), between, p.y(), between, p.z());
    text += line;
  }
  return text;
}

inline std::string ply_head(const std::string& format, std::size_t count,
                            const std::string& properties) {
  return "ply\nformat " + format + " 1.0\ncomment made\nelement vertex " + std::to_string(count) +
         "\n" + properties + "end_header\n";
}

inline std::string pcd_head(const std::string& data, std::size_t count) {
  const std::string n = std::to_string(count);
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z intensity\n"
         "SIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH " +
         n + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + n + "\nDATA " + data + "\n";
}

// As LZF may have it: literal runs of 32 bytes at most.
inline std::string packed_plainly(const std::string& bytes) {
  std::string packed;
  for (std::size_t at = 0; at < bytes.size(); at += 32) {
    const std::string part = bytes.substr(at, 32);
    packed += static_cast<char>(part.size() - 1);
    packed += part;
  }
  return packed;
}

}  // namespace lapwing
