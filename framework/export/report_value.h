// SPDX-License-Identifier: Apache-2.0
// Reports as data, so that mission scripts and files state their own sections.
//
//   report   title, subtitle, status, result, sections
//   section  title, blocks
//   block    type and what it needs:
//     text   text, preformatted, folded
//     facts  facts: label, value (text or number), unit, result
//     table  title, columns: name, unit; rows: cells (text or number), result
//     chart  title, x, y (axes), series: name, x, y, stepped, spread; limits: label, value;
//            markers: label, x; spans: label, from, to
//     path   title, projection (above, from_south, from_east, from_north, from_west), and a drawing
//     scene  title, and a drawing
//     image  caption, and png_base64 or, where files may be read, file
//     strip  title, frames: caption, png_base64, width, height (pixels); boxes: label, left, top,
//            right, bottom (shares of the frame)
//   axis     label, unit, whole, logarithmic (of y only)
//   drawing  lines: name, points (triples), along, values; points: label, position;
//            spheres: name, center, radius; boxes: name, lower, upper; zones: name, corners
//            (pairs), floor, ceiling; solids: name, vertices (triples), triangles (triples of
//            places of vertices, from 0); along, value (axes)
//   result   none, pass, fail, skipped
//
// Required are titles, names, labels, types, text, value, and the numbers of what is drawn; the
// rest may lack. Units, frames and rules are those of report.h. In y, in values and between the
// points of a line, null is a gap; a cell that is null shows as a dash.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "framework/core/value.h"
#include "framework/export/report.h"

namespace lapwing {

// Throws InputError listing every key that is unknown, missing or of another type, or else the
// first contradiction that render_html would refuse: what was read can be rendered.
Report report_from_value(const Value& value);

// The same, as data: reading it again gives a report that renders to the same bytes, but for
// viewers, which are left out.
Value to_value(const Report& report);

// The bytes of a file that an image names; throws InputError.
using ReadImage = std::function<std::string(const std::string& name)>;

// A list of sections; `key_path` names it in messages. Null: images name no files.
std::vector<Section> sections_from_value(const Value& value, const std::string& key_path,
                                         const ReadImage& read_image = {});

}  // namespace lapwing
