// SPDX-License-Identifier: Apache-2.0
// PCD files of the Point Cloud Library, versions .5 to .7: ascii, binary, binary_compressed.
#include <algorithm>
#include <charconv>
#include <sstream>

#include "framework/geometry/ply_header.h"
#include "framework/survey/cloud_reader.h"
#include "framework/survey/lzf.h"

namespace lapwing {
namespace {

constexpr std::uint64_t kMostUnpacked = std::uint64_t{4} << 30;  // bytes, of a compressed file

enum class PcdData { text, binary, compressed };

struct PcdField {
  CloudField field = CloudField::none;
  PlyType type;            // of numbers in binary
  std::size_t count = 1;   // numbers of a point
  std::size_t offset = 0;  // bytes, within a point
};

using Words = std::vector<std::string>;

class PcdCloud final : public CloudReader {
 public:
  explicit PcdCloud(StreamBytes bytes) : bytes_(std::move(bytes)) {
    read_header();
    lay_out();
    header_.format = std::string("PCD, ") + (data_ == PcdData::text     ? "ascii"
                                             : data_ == PcdData::binary ? "binary"
                                                                        : "compressed");
    header_.points = points_;
    left_ = points_;
    if (data_ == PcdData::compressed) unpack();
  }

  std::size_t read(std::span<CloudPoint> points) override {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(points.size(), left_));
    for (CloudPoint& point : points.first(count)) {
      point = {};
      if (data_ == PcdData::text)
        read_text(point);
      else if (data_ == PcdData::binary)
        read_binary(point, bytes_.take(size_, "its points"));
      else
        read_unpacked(point, static_cast<std::size_t>(points_ - left_));
      --left_;
    }
    return count;
  }

 private:
  void read_header() {
    Words fields, sizes, types, counts;
    std::string_view text;
    std::uint64_t width = 0, height = 1;
    bool sized = false, counted = false;
    while (bytes_.line(text)) {
      std::istringstream stream{std::string(text.substr(0, text.find('#')))};
      Words words;
      for (std::string word; stream >> word;) words.push_back(word);
      if (words.empty()) continue;
      const std::string key = words.front();
      words.erase(words.begin());
      if (key == "FIELDS" || key == "COLUMNS")
        fields = words;
      else if (key == "SIZE")
        sizes = words;
      else if (key == "TYPE")
        types = words;
      else if (key == "COUNT")
        counts = words;
      else if (key == "WIDTH")
        width = whole(words, key), sized = true;
      else if (key == "HEIGHT")
        height = whole(words, key);
      else if (key == "POINTS")
        points_ = whole(words, key), counted = true;
      else if (key == "VIEWPOINT")
        read_viewpoint(words);
      else if (key == "DATA") {
        data_ = data_named(words);
        if (!sized && !counted) bytes_.fail("its header states neither POINTS nor WIDTH");
        if (!counted) points_ = width * height;
        const bool agree = height == 0 ? points_ == 0 : points_ / height == width;
        if (sized && (!agree || points_ != width * height))
          bytes_.fail("its header states " + std::to_string(points_) + " points, and " +
                      std::to_string(width) + " x " + std::to_string(height));
        return set_fields(fields, sizes, types, counts);
      } else if (key != "VERSION") {
        bytes_.fail("its header states '" + key.substr(0, 40) + "', which means nothing");
      }
    }
    bytes_.fail("its header has no line DATA");
  }

  std::uint64_t whole(const Words& words, const std::string& key) const {
    std::uint64_t value = 0;
    if (words.size() == 1) {
      const char* last = words[0].data() + words[0].size();
      const auto [end, error] = std::from_chars(words[0].data(), last, value);
      if (error == std::errc{} && end == last) return value;
    }
    bytes_.fail(key + " in its header is not a whole number");
  }

  PcdData data_named(const Words& words) const {
    const std::string word = words.empty() ? "" : words[0];
    if (word == "ascii") return PcdData::text;
    if (word == "binary") return PcdData::binary;
    if (word == "binary_compressed") return PcdData::compressed;
    bytes_.fail("its data are '" + word.substr(0, 40) +
                "'; expected ascii, binary or binary_compressed");
  }

  // Its place says nothing where it is the default, 0 0 0 1 0 0 0.
  void read_viewpoint(const Words& words) {
    if (words.size() != 7) bytes_.fail("VIEWPOINT in its header has not seven numbers");
    double numbers[7];
    for (std::size_t i = 0; i < 7; ++i)
      if (!number_in(words[i], numbers[i])) bytes_.fail("VIEWPOINT in its header is not a pose");
    const Eigen::Vector3d place(numbers[0], numbers[1], numbers[2]);
    if (place.allFinite() && place != Eigen::Vector3d::Zero()) header_.viewpoint = place;
  }

