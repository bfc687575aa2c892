// SPDX-License-Identifier: Apache-2.0
#include "framework/export/report_value.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/core/base64.h"
#include "framework/core/fields.h"

namespace lapwing {
namespace {

constexpr int kMostPixels = 100'000;  // across a frame of a strip

const Value::List& entries(const Value& list) {
  static const Value::List none;
  return list.is_list() ? list.as_list() : none;
}

// An empty Lua table is no list yet; here it means one without entries.
bool empty_table(const Value& value) {
  return value.is_map() && value.as_map().empty();
}

std::vector<Fields> tables(Fields& fields, const char* name, bool required = false) {
  const Value* list = fields.find(name);
  if (list == nullptr ? !required : empty_table(*list)) {
    fields.opaque(name);
    return {};
  }
  return fields.tables(name);
}

// Whether an optional field is there; either way it is known to the search for misspelt ones.
bool given(Fields& fields, const char* name) {
  fields.opaque(name);
  return fields.has(name);
}

bool flag(Fields& fields, const char* name) {
  return given(fields, name) && fields.boolean(name);
}

Mark mark(Fields& fields) {
  if (!given(fields, "result")) return Mark::none;
  return static_cast<Mark>(fields.choice("result", {"none", "pass", "fail", "skipped"}));
}

// Numbers; where `gaps`, null and what is not finite are kept as gaps.
std::vector<double> numbers(Fields& fields, const char* name, bool required, bool gaps) {
  if (required && !fields.has(name)) fields.add_error(name, "missing");
  const Value list = fields.opaque(name);
  std::vector<double> out;
  if (list.is_null() || empty_table(list)) return out;
  if (!list.is_list()) fields.add_error(name, "expected a list, got " + list.describe_type());
  for (const Value& entry : entries(list)) {
    const bool gap = entry.is_null() || (entry.is_number() && !std::isfinite(entry.as_number()));
    if (gap && gaps) {
      out.push_back(std::numeric_limits<double>::quiet_NaN());
    } else if (entry.is_number() && !gap) {
      out.push_back(entry.as_number());
    } else {
      fields.add_error(
          std::string(name) + "[" + std::to_string(out.size() + 1) + "]",
          gap ? "expected a finite number" : "expected a number, got " + entry.describe_type());
      break;
    }
  }
  return out;
}

// Where `gaps`, null is one.
std::vector<Eigen::Vector3d> points(Fields& fields, const char* name, bool gaps) {
  if (!fields.has(name)) fields.add_error(name, "missing");
  const Value list = fields.opaque(name);
  std::vector<Eigen::Vector3d> out;
  if (!list.is_null() && !list.is_list() && !empty_table(list)) {
    fields.add_error(name, "expected a list, got " + list.describe_type());
  }
  for (const Value& entry : entries(list)) {
    if (gaps && entry.is_null()) {
      out.push_back(Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
      continue;
    }
    const Value::List& triple = entries(entry);
    if (triple.size() != 3 ||
        !std::all_of(triple.begin(), triple.end(), [](const Value& v) { return v.is_number(); })) {
      fields.add_error(std::string(name) + "[" + std::to_string(out.size() + 1) + "]",
                       "expected a list of 3 numbers");
      break;
    }
    out.emplace_back(triple[0].as_number(), triple[1].as_number(), triple[2].as_number());
  }
  return out;
}

// Of a number that a whole number is expected for: -1 where it is none, which no mesh has.
std::int32_t place_of(double number) {
  const bool whole = number >= 0 && number <= 1e9 && number == std::floor(number);
  return whole ? static_cast<std::int32_t>(number) : -1;
}

Axis axis(Fields fields, bool may_be_logarithmic) {
  Axis out{fields.text("label"), fields.optional_text("unit")};
  if (may_be_logarithmic) out.logarithmic = flag(fields, "logarithmic");
  out.whole = flag(fields, "whole");
  fields.finish();
  return out;
}

TextBlock text_block(Fields& fields) {
  return {fields.text("text"), flag(fields, "preformatted"), fields.optional_text("folded")};
}

Facts facts_block(Fields& fields) {
  Facts out;
  for (Fields& f : tables(fields, "facts", true)) {
    Fact fact{f.text("label"), {}, {}};
    const Value* value = f.find("value");
    if (value != nullptr && value->is_number()) {
      fact.value = number_text(f.opaque("value").as_number());
    } else {
      fact.value = f.text("value");
    }
    fact.unit = f.optional_text("unit");
    fact.mark = mark(f);
    f.finish();
    out.facts.push_back(std::move(fact));
  }
  return out;
}

Table table_block(Fields& fields) {
  Table out{fields.optional_text("title"), {}, {}};
  for (Fields& f : tables(fields, "columns", true)) {
    out.columns.push_back({f.text("name"), f.optional_text("unit")});
    f.finish();
  }
  for (Fields& f : tables(fields, "rows")) {
    TableRow row;
    const Value cells = f.opaque("cells");
    if (!cells.is_list()) f.add_error("cells", "expected a list of texts and numbers");
    for (const Value& cell : entries(cells)) {
      if (cell.is_number()) {
        row.cells.emplace_back(cell.as_number());
      } else if (cell.is_text()) {
        row.cells.emplace_back(cell.as_text());
      } else if (cell.is_null()) {
        row.cells.emplace_back(std::numeric_limits<double>::quiet_NaN());
      } else {
        f.add_error("cells[" + std::to_string(row.cells.size() + 1) + "]",
                    "expected a text or a number, got " + cell.describe_type());
        break;
      }
    }
    row.mark = mark(f);
    f.finish();
    out.rows.push_back(std::move(row));
  }
  return out;
}

Chart chart_block(Fields& fields) {
  Chart out;
  out.title = fields.text("title");
  out.x = axis(fields.table("x"), false);
  out.y = axis(fields.table("y"), true);
  for (Fields& f : tables(fields, "series", true)) {
    out.series.push_back({f.text("name"), numbers(f, "x", true, false), numbers(f, "y", true, true),
                          flag(f, "stepped"), numbers(f, "spread", false, true)});
    f.finish();
  }
  for (Fields& f : tables(fields, "limits")) {
    out.limits.push_back({f.text("label"), f.number("value")});
    f.finish();
  }
  for (Fields& f : tables(fields, "markers")) {
    out.markers.push_back({f.text("label"), f.number("x")});
    f.finish();
  }
  for (Fields& f : tables(fields, "spans")) {
    out.spans.push_back({f.text("label"), f.number("from"), f.number("to")});
    f.finish();
  }
  return out;
}

// What is wrong with places of vertices is said with the mesh.
TriangleMesh surface(Fields& fields) {
  TriangleMesh mesh;
  mesh.vertices = points(fields, "vertices", false);
  for (const auto& corners : fields.rows("triangles", 3))
    mesh.triangles.push_back({place_of(corners[0]), place_of(corners[1]), place_of(corners[2])});
  try {
    check_mesh(mesh, "the surface");
  } catch (const InputError& error) {
    fields.add_error("triangles", error.what());
    return {};
  }
  return mesh;
}

Drawing drawing(Fields& fields) {
  Drawing out;
  for (Fields& f : tables(fields, "lines")) {
    out.lines.push_back({f.text("name"), points(f, "points", true),
                         numbers(f, "along", false, false), numbers(f, "values", false, true)});
    f.finish();
  }
  for (Fields& f : tables(fields, "points")) {
    out.points.push_back({f.text("label"), f.vector3("position")});
    f.finish();
  }
  for (Fields& f : tables(fields, "spheres")) {
    out.spheres.push_back({f.text("name"), f.vector3("center"), f.number("radius")});
    f.finish();
  }
  for (Fields& f : tables(fields, "boxes")) {
    out.boxes.push_back({f.text("name"), f.vector3("lower"), f.vector3("upper")});
    f.finish();
  }
  for (Fields& f : tables(fields, "zones")) {
    Zone zone;
    zone.name = f.text("name");
    for (const auto& corner : f.rows("corners", 2)) zone.corners.emplace_back(corner[0], corner[1]);
    zone.floor = f.optional_number("floor").value_or(zone.floor);
    zone.ceiling = f.optional_number("ceiling").value_or(zone.ceiling);
    f.finish();
    out.zones.push_back(std::move(zone));
  }
  for (Fields& f : tables(fields, "solids")) {
    out.solids.push_back({f.text("name"), surface(f)});
    f.finish();
  }
  if (given(fields, "along")) out.along = axis(fields.table("along"), false);
  if (given(fields, "value")) out.value = axis(fields.table("value"), false);
  return out;
}

PathView path_block(Fields& fields) {
  PathView out;
  out.title = fields.text("title");
  out.projection = static_cast<Projection>(fields.choice("projection", projection_names()));
  out.drawing = drawing(fields);
  return out;
}

Scene3D scene_block(Fields& fields) {
  Scene3D out;
  out.title = fields.text("title");
  out.drawing = drawing(fields);
  return out;
}

// Of an image or a frame of a strip.
std::string png_bytes(Fields& fields) {
  std::optional<std::string> bytes = bytes_of_base64(fields.text("png_base64"));
  if (!bytes) {
    fields.add_error("png_base64", "expected the bytes of a PNG file in padded base64");
    return {};
  }
  return std::move(*bytes);
}

Image image_block(Fields& fields, const ReadImage& read) {
  Image out;
  out.caption = fields.text("caption");
  if (read && fields.has("file")) {
    out.png = read(fields.text("file"));
    return out;
  }
  out.png = png_bytes(fields);
  return out;
}

FilmStrip strip_block(Fields& fields) {
  FilmStrip out;
  out.title = fields.text("title");
  for (Fields& f : tables(fields, "frames", true)) {
    FilmFrame frame;
    frame.png = png_bytes(f);
    frame.width = f.integer("width", 1, kMostPixels);
    frame.height = f.integer("height", 1, kMostPixels);
    frame.caption = f.text("caption");
    for (Fields& b : tables(f, "boxes")) {
      frame.boxes.push_back({b.text("label"), b.number("left"), b.number("top"), b.number("right"),
                             b.number("bottom")});
      b.finish();
    }
    f.finish();
    out.frames.push_back(std::move(frame));
  }
  return out;
}

Block block(Fields& fields, const ReadImage& read_image) {
  static const std::vector<std::string> kTypes = {"text", "facts", "table", "chart",
                                                  "path", "scene", "image", "strip"};
  // With an unknown type every other key would be unknown as well; one error says enough.
  const Value* type = fields.find("type");
  const int index = fields.choice("type", kTypes);
  if (type == nullptr || !type->is_text() ||
      type->as_text() != kTypes[static_cast<std::size_t>(index)]) {
    return TextBlock{};
  }
  const auto read = [&]() -> Block {
    switch (index) {
      case 0:
        return text_block(fields);
      case 1:
        return facts_block(fields);
      case 2:
        return table_block(fields);
      case 3:
        return chart_block(fields);
      case 4:
        return path_block(fields);
      case 5:
        return scene_block(fields);
      case 6:
        return image_block(fields, read_image);
      default:
        return strip_block(fields);
    }
  };
  Block out = read();
  fields.finish();
  return out;
}

std::vector<Section> sections(Fields& fields, const char* name, const ReadImage& read_image) {
  std::vector<Section> out;
  for (Fields& f : tables(fields, name, true)) {
    Section section{f.text("title"), {}};
    for (Fields& b : tables(f, "blocks", true)) section.blocks.push_back(block(b, read_image));
    f.finish();
    out.push_back(std::move(section));
  }
  return out;
}

void require_drawable(const Report& report, const Origin& origin) {
  try {
    render_html(report);
  } catch (const Error& error) {
    throw InputError(origin, error.what());
  }
}

}  // namespace

Report report_from_value(const Value& value) {
  Diagnostics errors;
  Report report;
  Fields fields(value, "", errors);
  report.title = fields.text("title");
  report.subtitle = fields.optional_text("subtitle");
  report.status = fields.optional_text("status");
  report.status_mark = mark(fields);
  report.sections = sections(fields, "sections", {});
  fields.finish();
  errors.throw_if_any();
  require_drawable(report, value.origin());
  return report;
}

std::vector<Section> sections_from_value(const Value& value, const std::string& key_path,
                                         const ReadImage& read_image) {
  Diagnostics errors;
  Report report;
  Value holder;
  holder.set(key_path, value);
  Fields fields(holder, "", errors);
  report.sections = sections(fields, key_path.c_str(), read_image);
  errors.throw_if_any();
  require_drawable(report, value.origin());
  return report.sections;
}

}  // namespace lapwing
