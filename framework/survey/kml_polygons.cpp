// SPDX-License-Identifier: Apache-2.0
// How: expat calls back for every element. Nothing may be thrown through its C code, so what is
// wrong is kept, ends the parsing, and is thrown behind it.
#include <expat.h>

#include <charconv>
#include <cmath>
#include <memory>

#include "framework/core/error.h"
#include "framework/survey/polygon_builder.h"

namespace lapwing {
namespace {

constexpr int kDeepest = 64;  // elements

// Without a namespace's prefix.
std::string kml_name(const char* name) {
  const std::string text(name);
  return text.substr(text.find(':') == text.npos ? 0 : text.find(':') + 1);
}

std::string trimmed(const std::string& text) {
  const auto blank = " \t\r\n";
  const auto first = text.find_first_not_of(blank);
  return first == text.npos ? "" : text.substr(first, text.find_last_not_of(blank) - first + 1);
}

std::optional<double> kml_number(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

struct Ring {
  std::vector<Eigen::Vector2d> positions;
  double height = 0;       // m, the first that is not 0
  std::size_t number = 0;  // of its position, from 1
};

// "lon,lat[,alt] lon,lat ..."
Ring ring_of(const std::string& text, const std::string& place) {
  Ring ring;
  std::size_t at = 0;
  const auto blank = " \t\r\n";
  while ((at = text.find_first_not_of(blank, at)) != text.npos) {
    const std::size_t end = std::min(text.find_first_of(blank, at), text.size());
    const std::string_view tuple = std::string_view(text).substr(at, end - at);
    at = end;
    std::vector<double> figures;
    for (std::size_t from = 0; from <= tuple.size();) {
      const std::size_t comma = std::min(tuple.find(',', from), tuple.size());
      const auto figure = kml_number(tuple.substr(from, comma - from));
      if (!figure || figures.size() == 3) {
        figures.clear();
        break;
      }
      figures.push_back(*figure);
      from = comma + 1;
    }
    if (figures.size() < 2)
      throw InputError(place + ": position " + std::to_string(ring.positions.size() + 1) +
                       ": expected 'longitude,latitude' or 'longitude,latitude,altitude', got '" +
                       std::string(tuple.substr(0, 60)) + "'");
    ring.positions.emplace_back(figures[0], figures[1]);
    if (figures.size() == 3 && figures[2] != 0 && ring.height == 0) {
      ring.height = figures[2];
      ring.number = ring.positions.size();
    }
  }
  return ring;
}

class Kml {
 public:
  Kml(const std::string& named, const std::string& what)
      : named_(named), what_(what), parser_(XML_ParserCreate(nullptr), &XML_ParserFree) {
    if (!parser_) throw Error("expat has no memory for a parser");
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(parser_.get(), &called_begin, &called_end);
    XML_SetCharacterDataHandler(parser_.get(), &called_text);
    XML_SetStartDoctypeDeclHandler(parser_.get(), &called_doctype);
  }

  PolygonFile read(std::string_view text) {
    const XML_Status status =
        XML_Parse(parser_.get(), text.data(), static_cast<int>(text.size()), XML_TRUE);
    if (!refusal_.empty()) throw InputError(refusal_);
    if (status != XML_STATUS_OK)
      throw InputError(what_ + ", line " + std::to_string(line()) +
                       ": no sound XML: " + XML_ErrorString(XML_GetErrorCode(parser_.get())));
    require_polygons(file_, named_, what_, names_);
    return std::move(file_);
  }

 private:
  struct Placemark {
    SurveyPolygon about;  // without corners
    std::vector<SurveyPolygon> polygons;
    std::vector<std::pair<std::string, std::string>> properties;
    std::string other;  // a geometry that is no polygon
    std::size_t line = 0;
  };

  std::size_t line() const { return XML_GetCurrentLineNumber(parser_.get()); }

  template <class Work>
  void guarded(Work work) {
    if (!refusal_.empty()) return;
    try {
      work();
    } catch (const std::exception& error) {
      refusal_ = error.what();
      XML_StopParser(parser_.get(), XML_FALSE);
    }
  }
  static void called_begin(void* self, const char* name, const char** attributes) {
    Kml& kml = *static_cast<Kml*>(self);
    kml.guarded([&] { kml.begin(kml_name(name), attributes); });
  }
  static void called_end(void* self, const char* name) {
    Kml& kml = *static_cast<Kml*>(self);
    kml.guarded([&] { kml.end(kml_name(name)); });
  }
  static void called_text(void* self, const char* text, int length) {
    Kml& kml = *static_cast<Kml*>(self);
    kml.guarded([&] { kml.text_.append(text, static_cast<std::size_t>(length)); });
  }
  static void called_doctype(void* self, const char*, const char*, const char*, int) {
    Kml& kml = *static_cast<Kml*>(self);
    kml.guarded([&] { throw InputError(kml.what_ + ": a document type is refused"); });
  }

  std::string parent() const {  // of the innermost element
    return path_.size() > 1 ? path_[path_.size() - 2] : "";
  }

  void begin(const std::string& name, const char** attributes) {
    path_.push_back(name);
    if (path_.size() > kDeepest) throw InputError(what_ + ": elements are nested deeper than 64");
    if (path_.size() == 1 && name != "kml")
      throw InputError(what_ + ": expected the element 'kml', got '" + name + "'");
    text_.clear();
    if (name == "NetworkLink")
      throw InputError(what_ + ", line " + std::to_string(line()) +
                       ": a NetworkLink leads to another file, which is not read: name that file");
    if (name == "Placemark") {
      placemark_.emplace();
      placemark_->line = line();
    }
    if (!placemark_) return;
    if (name == "Polygon") {
      placemark_->polygons.emplace_back();
      mode_ = "clampToGround";
    }
    if (name == "Point" || name == "LineString" || name == "LinearRing" || name == "Model" ||
        name == "Track" || name == "MultiTrack") {
      if (parent() == "Placemark" || parent() == "MultiGeometry") placemark_->other = name;
    }
    if (name == "Data" || name == "SimpleData") {
      property_.clear();
      for (const char** a = attributes; *a; a += 2)
        if (std::string_view(*a) == "name") property_ = a[1];
    }
  }

  void end(const std::string& name) {
    if (placemark_) end_in_placemark(name);
    path_.pop_back();
    text_.clear();
  }

  void end_in_placemark(const std::string& name) {
    Placemark& mark = *placemark_;
    if (name == "name" && parent() == "Placemark") mark.about.name = trimmed(text_);
    if ((name == "value" && parent() == "Data") || name == "SimpleData")
      mark.properties.emplace_back(property_, trimmed(text_));
    if (name == "altitudeMode" && parent() == "Polygon") mode_ = trimmed(text_);
    if (name == "coordinates" && parent() == "LinearRing" && !mark.polygons.empty()) add_ring(mark);
    if (name == "Polygon") finish_polygon(mark);
    if (name == "Placemark") {
      finish_placemark();
      placemark_.reset();
    }
  }

  std::string place_of(const Placemark& mark) const {
    return what_ + ": Placemark" + (mark.about.name.empty() ? "" : " '" + mark.about.name + "'") +
           " at line " + std::to_string(mark.line);
  }

  void add_ring(Placemark& mark) {
    const bool outer = path_.size() > 2 && path_[path_.size() - 3] == "outerBoundaryIs";
    const bool inner = path_.size() > 2 && path_[path_.size() - 3] == "innerBoundaryIs";
    if (!outer && !inner) return;
    SurveyPolygon& polygon = mark.polygons.back();
    const std::string place =
        place_of(mark) +
        (inner ? ", hole " + std::to_string(polygon.holes.size() + 1) : std::string());
    Ring ring = ring_of(text_, place);
    if (ring.height != 0 && height_ == 0) height_ = ring.height, height_corner_ = ring.number;
    auto corners = open_ring(std::move(ring.positions), place);
    if (inner) {
      polygon.holes.push_back(std::move(corners));
    } else {
      if (!polygon.outline.empty()) throw InputError(place + ": a polygon has two outlines");
      polygon.outline = std::move(corners);
    }
  }

  // Clamped to the ground, heights in coordinates mean nothing by the standard.
  void finish_polygon(const Placemark& mark) {
    if (mark.polygons.back().outline.empty())
      throw InputError(place_of(mark) + ": a polygon has no outerBoundaryIs");
    if (height_ != 0 && !mode_.starts_with("clampTo"))
      refuse_heights(place_of(mark), height_, height_corner_,
                     "which its altitudeMode '" + mode_ + "' takes above the sea or the ground");
    height_ = 0;
  }

  void finish_placemark() {
    Placemark& mark = *placemark_;
    mark.about.place = place_of(mark);
    if (!mark.about.name.empty()) names_.push_back(mark.about.name);
    if (!named_.empty() && mark.about.name != named_) return;
    if (!mark.other.empty() || mark.polygons.empty())
      throw InputError(mark.about.place + ": expected a Polygon, got " +
                       (mark.other.empty() ? "no geometry" : "a " + mark.other) +
                       "; `named` takes what has one name from a file with other things");
    for (const auto& [key, text] : mark.properties) {
      if (!is_polygon_property(key)) continue;
      const auto number = kml_number(text);
      if (!number)
        throw InputError(mark.about.place + ": '" + key + "': expected a number, got '" +
                         text.substr(0, 60) + "'");
      set_property(mark.about, key, *number);
    }
    for (SurveyPolygon& polygon : mark.polygons) {
      SurveyPolygon whole = mark.about;
      whole.outline = std::move(polygon.outline);
      whole.holes = std::move(polygon.holes);
      file_.polygons.push_back(std::move(whole));
    }
  }

  const std::string& named_;
  const std::string& what_;
  std::unique_ptr<std::remove_pointer_t<XML_Parser>, void (*)(XML_Parser)> parser_;
  PolygonFile file_;
  std::vector<std::string> names_, path_;
  std::string text_, property_, mode_, refusal_;
  double height_ = 0;  // m, the first of the polygon that is not 0
  std::size_t height_corner_ = 0;
  std::optional<Placemark> placemark_;
};

}  // namespace

PolygonFile read_kml(std::string_view text, const std::string& named, const std::string& what) {
  return Kml(named, what).read(text);
}

}  // namespace lapwing
