// SPDX-License-Identifier: Apache-2.0
// The page model of a run's report, and its rendering as one HTML file.
//
// Neutral: it knows series, drawings, tables, images and text, and nothing of any mission kind;
// kinds fill it. Everything is copied into the model; nothing refers to files or to the network.
// Texts are plain, UTF-8, and may hold anything: they are escaped when rendered.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "framework/geometry/triangle_mesh.h"

namespace lapwing {

// Draws the eye to how a row, a fact or the whole report came out.
enum class Mark { none, pass, fail, skipped };

struct TextBlock {
  std::string text;           // paragraphs, a blank line between them
  bool preformatted = false;  // keep line breaks and columns: configuration, code
  std::string folded_title;   // not empty: shown as a closed fold of that title
};

struct Fact {
  std::string label;
  std::string value;
  std::string unit;
  Mark mark = Mark::none;
};

struct Facts {
  std::vector<Fact> facts;
};

struct TableColumn {
  std::string name;
  std::string unit;
};

// A number that is not finite shows as a dash.
using TableCell = std::variant<std::string, double>;

struct TableRow {
  std::vector<TableCell> cells;  // one per column
  Mark mark = Mark::none;        // any row marked: the table gains a column that says so in words
};

struct Table {
  std::string title;
  std::vector<TableColumn> columns;
  std::vector<TableRow> rows;
};

// Charts with equal x label and unit share one cursor.
struct Axis {
  std::string label;
  std::string unit;
  bool logarithmic = false;  // y only; values that are not positive are gaps
  bool whole = false;        // ticks at whole numbers only
};

struct Series {
  std::string name;
  std::vector<double> x;  // finite, not decreasing
  std::vector<double> y;  // as many; not finite: a gap
  bool stepped = false;   // y holds until the next x
  // Half the height of a band around y, such as a deviation; as many, at least 0, or none at all.
  std::vector<double> spread = {};
};

struct LimitLine {
  std::string label;
  double value = 0;
};

struct Marker {
  std::string label;
  double x = 0;
};

struct Span {
  std::string label;
  double from = 0, to = 0;
};

struct Chart {
  std::string title;
  Axis x, y;
  std::vector<Series> series;
  std::vector<LimitLine> limits;
  std::vector<Marker> markers;
  std::vector<Span> spans;
};

struct Polyline {
  std::string name;
  std::vector<Eigen::Vector3d> points;  // m, world; not finite: a gap
  std::vector<double> along;            // per point, on the axis Drawing::along; or empty
  std::vector<double> values;           // per point, for colour, as Drawing::value; or empty
};

struct LabelledPoint {
  std::string label;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, world, finite
};

// Bodies that are drawn; m, world.
struct Sphere {
  std::string name;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius = 0;
};

// Parallel to the axes.
struct Box {
  std::string name;
  Eigen::Vector3d lower = Eigen::Vector3d::Zero();
  Eigen::Vector3d upper = Eigen::Vector3d::Zero();
};

// What lies above a polygon on the ground; without an end it goes on as far as the drawing.
struct Zone {
  std::string name;
  std::vector<Eigen::Vector2d> corners;
  double floor = -std::numeric_limits<double>::infinity();
  double ceiling = std::numeric_limits<double>::infinity();
};

// Any other, by its surface.
struct Solid {
  std::string name;
  TriangleMesh surface;
};

// Lines and bodies in the world frame (x east, y north, z up).
struct Drawing {
  std::vector<Polyline> lines;
  std::vector<LabelledPoint> points;
  std::vector<Sphere> spheres;
  std::vector<Box> boxes;
  std::vector<Zone> zones;
  std::vector<Solid> solids;
  Axis along;  // what Polyline::along counts; a chart over the same axis shares its cursor
  Axis value;  // what Polyline::values hold
};

// Looking down (east to the right), north (east to the right) or west (north to the right).
// What lies right of the picture: east from above and from the south, north from the east, west
// from the north, south from the west.
enum class Projection { above, from_south, from_east, from_north, from_west };
// "above", "from_south", ...: in the order of the enumeration.
const std::vector<std::string>& projection_names();

struct PathView {
  std::string title;
  Projection projection = Projection::above;
  Drawing drawing;
};

struct Scene3D {
  std::string title;
  Drawing drawing;
};

struct Image {
  std::string png;      // the bytes of a PNG file
  std::string caption;  // also read out in place of the image
  bool viewed = false;  // where scripts run, the report's viewer stands in its place
};

// Where a thing is in a frame, as shares of its width and height from the upper left corner; it may
// reach beyond the frame.
struct FrameBox {
  std::string label;
  double left = 0, top = 0, right = 0, bottom = 0;
};

struct FilmFrame {
  std::string png;  // the bytes of a PNG file
  int width = 0, height = 0;
  std::string caption;  // also read out in place of the frame
  std::vector<FrameBox> boxes;
};

// Pictures in a row, as many side by side as fit.
struct FilmStrip {
  std::string title;
  std::vector<FilmFrame> frames;
  bool viewed = false;  // as of an image
};

using Block = std::variant<TextBlock, Facts, Table, Chart, PathView, Scene3D, Image, FilmStrip>;

struct Section {
  std::string title;
  std::vector<Block> blocks;
};

// A page that shows what was planned in 3D, in a frame of its own: its files, and what it draws.
struct Viewer {
  std::string page, style, script;                         // app.css and app.js are put inside
  std::string told;                                        // JSON, which the script reads
  std::vector<std::pair<std::string, std::string>> blobs;  // that it names
};

struct Report {
  std::string title;
  std::string subtitle;
  std::string status;  // a badge, "certified"; none when empty
  Mark status_mark = Mark::none;
  std::vector<Section> sections;
  std::optional<Viewer> viewer = {};  // in place of the first block that is `viewed`
};

// One self-contained page: style, script and data inside, no network, the same bytes for the same
// report. Throws Error naming section and block when the model contradicts itself: lengths that
// differ, an x that is not finite or goes back, a row that does not fit its columns, bytes that
// are no PNG.
std::string render_html(const Report& report);

// Four significant digits, a true minus sign, a dash for what is not finite.
std::string number_text(double value, int digits = 4);

}  // namespace lapwing
