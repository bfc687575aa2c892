// SPDX-License-Identifier: Apache-2.0
#include "framework/export/report_data.h"

#include <charconv>
#include <unordered_map>

#include <nlohmann/json.hpp>

#include "framework/core/error.h"

namespace lapwing {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kDigits = 7;

Json rounded(double value) {
  if (!std::isfinite(value)) return nullptr;
  char text[32];
  const auto end =
      std::to_chars(text, text + sizeof text, value, std::chars_format::general, kDigits).ptr;
  double short_value = 0;
  std::from_chars(text, end, short_value);
  // Whole numbers without ".0".
  if (short_value == std::floor(short_value) && std::abs(short_value) < 1e9) {
    return static_cast<std::int64_t>(short_value);
  }
  return short_value;
}

class Writer {
 public:
  Json blocks = Json::array();

  void enter(const std::string& section, const std::string& block) {
    where_ = "report section '" + section + "', block '" + block + "': ";
  }
  [[noreturn]] void fail(const std::string& message) const { throw Error(where_ + message); }

  double finite(double value, const std::string& what) const {
    if (!std::isfinite(value)) fail(what + " is not finite");
    return value;
  }

  std::size_t array(const std::vector<double>& numbers) {
    Json list = Json::array();
    for (const double v : numbers) list.push_back(rounded(v));
    std::string text = list.dump();
    const auto [found, inserted] = index_.try_emplace(text, arrays_.size());
    if (inserted) arrays_.push_back(std::move(text));
    return found->second;
  }

  // As `array`, for numbers that a cursor searches.
  std::size_t ascending(const std::vector<double>& numbers, const std::string& what) {
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      finite(numbers[i], what + "[" + std::to_string(i) + "]");
      if (i > 0 && numbers[i] < numbers[i - 1]) {
        fail(what + "[" + std::to_string(i) + "] is below the one before it");
      }
    }
    return array(numbers);
  }

  std::string text() const {
    std::string out = "{\"arrays\":[";
    for (std::size_t i = 0; i < arrays_.size(); ++i) out += (i > 0 ? ",\n" : "\n") + arrays_[i];
    out += "],\n\"blocks\":";
    out += blocks.dump(-1, ' ', true, Json::error_handler_t::replace);
    return out + "}";
  }

 private:
  std::string where_;
  std::vector<std::string> arrays_;
  std::unordered_map<std::string, std::size_t> index_;
};

Json axis(const Axis& a) {
  return {{"label", a.label}, {"unit", a.unit}, {"log", a.logarithmic}, {"whole", a.whole}};
}

Json chart(const Chart& c, Writer& writer) {
  Json series = Json::array();
  for (const Series& s : c.series) {
    if (s.x.size() != s.y.size()) {
      writer.fail("series '" + s.name + "' has " + std::to_string(s.x.size()) + " x and " +
                  std::to_string(s.y.size()) + " y");
    }
    if (!s.spread.empty() && s.spread.size() != s.y.size())
      writer.fail("series '" + s.name + "' has " + std::to_string(s.spread.size()) +
                  " of spread and " + std::to_string(s.y.size()) + " y");
    Json one = {{"name", s.name},
                {"x", writer.ascending(s.x, "x of series '" + s.name + "'")},
                {"y", writer.array(s.y)},
                {"stepped", s.stepped}};
    if (!s.spread.empty()) one["spread"] = writer.array(s.spread);
    series.push_back(std::move(one));
  }
  Json limits = Json::array(), markers = Json::array(), spans = Json::array();
  for (const LimitLine& l : c.limits) {
    limits.push_back({{"label", l.label}, {"value", rounded(writer.finite(l.value, "a limit"))}});
  }
  for (const Marker& m : c.markers) {
    markers.push_back({{"label", m.label}, {"x", rounded(writer.finite(m.x, "a marker"))}});
  }
  for (const Span& s : c.spans) {
    if (s.to < s.from) writer.fail("span '" + s.label + "' ends before it begins");
    spans.push_back({{"label", s.label},
                     {"from", rounded(writer.finite(s.from, "a span"))},
                     {"to", rounded(writer.finite(s.to, "a span"))}});
  }
  return {{"type", "chart"},  {"title", c.title}, {"x", axis(c.x)},     {"y", axis(c.y)},
          {"series", series}, {"limits", limits}, {"markers", markers}, {"spans", spans}};
}

Json vector(const Eigen::Vector3d& v, const std::string& what, const Writer& writer) {
  Json list = Json::array();
  for (int i = 0; i < 3; ++i) list.push_back(rounded(writer.finite(v[i], what)));
  return list;
}

