// SPDX-License-Identifier: Apache-2.0
#include "plugins/flight_logs/gpx/gpx_log.h"

#include <expat.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <memory>
#include <string>

#include "framework/core/error.h"
#include "framework/flight_log/log_builder.h"

namespace lapwing::gpx_log {
namespace {

constexpr std::size_t kLongestText = 256;  // bytes, of one element that is read
constexpr int kDeepest = 64;

double number_of(std::string_view text) {
  while (!text.empty() && (text.front() <= ' ' || text.front() == '+')) text.remove_prefix(1);
  while (!text.empty() && text.back() <= ' ') text.remove_suffix(1);
  double value = NAN;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() ? value : NAN;
}

// s since 1970 of "2024-05-12T09:30:01.25Z", also with a zone "+02:00"; else not a number.
double utc_of(std::string_view text) {
  while (!text.empty() && text.front() <= ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() <= ' ') text.remove_suffix(1);
  if (text.size() < 19 || text[4] != '-' || text[7] != '-' || text[10] != 'T' || text[13] != ':' ||
      text[16] != ':')
    return NAN;
  double zone = 0;
  if (text.ends_with('Z')) {
    text.remove_suffix(1);
  } else if (const char sign = text[text.size() - 6];
             text.size() >= 25 && (sign == '+' || sign == '-') && text[text.size() - 3] == ':') {
    zone = 3600 * number_of(text.substr(text.size() - 5, 2)) +
           60 * number_of(text.substr(text.size() - 2));
    if (sign == '-') zone = -zone;
    text.remove_suffix(6);
  }
  const auto part = [&](std::size_t from, std::size_t count) {
    return number_of(text.substr(from, count));
  };
  const double year = part(0, 4), month = part(5, 2), day = part(8, 2);
  const double clock = 3600 * part(11, 2) + 60 * part(14, 2) + number_of(text.substr(17));
  if (!std::isfinite(year + month + day + clock + zone)) return NAN;
  if (!(year >= 1970 && year <= 9999 && month >= 1 && month <= 12 && day >= 1 && day <= 31))
    return NAN;
  const std::chrono::year_month_day date{std::chrono::year(static_cast<int>(year)),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  if (!date.ok()) return NAN;
  return 86400.0 * static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count()) +
         clock - zone;
}

struct Point {
  double latitude = NAN, longitude = NAN, height = NAN, utc = NAN;
};

// What the parser finds, and where it stopped.
struct Track {
  std::vector<Point> points;
  std::string text, root, creator;
  Point point;
  int depth = 0;
  bool in_point = false, wants_text = false;
  std::string refusal;
  XML_Parser parser = nullptr;
};

// Without a namespace's prefix.
std::string_view local_name(const char* name) {
  const std::string_view text(name);
  return text.substr(text.find(':') == text.npos ? 0 : text.find(':') + 1);
}

void begin(void* data, const char* name, const char** attributes) {
  Track& track = *static_cast<Track*>(data);
  const std::string_view element = local_name(name);
  if (++track.depth > kDeepest) {
    track.refusal = "elements are nested deeper than 64";
    XML_StopParser(track.parser, XML_FALSE);
    return;
  }
  if (track.depth == 1) track.root = element;
  const auto attribute = [&](std::string_view wanted) -> std::string {
    for (const char** a = attributes; *a; a += 2)
      if (wanted == *a) return a[1];
    return "";
  };
  if (track.depth == 1) track.creator = attribute("creator").substr(0, 80);
  track.text.clear();
  if (element == "trkpt") {
    track.in_point = true;
    track.point = {number_of(attribute("lat")), number_of(attribute("lon")), NAN, NAN};
  }
  track.wants_text = track.in_point && (element == "ele" || element == "time");
}

void end(void* data, const char* name) {
  Track& track = *static_cast<Track*>(data);
  const std::string_view element = local_name(name);
  --track.depth;
  if (track.wants_text && element == "ele") track.point.height = number_of(track.text);
  if (track.wants_text && element == "time") track.point.utc = utc_of(track.text);
  track.wants_text = false;
  if (element == "trkpt" && track.in_point) {
    track.points.push_back(track.point);
    track.in_point = false;
  }
}

void characters(void* data, const char* text, int length) {
  Track& track = *static_cast<Track*>(data);
  if (track.wants_text && track.text.size() + static_cast<std::size_t>(length) < kLongestText)
    track.text.append(text, static_cast<std::size_t>(length));
}

// Nothing but tracks is wanted, and entities are how small files become large ones.
void doctype(void* data, const char*, const char*, const char*, int) {
  Track& track = *static_cast<Track*>(data);
  track.refusal = "a document type is declared, which GPX has none of";
  XML_StopParser(track.parser, XML_FALSE);
}

bool timed(const Point& point) {
  return std::isfinite(point.utc);
}

void add_points(const Track& track, double rate, LogBuilder& builder) {
  const bool times = std::all_of(track.points.begin(), track.points.end(), timed);
  const bool any = std::any_of(track.points.begin(), track.points.end(), timed);
  if (!any && rate <= 0)
    throw InputError(
        "none of its points has a time (<time>), so that it is a path and no recorded flight; if "
        "its points are evenly apart in time, --format gpx:rate=10 says how many there are in a "
        "second");
  const double start = any ? std::find_if(track.points.begin(), track.points.end(), timed)->utc : 0;
  if (any) builder.log.utc = start;
  builder.log.clock = any ? "the first point" : "the first point, at the stated rate";
  std::size_t number = 0, skipped = 0;
  for (const Point& point : track.points) {
    const double time = any ? point.utc - start : static_cast<double>(number) / rate;
    ++number;
    if (any && !timed(point)) {
      ++skipped;
      continue;
    }
    builder.add("place", time, {point.latitude, point.longitude, point.height});
  }
  if (!times && any)
    builder.log.remarks.push_back(std::to_string(skipped) + " points have no time");
}

}  // namespace

bool recognizes(std::string_view bytes) {
  const std::string_view head = bytes.substr(0, 4096);
  const std::size_t at = head.find("<gpx");
  const std::size_t first = head.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  return at != head.npos && first != head.npos && head[first] == '<';
}

FlightLog read(std::string_view bytes, double rate) {
  Track track;
  const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(
      XML_ParserCreate(nullptr), &XML_ParserFree);
  if (!parser) throw std::bad_alloc();
  track.parser = parser.get();
  XML_SetUserData(parser.get(), &track);
  XML_SetElementHandler(parser.get(), begin, end);
  XML_SetCharacterDataHandler(parser.get(), characters);
  XML_SetStartDoctypeDeclHandler(parser.get(), doctype);
  LogBuilder builder("gpx", bytes.size());
  std::string damage;
  constexpr std::size_t kPart = std::size_t{1} << 28;  // the parser counts in int
  for (std::size_t at = 0; at < bytes.size() && damage.empty(); at += kPart) {
    const std::string_view part = bytes.substr(at, kPart);
    const bool last = at + part.size() == bytes.size();
    if (XML_Parse(parser.get(), part.data(), static_cast<int>(part.size()), last) == XML_STATUS_OK)
      continue;
    damage = "line " + std::to_string(XML_GetCurrentLineNumber(parser.get())) + ": " +
             (track.refusal.empty() ? XML_ErrorString(XML_GetErrorCode(parser.get()))
                                    : track.refusal.c_str());
    const auto place = XML_GetCurrentByteIndex(parser.get());
    builder.log.bytes_read =
        place < 0 ? 0 : std::min(bytes.size(), static_cast<std::size_t>(place));
  }
  if (!track.refusal.empty()) throw InputError(damage);
  if (track.root != "gpx")
    throw InputError((damage.empty() ? "" : damage + "; ") + "expected an XML file with <gpx>");
  if (track.points.size() < 2)
    throw InputError("it has " + std::to_string(track.points.size()) +
                     " track points (<trkpt>), two or more are a flight" +
                     (damage.empty() ? "" : "; " + damage));
  builder.log.damage = damage;
  builder.log.recorder = track.creator;
  builder.log.heights = HeightOf::sea;
  builder.log.records.push_back({"trkpt", track.points.size()});
  add_points(track, rate, builder);
  FlightLog log = builder.finish();
  if (log.series.empty())
    throw InputError("no track point has a latitude, a longitude and a height (<ele>)");
  return log;
}

}  // namespace lapwing::gpx_log
