// SPDX-License-Identifier: Apache-2.0
// LAS files, versions 1.0 to 1.4, point formats 0 to 10 (ASPRS, LAS Specification 1.4 R15, 2019).
#include <algorithm>
#include <array>

#include "framework/survey/cloud_reader.h"
#include "framework/survey/las_system.h"

namespace lapwing {
namespace {

constexpr std::size_t kShortHeader = 227, kNewHeader = 375;  // bytes; of 1.0 to 1.2, of 1.4
constexpr std::array<std::size_t, 11> kPointSizes{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
constexpr int kFirstNewFormat = 6;  // with 8 bits of class, and flags beside them
constexpr std::size_t kRecordHead = 54, kLateRecordHead = 60;  // bytes
constexpr std::size_t kLongestRecord = 1 << 20;                // bytes, of those that are read

class LasCloud final : public CloudReader {
 public:
  explicit LasCloud(StreamBytes bytes) : bytes_(std::move(bytes)) {
    read_header();
    read_records();
    const LasSystem system = system_of_las(records_, wkt_flag_);
    header_.system = system.text;
    header_.height_unit = system.height_unit;
    header_.system_note = system.note;
    bytes_.seek(data_, "its points");
    if (points_ > bytes_.left() / size_)
      bytes_.fail("it is cut short: its header states " + std::to_string(points_) + " points of " +
                  std::to_string(size_) + " bytes, and " + std::to_string(bytes_.left() / size_) +
                  " are there");
    header_.points = left_ = points_;
  }

  std::size_t read(std::span<CloudPoint> points) override {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(points.size(), left_));
    for (CloudPoint& point : points.first(count)) read_point(bytes_.take(size_, "a point"), point);
    left_ -= count;
    return count;
  }

 private:
  void read_header() {
    if (bytes_.peek(4) != "LASF") bytes_.fail("it does not begin with 'LASF', as .las files do");
    const std::string_view head = bytes_.peek(kNewHeader);
    if (head.size() < kShortHeader)
      bytes_.fail("it is cut short: its header has " + std::to_string(head.size()) + " of " +
                  std::to_string(kShortHeader) + " bytes");
    const auto number = [&](std::size_t place, std::size_t count) {
      return little_number(head.data() + place, count);
    };
    const auto major = number(24, 1), minor = number(25, 1);
    if (major != 1 || minor > 4)
      bytes_.fail("it is LAS " + std::to_string(major) + "." + std::to_string(minor) +
                  "; expected 1.0 to 1.4");
    wkt_flag_ = number(6, 2) & 16;
    head_ = number(94, 2);
    data_ = number(96, 4);
    early_records_ = number(100, 4);
    read_format(number(104, 1), number(105, 2));
    const bool newest = minor == 4 && head_ >= kNewHeader && head.size() >= kNewHeader;
    points_ = newest ? number(247, 8) : number(107, 4);
    late_ = newest ? number(235, 8) : 0;
    late_records_ = newest ? number(243, 4) : 0;
    if (head_ < kShortHeader || data_ < head_)
      bytes_.fail("its header is damaged: it has " + std::to_string(head_) +
                  " bytes, and points begin at byte " + std::to_string(data_));
    for (int axis = 0; axis < 3; ++axis) {
      const auto place = static_cast<std::size_t>(8 * axis);
      scale_[axis] = little_double(head.data() + 131 + place);
      offset_[axis] = little_double(head.data() + 155 + place);
    }
    if (!scale_.allFinite() || !offset_.allFinite() || (scale_.array() == 0).any())
      bytes_.fail("its header is damaged: scales and offsets must be numbers, scales not 0");
    Eigen::AlignedBox3d box;
    for (int axis = 0; axis < 3; ++axis) {
      const auto place = static_cast<std::size_t>(16 * axis);
      box.max()[axis] = little_double(head.data() + 179 + place);
      box.min()[axis] = little_double(head.data() + 187 + place);
    }
    if (box.min().allFinite() && box.max().allFinite() && !box.isEmpty()) header_.bounds = box;
    header_.format = "LAS 1." + std::to_string(minor) + ", point format " + std::to_string(format_);
    header_.classes = true;
  }

  void read_format(std::uint64_t stated, std::uint64_t size) {
    if (stated & 0xc0) refuse_packed();
    format_ = static_cast<int>(stated);
    if (stated >= kPointSizes.size())
      bytes_.fail("its points have format " + std::to_string(stated) + "; expected 0 to 10");
    size_ = static_cast<std::size_t>(size);
    if (size_ < kPointSizes[stated])
      bytes_.fail("its header is damaged: a point of format " + std::to_string(stated) + " has " +
                  std::to_string(kPointSizes[stated]) + " bytes, and " + std::to_string(size_) +
                  " are stated");
  }

  [[noreturn]] void refuse_packed() const {
    const std::string& name = bytes_.name();
    const std::string plain =
        (name.ends_with(".laz") || name.ends_with(".LAZ") ? name.substr(0, name.size() - 4)
                                                          : name + ".unpacked") +
        ".las";
    bytes_.fail("its points are compressed (LAZ); unpack it first: pdal translate '" + name +
                "' '" + plain + "', or laszip -i '" + name + "' -o '" + plain + "'");
  }

  // Variable length records follow the header, extended ones the points.
  void read_records() {
    bytes_.seek(head_, "its header");
    for (std::uint64_t i = 0; i < early_records_ && bytes_.position() < data_; ++i)
      read_record(kRecordHead, 2);
    if (late_records_ == 0) return;
    bytes_.seek(late_, "its extended records");
    for (std::uint64_t i = 0; i < late_records_; ++i) read_record(kLateRecordHead, 8);
  }

  void read_record(std::size_t head_size, std::size_t length_size) {
    const char* head = bytes_.take(head_size, "a record of its header");
    const std::string whole_user(head + 2, 16);
    const std::string user = whole_user.substr(0, whole_user.find('\0'));
    const auto id = little_number(head + 18, 2);
    const std::uint64_t length = little_number(head + 20, length_size);
    if (user == "laszip encoded") refuse_packed();
    std::string* const wanted = user != "LASF_Projection" ? nullptr
                                : id == 34735             ? &records_.keys
                                : id == 34737             ? &records_.text
                                : id == 2112              ? &records_.wkt
                                                          : nullptr;
    if (length > bytes_.left()) bytes_.fail("it is cut short: it ends within a record");
    if (!wanted) return bytes_.seek(bytes_.position() + length, "a record");
    if (length > kLongestRecord)
      bytes_.fail("a record of its reference system has more than 1 MiB");
    *wanted = std::string(bytes_.take(static_cast<std::size_t>(length), "a record"),
                          static_cast<std::size_t>(length));
  }

  void read_point(const char* bytes, CloudPoint& point) const {
    point = {};
    for (int axis = 0; axis < 3; ++axis) {
      const auto whole =
          static_cast<std::int32_t>(static_cast<std::uint32_t>(little_number(bytes + 4 * axis, 4)));
      point.position[axis] = whole * scale_[axis] + offset_[axis];
    }
    const auto byte = [&](int place) { return static_cast<unsigned char>(bytes[place]); };
    if (format_ < kFirstNewFormat) {
      point.classification = byte(15) & 31;
      point.withheld = byte(15) & 128;
    } else {
      point.classification = byte(16);
      point.withheld = byte(15) & 4;
    }
  }

  StreamBytes bytes_;
  LasSystemRecords records_;
  bool wkt_flag_ = false;
  int format_ = 0;
  std::size_t size_ = 0;  // bytes of a point
  std::uint64_t head_ = 0, data_ = 0, late_ = 0, early_records_ = 0, late_records_ = 0;
  std::uint64_t points_ = 0, left_ = 0;
  Eigen::Vector3d scale_ = Eigen::Vector3d::Ones(), offset_ = Eigen::Vector3d::Zero();
};

}  // namespace

std::unique_ptr<CloudReader> open_las_cloud(StreamBytes bytes) {
  return std::make_unique<LasCloud>(std::move(bytes));
}

}  // namespace lapwing