Json line(const Polyline& l, Writer& writer) {
  const std::size_t n = l.points.size();
  const auto check = [&](std::size_t count, const char* what) {
    if (count != 0 && count != n) {
      writer.fail("line '" + l.name + "' has " + std::to_string(n) + " points and " +
                  std::to_string(count) + " " + what);
    }
  };
  check(l.along.size(), "positions along it");
  check(l.values.size(), "values");
  Json out{{"name", l.name}};
  for (int axis_index = 0; axis_index < 3; ++axis_index) {
    std::vector<double> column(n);
    for (std::size_t i = 0; i < n; ++i) column[i] = l.points[i][axis_index];
    out[std::string(1, "xyz"[axis_index])] = writer.array(column);
  }
  if (!l.along.empty()) out["along"] = writer.ascending(l.along, "positions along line");
  if (!l.values.empty()) out["values"] = writer.array(l.values);
  return out;
}

// Without bounds, `floor` and `ceiling` are null.
Json zone(const Zone& z, const Writer& writer) {
  Json x = Json::array(), y = Json::array();
  for (const Eigen::Vector2d& corner : z.corners) {
    x.push_back(rounded(writer.finite(corner.x(), "a corner of a zone")));
    y.push_back(rounded(writer.finite(corner.y(), "a corner of a zone")));
  }
  return {{"label", z.name},
          {"x", x},
          {"y", y},
          {"floor", rounded(z.floor)},
          {"ceiling", rounded(z.ceiling)}};
}

Json drawing(const Drawing& d, Writer& writer) {
  Json lines = Json::array(), points = Json::array(), spheres = Json::array(),
       boxes = Json::array();
  for (const Polyline& l : d.lines) lines.push_back(line(l, writer));
  for (const LabelledPoint& p : d.points) {
    points.push_back({{"label", p.label}, {"at", vector(p.position, "a point", writer)}});
  }
  for (const Sphere& s : d.spheres) {
    spheres.push_back({{"label", s.name},
                       {"center", vector(s.center, "the centre of a sphere", writer)},
                       {"radius", rounded(writer.finite(s.radius, "the radius of a sphere"))}});
  }
  for (const Box& b : d.boxes) {
    boxes.push_back({{"label", b.name},
                     {"lower", vector(b.lower, "a corner of a box", writer)},
                     {"upper", vector(b.upper, "a corner of a box", writer)}});
  }
  Json zones = Json::array(), solids = Json::array();
  for (const Zone& z : d.zones) zones.push_back(zone(z, writer));
  for (const Solid& s : d.solids) {
    Json corners = Json::array(), faces = Json::array();
    for (const Eigen::Vector3d& p : s.surface.vertices)
      corners.push_back(vector(p, "a corner of a solid", writer));
    for (const auto& face : s.surface.triangles) faces.push_back(face);
    solids.push_back({{"label", s.name}, {"corners", corners}, {"faces", faces}});
  }
  return {{"lines", lines}, {"points", points}, {"spheres", spheres},     {"boxes", boxes},
          {"zones", zones}, {"solids", solids}, {"along", axis(d.along)}, {"value", axis(d.value)}};
}

void write(const Chart& c, const Section& section, Writer& writer) {
  writer.enter(section.title, c.title);
  writer.blocks.push_back(chart(c, writer));
}

void write(const PathView& v, const Section& section, Writer& writer) {
  writer.enter(section.title, v.title);
  writer.blocks.push_back(
      {{"type", "path"},
       {"title", v.title},
       {"projection", projection_names().at(static_cast<std::size_t>(v.projection))},
       {"drawing", drawing(v.drawing, writer)}});
}

void write(const Scene3D& s, const Section& section, Writer& writer) {
  writer.enter(section.title, s.title);
  writer.blocks.push_back(
      {{"type", "scene"}, {"title", s.title}, {"drawing", drawing(s.drawing, writer)}});
}

template <class Other>
void write(const Other&, const Section&, Writer&) {}  // plain HTML, nothing to draw

}  // namespace

std::string report_data(const Report& report) {
  Writer writer;
  for (const Section& section : report.sections) {
    for (const Block& block : section.blocks) {
      std::visit([&](const auto& b) { write(b, section, writer); }, block);
    }
  }
  // "</script>" and "<!--" may not occur in a script element, whatever its type.
  std::string safe;
  for (const char c : writer.text()) {
    if (c == '<')
      safe += "\\u003c";
    else if (c == '>')
      safe += "\\u003e";
    else if (c == '&')
      safe += "\\u0026";
    else
      safe += c;
  }
  return safe;
}

}  // namespace lapwing
