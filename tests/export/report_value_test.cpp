// SPDX-License-Identifier: Apache-2.0
#include "framework/export/report_value.h"

#include <gtest/gtest.h>

#include "framework/core/json.h"

namespace lapwing {
namespace {

constexpr const char* kFull = R"({
  "title": "a mission", "subtitle": "its page", "status": "fine", "result": "pass",
  "sections": [
    {"title": "all blocks", "blocks": [
      {"type": "text", "text": "one\n\ntwo", "preformatted": true, "folded": "more"},
      {"type": "facts", "facts": [{"label": "time", "value": 6.78, "unit": "s", "result": "fail"},
                                  {"label": "gates", "value": "7 of 7"}]},
      {"type": "table", "title": "gates",
       "columns": [{"name": "gate"}, {"name": "at", "unit": "s"}],
       "rows": [{"cells": ["1", 0.5], "result": "skipped"}, {"cells": ["2", 1]},
                {"cells": ["3", null]}]},
      {"type": "chart", "title": "speed", "x": {"label": "time", "unit": "s"},
       "y": {"label": "speed", "unit": "m/s", "logarithmic": true, "whole": true},
       "series": [{"name": "a", "x": [0, 1, 2], "y": [1, null, 3.5], "stepped": true,
                   "spread": [0.5, 0, 1]}],
       "limits": [{"label": "maximum", "value": 4}], "markers": [{"label": "g1", "x": 1}],
       "spans": [{"label": "cut", "from": 0.5, "to": 1}]},
      {"type": "path", "title": "side", "projection": "from_east",
       "lines": [{"name": "p", "points": [[0, 0, 1], [1, 0, 2], null], "along": [0, 1, 2],
                  "values": [3, null, 1]}],
       "points": [{"label": "g1", "position": [1, 2, 3]}],
       "spheres": [{"name": "s", "center": [0, 0, 0], "radius": 1}],
       "boxes": [{"name": "b", "lower": [0, 0, 0], "upper": [1, 1, 1]}],
       "zones": [{"name": "z", "corners": [[0, 0], [4, 0], [0, 4]], "ceiling": 20}],
       "solids": [{"name": "roof", "vertices": [[0, 0, 3], [1, 0, 3], [0, 1, 3]],
                   "triangles": [[0, 1, 2]]}],
       "along": {"label": "time", "unit": "s"}, "value": {"label": "speed", "unit": "m/s"}},
      {"type": "scene", "title": "space", "lines": {}},
      {"type": "image", "png_base64": "iVBORw0KGgph", "caption": "a picture"},
      {"type": "strip", "title": "frames", "frames": [
        {"png_base64": "iVBORw0KGgph", "width": 4, "height": 3, "caption": "0 s",
         "boxes": [{"label": "actor", "left": 0.25, "top": 0, "right": 0.5, "bottom": 1.5}]}]}
    ]}
  ]
})";

