// SPDX-License-Identifier: Apache-2.0
#include "framework/photogrammetry/exif_position.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <memory>

#include "framework/core/error.h"
#include "framework/core/files.h"

#ifdef LAPWING_HAS_EXIF
#include <libexif/exif-data.h>
#endif

namespace lapwing {
namespace {

namespace fs = std::filesystem;

bool is_jpeg(const fs::path& file) {
  std::string end = file.extension().string();
  std::transform(end.begin(), end.end(), end.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return end == ".jpg" || end == ".jpeg";
}

#ifdef LAPWING_HAS_EXIF
struct Unreference {
  void operator()(ExifData* data) const { exif_data_unref(data); }
};

// The rational numbers of an entry; nothing where it has not so many.
std::optional<std::vector<double>> rationals(ExifData* data, int tag, unsigned count) {
  const ExifEntry* entry =
      exif_content_get_entry(data->ifd[EXIF_IFD_GPS], static_cast<ExifTag>(tag));
  if (!entry || entry->format != EXIF_FORMAT_RATIONAL || entry->components != count ||
      entry->size < 8 * count) {
    return std::nullopt;
  }
  std::vector<double> numbers;
  for (unsigned k = 0; k < count; ++k) {
    const ExifRational r = exif_get_rational(entry->data + 8 * k, exif_data_get_byte_order(data));
    if (r.denominator == 0) return std::nullopt;
    numbers.push_back(static_cast<double>(r.numerator) / r.denominator);
  }
  return numbers;
}

// The first byte of an entry, -1 where there is none.
int first_byte(ExifData* data, int tag) {
  const ExifEntry* entry =
      exif_content_get_entry(data->ifd[EXIF_IFD_GPS], static_cast<ExifTag>(tag));
  return entry && entry->size > 0 ? entry->data[0] : -1;
}
#endif

}  // namespace

#ifdef LAPWING_HAS_EXIF
bool reads_exif() {
  return true;
}

std::optional<PhotoPosition> exif_position(const fs::path& file) {
  const std::string bytes = read_file(file);
  const std::unique_ptr<ExifData, Unreference> data(exif_data_new_from_data(
      reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<unsigned>(bytes.size())));
  if (!data) throw InputError("'" + file.string() + "': its EXIF data cannot be read");
  const auto north = rationals(data.get(), EXIF_TAG_GPS_LATITUDE, 3);
  const auto east = rationals(data.get(), EXIF_TAG_GPS_LONGITUDE, 3);
  const auto up = rationals(data.get(), EXIF_TAG_GPS_ALTITUDE, 1);
  if (!north || !east || !up) return std::nullopt;
  const auto degrees = [](const std::vector<double>& v) { return v[0] + v[1] / 60 + v[2] / 3600; };
  PhotoPosition position{file.filename().string(), {degrees(*north), degrees(*east), (*up)[0]}};
  if (first_byte(data.get(), EXIF_TAG_GPS_LATITUDE_REF) == 'S') position.point.latitude_deg *= -1;
  if (first_byte(data.get(), EXIF_TAG_GPS_LONGITUDE_REF) == 'W') position.point.longitude_deg *= -1;
  if (first_byte(data.get(), EXIF_TAG_GPS_ALTITUDE_REF) == 1) position.point.altitude *= -1;
  check_geodetic(position.point, ("'" + file.string() + "'").c_str());
  return position;
}
#else
bool reads_exif() {
  return false;
}

std::optional<PhotoPosition> exif_position(const fs::path& file) {
  throw InputError("'" + file.string() +
                   "': this build does not read positions of photographs: install Debian's "
                   "libexif-dev (scripts/setup.sh --for sites) and build again");
}
#endif

std::vector<PhotoPosition> exif_positions(const fs::path& folder, std::size_t& without) {
  std::error_code error;
  std::vector<fs::path> files;
  fs::directory_iterator entries(folder, error);
  if (error) throw InputError("'" + folder.string() + "' cannot be listed: " + error.message());
  for (const auto& entry : entries)
    if (is_jpeg(entry.path())) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty())
    throw InputError("'" + folder.string() + "' holds no photograph (.jpg, .jpeg)");
  std::vector<PhotoPosition> positions;
  without = 0;
  for (const fs::path& file : files) {
    if (auto position = exif_position(file))
      positions.push_back(std::move(*position));
    else
      ++without;
  }
  return positions;
}

}  // namespace lapwing