  void set_fields(const Words& fields, const Words& sizes, const Words& types,
                  const Words& counts) {
    const bool whole_header = sizes.size() == fields.size() && types.size() == fields.size() &&
                              (counts.empty() || counts.size() == fields.size());
    if (fields.empty() || !whole_header)
      bytes_.fail("FIELDS, SIZE, TYPE and COUNT in its header have different lengths");
    for (std::size_t i = 0; i < fields.size(); ++i) {
      PcdField field;
      field.field = cloud_field_named(fields[i]);
      const std::string& type = types[i];
      field.type.bytes = static_cast<int>(whole({sizes[i]}, "SIZE") & 15);
      field.type.is_float = type == "F";
      field.type.is_signed = type != "U";
      const int size = field.type.bytes;
      const bool sound = type == "F" ? size == 4 || size == 8
                                     : (type == "I" || type == "U") &&
                                           (size == 1 || size == 2 || size == 4 || size == 8);
      if (!sound || std::to_string(size) != sizes[i])
        bytes_.fail("its field '" + fields[i].substr(0, 40) + "' has no type of PCD");
      if (!counts.empty()) field.count = static_cast<std::size_t>(whole({counts[i]}, "COUNT"));
      if (field.count > 10000)
        bytes_.fail("its field '" + fields[i].substr(0, 40) + "' has more than 10000 numbers");
      if (field.count != 1) field.field = CloudField::none;
      fields_.push_back(field);
    }
  }

  // Where the numbers of a point are, and whether the file can hold all points.
  void lay_out() {
    std::size_t numbers = 0;
    for (PcdField& field : fields_) {
      field.offset = size_;
      size_ += static_cast<std::size_t>(field.type.bytes) * field.count;
      numbers += field.count;
    }
    const auto has = [&](CloudField wanted) {
      return std::any_of(fields_.begin(), fields_.end(),
                         [&](const PcdField& f) { return f.field == wanted; });
    };
    if (!has(CloudField::x) || !has(CloudField::y) || !has(CloudField::z))
      bytes_.fail("its points lack x, y or z");
    header_.normals = has(CloudField::nx) && has(CloudField::ny) && has(CloudField::nz);
    header_.classes = has(CloudField::classification);
    const std::size_t least = data_ == PcdData::text ? 2 * numbers : size_;
    if (data_ == PcdData::compressed || points_ == 0) return;
    if (points_ > (bytes_.left() + 1) / least)
      bytes_.fail("it is cut short: its header states " + std::to_string(points_) +
                  " points, and the " + std::to_string(bytes_.left()) +
                  " bytes that follow hold at most " + std::to_string((bytes_.left() + 1) / least));
  }

  void unpack() {
    const char* sizes = bytes_.take(8, "the sizes of its data");
    const std::uint64_t packed = little_number(sizes, 4), unpacked = little_number(sizes + 4, 4);
    if (points_ > kMostUnpacked / size_ || unpacked != points_ * size_)
      bytes_.fail("its compressed data are " + std::to_string(unpacked) + " bytes, and " +
                  std::to_string(points_) + " points of " + std::to_string(size_) +
                  " bytes are stated");
    if (packed > bytes_.left())
      bytes_.fail("it is cut short: of " + std::to_string(packed) + " bytes of compressed data " +
                  std::to_string(bytes_.left()) + " are there");
    bool good = unpacked / kMostOfLzf <= packed;
    if (good) {
      std::string all;
      while (all.size() < packed) {
        const std::size_t part = std::min<std::size_t>(packed - all.size(), 1 << 20);
        all.append(bytes_.take(part, "its compressed data"), part);
      }
      good = unpack_lzf(all, static_cast<std::size_t>(unpacked), unpacked_);
    }
    if (!good) bytes_.fail("its compressed data are damaged");
  }

  void read_text(CloudPoint& point) {
    std::string_view word;
    for (const PcdField& field : fields_)
      for (std::size_t i = 0; i < field.count; ++i) {
        if (!bytes_.word(word)) bytes_.fail("it is cut short: it ends within its points");
        double value = 0;
        if (!number_in(word, value))
          bytes_.fail("'" + std::string(word.substr(0, 40)) + "' is not a number");
        set_cloud_field(point, field.field, value);
      }
  }

  void read_binary(CloudPoint& point, const char* bytes) const {
    for (const PcdField& field : fields_)
      if (field.field != CloudField::none)
        set_cloud_field(point, field.field,
                        ply_number(bytes + field.offset, field.type, PlyEncoding::little));
  }

  // Compressed data hold the first field of all points, then the second, and so on.
  void read_unpacked(CloudPoint& point, std::size_t number) const {
    for (const PcdField& field : fields_)
      if (field.field != CloudField::none)
        set_cloud_field(
            point, field.field,
            ply_number(unpacked_.data() + field.offset * static_cast<std::size_t>(points_) +
                           number * static_cast<std::size_t>(field.type.bytes),
                       field.type, PlyEncoding::little));
  }

  StreamBytes bytes_;
  PcdData data_ = PcdData::text;
  std::vector<PcdField> fields_;
  std::size_t size_ = 0;  // bytes of a point in binary
  std::uint64_t points_ = 0, left_ = 0;
  std::vector<char> unpacked_;
};

}  // namespace

std::unique_ptr<CloudReader> open_pcd_cloud(StreamBytes bytes) {
  return std::make_unique<PcdCloud>(std::move(bytes));
}

}  // namespace lapwing
