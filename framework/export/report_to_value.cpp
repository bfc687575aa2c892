// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "framework/core/base64.h"
#include "framework/export/report_value.h"

namespace lapwing {
namespace {

// A gap where it is not finite.
Value number_value(double number) {
  return std::isfinite(number) ? Value(number) : Value();
}

Value number_values(const std::vector<double>& all) {
  Value list = Value::list();
  for (const double one : all) list.push_back(number_value(one));
  return list;
}

Value point_value(const Eigen::Vector3d& p) {
  if (!p.allFinite()) return Value();
  return Value(Value::List{p.x(), p.y(), p.z()});
}

template <class Entries, class Make>
Value list_of(const Entries& entries, const Make& make) {
  Value list = Value::list();
  for (const auto& entry : entries) list.push_back(make(entry));
  return list;
}

// Only what says something is written.
void set_text(Value& value, const char* key, const std::string& text) {
  if (!text.empty()) value.set(key, text);
}
void set_flag(Value& value, const char* key, bool flag) {
  if (flag) value.set(key, true);
}
void set_mark(Value& value, Mark mark) {
  constexpr const char* kWords[] = {"none", "pass", "fail", "skipped"};
  if (mark != Mark::none) value.set("result", kWords[static_cast<std::size_t>(mark)]);
}

Value axis_value(const Axis& a) {
  Value value = Value::map();
  value.set("label", a.label);
  set_text(value, "unit", a.unit);
  set_flag(value, "logarithmic", a.logarithmic);
  set_flag(value, "whole", a.whole);
  return value;
}

Value typed(const char* type) {
  Value value = Value::map();
  value.set("type", type);
  return value;
}

Value block_value(const TextBlock& b) {
  Value value = typed("text");
  value.set("text", b.text);
  set_flag(value, "preformatted", b.preformatted);
  set_text(value, "folded", b.folded_title);
  return value;
}

Value block_value(const Facts& b) {
  Value value = typed("facts");
  value.set("facts", list_of(b.facts, [](const Fact& f) {
              Value fact = Value::map();
              fact.set("label", f.label);
              fact.set("value", f.value);
              set_text(fact, "unit", f.unit);
              set_mark(fact, f.mark);
              return fact;
            }));
  return value;
}

Value block_value(const Table& b) {
  Value value = typed("table");
  set_text(value, "title", b.title);
  value.set("columns", list_of(b.columns, [](const TableColumn& c) {
              Value column = Value::map();
              column.set("name", c.name);
              set_text(column, "unit", c.unit);
              return column;
            }));
  value.set("rows", list_of(b.rows, [](const TableRow& r) {
              Value row = Value::map();
              row.set("cells", list_of(r.cells, [](const TableCell& c) {
                        const double* figure = std::get_if<double>(&c);
                        return figure ? number_value(*figure) : Value(std::get<std::string>(c));
                      }));
              set_mark(row, r.mark);
              return row;
            }));
  return value;
}

Value block_value(const Chart& b) {
  Value value = typed("chart");
  value.set("title", b.title);
  value.set("x", axis_value(b.x));
  value.set("y", axis_value(b.y));
  value.set("series", list_of(b.series, [](const Series& s) {
              Value series = Value::map();
              series.set("name", s.name);
              series.set("x", number_values(s.x));
              series.set("y", number_values(s.y));
              set_flag(series, "stepped", s.stepped);
              if (!s.spread.empty()) series.set("spread", number_values(s.spread));
              return series;
            }));
  value.set("limits", list_of(b.limits, [](const LimitLine& l) {
              Value limit = Value::map();
              limit.set("label", l.label);
              limit.set("value", l.value);
              return limit;
            }));
  value.set("markers", list_of(b.markers, [](const Marker& m) {
              Value marker = Value::map();
              marker.set("label", m.label);
              marker.set("x", m.x);
              return marker;
            }));
  value.set("spans", list_of(b.spans, [](const Span& s) {
              Value span = Value::map();
              span.set("label", s.label);
              span.set("from", s.from);
              span.set("to", s.to);
              return span;
            }));
  return value;
}

Value zone_value(const Zone& z) {
  Value value = Value::map();
  value.set("name", z.name);
  value.set("corners", list_of(z.corners, [](const Eigen::Vector2d& c) {
              return Value(Value::List{c.x(), c.y()});
            }));
  if (std::isfinite(z.floor)) value.set("floor", z.floor);
  if (std::isfinite(z.ceiling)) value.set("ceiling", z.ceiling);
  return value;
}

Value solid_value(const Solid& s) {
  Value value = Value::map();
  value.set("name", s.name);
  value.set("vertices", list_of(s.surface.vertices, point_value));
  value.set("triangles", list_of(s.surface.triangles, [](const std::array<std::int32_t, 3>& t) {
              return Value(Value::List{t[0], t[1], t[2]});
            }));
  return value;
}

Value line_value(const Polyline& l) {
  Value value = Value::map();
  value.set("name", l.name);
  value.set("points", list_of(l.points, point_value));
  if (!l.along.empty()) value.set("along", number_values(l.along));
  if (!l.values.empty()) value.set("values", number_values(l.values));
  return value;
}

void add_drawing(Value& value, const Drawing& d) {
  value.set("lines", list_of(d.lines, line_value));
  value.set("points", list_of(d.points, [](const LabelledPoint& p) {
              Value labelled = Value::map();
              labelled.set("label", p.label);
              labelled.set("position", point_value(p.position));
              return labelled;
            }));
  value.set("spheres", list_of(d.spheres, [](const Sphere& s) {
              Value sphere = Value::map();
              sphere.set("name", s.name);
              sphere.set("center", point_value(s.center));
              sphere.set("radius", s.radius);
              return sphere;
            }));
  value.set("boxes", list_of(d.boxes, [](const Box& b) {
              Value box = Value::map();
              box.set("name", b.name);
              box.set("lower", point_value(b.lower));
              box.set("upper", point_value(b.upper));
              return box;
            }));
  value.set("zones", list_of(d.zones, zone_value));
  value.set("solids", list_of(d.solids, solid_value));
  value.set("along", axis_value(d.along));
  value.set("value", axis_value(d.value));
}

Value block_value(const PathView& b) {
  Value value = typed("path");
  value.set("title", b.title);
  value.set("projection", projection_names()[static_cast<std::size_t>(b.projection)]);
  add_drawing(value, b.drawing);
  return value;
}

Value block_value(const Scene3D& b) {
  Value value = typed("scene");
  value.set("title", b.title);
  add_drawing(value, b.drawing);
  return value;
}

Value block_value(const Image& b) {
  Value value = typed("image");
  value.set("caption", b.caption);
  value.set("png_base64", base64(b.png));
  return value;
}

Value block_value(const FilmStrip& b) {
  Value value = typed("strip");
  value.set("title", b.title);
  value.set("frames", list_of(b.frames, [](const FilmFrame& f) {
              Value frame = Value::map();
              frame.set("caption", f.caption);
              frame.set("png_base64", base64(f.png));
              frame.set("width", f.width);
              frame.set("height", f.height);
              frame.set("boxes", list_of(f.boxes, [](const FrameBox& b) {
                          Value box = Value::map();
                          box.set("label", b.label);
                          box.set("left", b.left);
                          box.set("top", b.top);
                          box.set("right", b.right);
                          box.set("bottom", b.bottom);
                          return box;
                        }));
              return frame;
            }));
  return value;
}

}  // namespace

Value to_value(const Report& report) {
  Value value = Value::map();
  value.set("title", report.title);
  set_text(value, "subtitle", report.subtitle);
  set_text(value, "status", report.status);
  set_mark(value, report.status_mark);
  value.set("sections", list_of(report.sections, [](const Section& s) {
              Value section = Value::map();
              section.set("title", s.title);
              section.set("blocks", list_of(s.blocks, [](const Block& b) {
                            return std::visit([](const auto& one) { return block_value(one); }, b);
                          }));
              return section;
            }));
  return value;
}

}  // namespace lapwing