std::string error_of(const std::string& json) {
  try {
    report_from_value(from_json(json, "report.json"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string error_of_block(const std::string& block) {
  return error_of(R"({"title": "t", "sections": [{"title": "s", "blocks": [)" + block + "]}]}");
}

bool has_text(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(ReportValue, ReadsEveryBlock) {
  const Report report = report_from_value(from_json(kFull, "report.json"));
  EXPECT_EQ(report.title, "a mission");
  EXPECT_EQ(report.status_mark, Mark::pass);
  const auto& blocks = report.sections.at(0).blocks;
  ASSERT_EQ(blocks.size(), 8u);
  EXPECT_TRUE(std::get<TextBlock>(blocks[0]).preformatted);
  EXPECT_EQ(std::get<TextBlock>(blocks[0]).folded_title, "more");
  const auto& facts = std::get<Facts>(blocks[1]).facts;
  EXPECT_EQ(facts[0].value, "6.78");
  EXPECT_EQ(facts[0].mark, Mark::fail);
  EXPECT_EQ(facts[1].value, "7 of 7");
  const auto& table = std::get<Table>(blocks[2]);
  EXPECT_EQ(table.columns[1].unit, "s");
  EXPECT_EQ(std::get<double>(table.rows[1].cells[1]), 1);
  EXPECT_EQ(table.rows[0].mark, Mark::skipped);
  EXPECT_TRUE(std::isnan(std::get<double>(table.rows[2].cells[1])));
  const auto& chart = std::get<Chart>(blocks[3]);
  EXPECT_TRUE(chart.y.logarithmic && chart.y.whole && chart.series[0].stepped);
  EXPECT_TRUE(std::isnan(chart.series[0].y[1]));
  EXPECT_EQ(chart.series[0].y[2], 3.5);
  EXPECT_EQ(chart.series[0].spread, (std::vector<double>{0.5, 0, 1}));
  EXPECT_EQ(chart.limits[0].value, 4);
  EXPECT_EQ(chart.markers[0].x, 1);
  EXPECT_EQ(chart.spans[0].from, 0.5);
  const auto& path = std::get<PathView>(blocks[4]);
  EXPECT_EQ(path.projection, Projection::from_east);
  EXPECT_EQ(path.drawing.lines[0].points[1], Eigen::Vector3d(1, 0, 2));
  EXPECT_TRUE(path.drawing.lines[0].points[2].hasNaN());
  EXPECT_EQ(path.drawing.lines[0].along[1], 1);
  EXPECT_EQ(path.drawing.points[0].position, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(path.drawing.spheres[0].radius, 1);
  EXPECT_EQ(path.drawing.boxes[0].upper, Eigen::Vector3d(1, 1, 1));
  EXPECT_EQ(path.drawing.value.unit, "m/s");
  EXPECT_EQ(path.drawing.zones[0].ceiling, 20);
  EXPECT_EQ(path.drawing.zones[0].floor, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(path.drawing.solids[0].surface.area(0), 0.5);
  EXPECT_TRUE(std::get<Scene3D>(blocks[5]).drawing.lines.empty());
  EXPECT_EQ(std::get<Image>(blocks[6]).png, "\x89PNG\r\n\x1a\na");
  const FilmFrame& frame = std::get<FilmStrip>(blocks[7]).frames.at(0);
  EXPECT_EQ(frame.png, "\x89PNG\r\n\x1a\na");
  EXPECT_EQ(frame.width, 4);
  EXPECT_EQ(frame.boxes.at(0).bottom, 1.5);
}

TEST(ReportValue, WrittenAndReadAgainItRendersToTheSameBytes) {
  const Report report = report_from_value(from_json(kFull, "report.json"));
  const std::string written = to_json(to_value(report));
  const Report again = report_from_value(from_json(written, "report.json"));
  EXPECT_EQ(render_html(again), render_html(report));
  EXPECT_EQ(to_json(to_value(again)), written);
}

TEST(ReportValue, ReadsSectionsAlone) {
  const Value report = from_json(kFull, "report.json");
  const auto sections = sections_from_value(report.at("sections"), "report");
  ASSERT_EQ(sections.size(), 1u);
  EXPECT_EQ(sections[0].blocks.size(), 8u);
  try {
    sections_from_value(from_json(R"([{"titel": "x", "blocks": []}])", "f"), "report");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_TRUE(has_text(error.what(), "report[1].title: missing")) << error.what();
    EXPECT_TRUE(has_text(error.what(), "report[1].titel: unknown; did you mean 'title'?"))
        << error.what();
  }
}

TEST(ReportValue, NamesWhatIsWrongAndWhere) {
  EXPECT_TRUE(has_text(error_of("[]"), "expected a map, got a list"));
  EXPECT_TRUE(has_text(error_of(R"({"sections": []})"), "title: missing"));
  EXPECT_TRUE(has_text(error_of(R"({"title": "t"})"), "sections: missing"));
  EXPECT_TRUE(has_text(error_of_block(R"({"type": "pie", "slices": 3})"),
                       "sections[1].blocks[1].type: expected one of: text, facts, table, chart, "
                       "path, scene, image"));
  EXPECT_FALSE(has_text(error_of_block(R"({"type": "pie", "slices": 3})"), "slices"));
  EXPECT_TRUE(has_text(error_of_block(R"({"text": "x"})"), "blocks[1].type: missing"));
  EXPECT_TRUE(has_text(error_of_block(R"({"type": "text", "text": "x", "foldet": "y"})"),
                       "blocks[1].foldet: unknown; did you mean 'folded'?"));
  EXPECT_TRUE(has_text(error_of_block(R"({"type": "text", "text": "x", "preformatted": 1})"),
                       "preformatted: expected true or false"));
  EXPECT_TRUE(has_text(error_of_block(R"({"type": "image", "caption": "c", "png_base64": "@@@@"})"),
                       "png_base64: expected the bytes of a PNG file in padded base64"));
  EXPECT_TRUE(has_text(error_of_block(R"({"type": "image", "caption": "c", "png_base64": "AAAA"})"),
                       "the image is not a PNG file"));
  const auto solid = [](const std::string& triangle) {
    return error_of_block(R"({"type": "scene", "title": "s", "solids": [{"name": "roof",
        "vertices": [[0, 0, 3], [1, 0, 3], [0, 1, 3]], "triangles": [)" +
                          triangle + "]}]}");
  };
  EXPECT_EQ(solid("[0, 1, 2]"), "");
  EXPECT_TRUE(has_text(solid("[0, 1, 3]"), "solids[1].triangles: the surface"));
  EXPECT_TRUE(has_text(solid("[0, 1, 0.5]"), "solids[1].triangles: the surface"));
  EXPECT_TRUE(has_text(solid(""), "solids[1].triangles: the surface"));
}

TEST(ReportValue, RefusesSeriesThatCannotBeDrawn) {
  const auto chart = [](const std::string& series, const std::string& x = R"({"label": "t"})") {
    return error_of_block(R"({"type": "chart", "title": "c", "x": )" + x +
                          R"(, "y": {"label": "v"}, "series": [)" + series + "]}");
  };
  EXPECT_EQ(chart(R"({"name": "a", "x": [0, 1], "y": [1, 2]})"), "");
  EXPECT_TRUE(has_text(chart(R"({"name": "a", "x": [0, 1], "y": [1]})"), "2 x and 1 y"));
  EXPECT_TRUE(has_text(chart(R"({"name": "a", "x": [0, 1], "y": [1, 2], "spread": [1]})"),
                       "1 of spread and 2 y"));
  EXPECT_TRUE(has_text(chart(R"({"name": "a", "x": [0, null], "y": [1, 2]})"),
                       "series[1].x[2]: expected a finite number"));
  EXPECT_TRUE(
      has_text(chart(R"({"name": "a", "x": [1, 0], "y": [1, 2]})"), "below the one before"));
  EXPECT_TRUE(has_text(chart(R"({"name": "a", "x": [0], "y": ["1"]})"),
                       "series[1].y[1]: expected a number, got a text"));
  EXPECT_TRUE(has_text(chart(R"({"name": "a", "x": 3, "y": []})"), "expected a list"));
  EXPECT_TRUE(has_text(chart(R"({"name": "a", "y": []})"), "series[1].x: missing"));
  EXPECT_TRUE(
      has_text(chart("", R"({"label": "t", "logarithmic": true})"), "x.logarithmic: unknown"));
  EXPECT_TRUE(has_text(error_of_block(R"({"type": "scene", "title": "s",
                                         "lines": [{"name": "l", "points": [[1, 2]]}]})"),
                       "lines[1].points[1]: expected a list of 3 numbers"));
  EXPECT_TRUE(has_text(error_of_block(R"({"type": "table", "columns": [{"name": "a"}],
                                         "rows": [{"cells": [true]}]})"),
                       "rows[1].cells[1]: expected a text or a number, got"));
  EXPECT_TRUE(has_text(error_of_block(R"({"type": "table", "columns": [{"name": "a"}],
                                         "rows": [{"cells": [1, 2]}]})"),
                       "a row has 2 cells for 1 columns"));
}

TEST(ReportValue, ReportsAllErrorsTogether) {
  const std::string errors = error_of_block(R"({"type": "facts", "facts": [
      {"label": 1, "value": "x"}, {"label": "b"}, {"label": "c", "value": [], "colour": "red"}]})");
  EXPECT_TRUE(has_text(errors, "facts[1].label: expected a text, got an integer")) << errors;
  EXPECT_TRUE(has_text(errors, "facts[2].value: missing"));
  EXPECT_TRUE(has_text(errors, "facts[3].value: expected a text, got a list"));
  EXPECT_TRUE(has_text(errors, "facts[3].colour: unknown"));
}

}  // namespace
}  // namespace lapwing
