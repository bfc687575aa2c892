// SPDX-License-Identifier: Apache-2.0
#include "framework/export/report.h"

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/json.h"
#include "framework/export/report_data.h"

namespace lapwing {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Report with(Block block) {
  Report report;
  report.title = "a report";
  report.sections = {{"a section", {std::move(block)}}};
  return report;
}

Chart chart() {
  Chart c;
  c.title = "a chart";
  c.x = {"time", "s"};
  c.y = {"speed", "m/s"};
  c.series = {{"across", {0, 1, 2}, {1, 2, 3}}};
  return c;
}

std::string error_of(const Report& report) {
  try {
    render_html(report);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::string data_text(const std::string& html) {
  const std::string open = "<script type=\"application/json\" id=\"report-data\">";
  const std::size_t begin = html.find(open) + open.size();
  return html.substr(begin, html.find("</script>", begin) - begin);
}

TEST(Report, EscapesTextEverywhere) {
  const std::string hostile = "</script><script>alert('x')</script> \"&\" <!-- \u00e9\u4e2d";
  Report report;
  report.title = report.subtitle = report.status = hostile;
  Chart c = chart();
  c.title = c.x.label = c.y.unit = c.series[0].name = hostile;
  c.limits = {{hostile, 1}};
  c.markers = {{hostile, 1}};
  Scene3D scene;
  scene.title = hostile;
  scene.drawing.points = {{hostile, Eigen::Vector3d::Zero()}};
  scene.drawing.spheres = {{hostile, Eigen::Vector3d::Zero(), 1}};
  Table table{hostile, {{hostile, hostile}}, {{{hostile}, Mark::pass}}};
  Facts facts{{{hostile, hostile, hostile}}};
  TextBlock text{hostile, true, hostile};
  report.sections = {{hostile, {c, scene, table, facts, text}}};
  const std::string html = render_html(report);
  EXPECT_FALSE(contains(html, "<script>alert"));
  EXPECT_FALSE(contains(html, "<!-- "));
  EXPECT_TRUE(contains(html, "&lt;script&gt;alert(&#39;x&#39;)&lt;/script&gt; &quot;&amp;&quot;"));
  // Exactly the page's own scripts: error catcher, data, drawing.
  std::size_t scripts = 0;
  for (std::size_t at = 0; (at = html.find("<script", at)) != std::string::npos; ++at) ++scripts;
  EXPECT_EQ(scripts, 3u);
  const Value data = from_json(data_text(html), "data");
  EXPECT_EQ(data.at("blocks").as_list()[0].at("title").as_text(), hostile);
}

TEST(Report, ControlCharactersAndBrokenUtf8StayReadable) {
  const std::string broken("a\x01\x00\xff\xc3z", 6);
  Chart c = chart();
  c.title = broken;
  const std::string html = render_html(with(c));
  EXPECT_EQ(html.find('\0'), std::string::npos);
  EXPECT_EQ(html.find('\x01'), std::string::npos);
  EXPECT_NO_THROW(from_json(data_text(html), "data"));
}

TEST(Report, NumbersThatAreNotFiniteAreGaps) {
  Chart c = chart();
  c.series[0].y = {1, kNan, -kInfinity};
  Scene3D scene;
  scene.drawing.lines = {{"path", {{0, 0, 0}, {kNan, 0, 0}}, {}, {}}};
  Report report = with(c);
  report.sections[0].blocks.push_back(scene);
  const Value data = from_json(report_data(report), "data");
  const Value& series = data.at("blocks").as_list()[0].at("series").as_list()[0];
  const auto& y = data.at("arrays").as_list()[series.at("y").as_integer()].as_list();
  EXPECT_EQ(y[0].as_number(), 1);
  EXPECT_TRUE(y[1].is_null());
  EXPECT_TRUE(y[2].is_null());
  EXPECT_FALSE(contains(report_data(report), "nan"));
  EXPECT_TRUE(contains(render_html(with(Table{"t", {{"a", ""}}, {{{kNan}}}})), ">\u2013</td>"));
}

TEST(Report, RefusesWhatCannotBeDrawnNamingIt) {
  Chart c = chart();
  c.series[0].y.pop_back();
  EXPECT_EQ(error_of(with(c)),
            "report section 'a section', block 'a chart': series 'across' has 3 x and 2 y");
  c = chart();
  c.series[0].x[1] = kNan;
  EXPECT_TRUE(contains(error_of(with(c)), "x of series 'across'[1] is not finite"));
  c = chart();
  c.series[0].x[2] = 0.5;
  EXPECT_TRUE(contains(error_of(with(c)), "x of series 'across'[2] is below the one before it"));
  c = chart();
  c.limits = {{"maximum", kInfinity}};
  EXPECT_TRUE(contains(error_of(with(c)), "a limit is not finite"));
  c = chart();
  c.spans = {{"cut", 2, 1}};
  EXPECT_TRUE(contains(error_of(with(c)), "span 'cut' ends before it begins"));
  Scene3D scene;
  scene.drawing.lines = {{"path", {{0, 0, 0}, {1, 0, 0}}, {0}, {}}};
  EXPECT_TRUE(contains(error_of(with(scene)), "line 'path' has 2 points and 1 positions"));
  scene.drawing.lines.clear();
  scene.drawing.points = {{"1", {kNan, 0, 0}}};
  EXPECT_TRUE(contains(error_of(with(scene)), "a point is not finite"));
  EXPECT_TRUE(contains(error_of(with(Table{"t", {{"a", ""}, {"b", ""}}, {{{1.0}}}})),
                       "a row has 1 cells for 2 columns"));
  EXPECT_TRUE(
      contains(error_of(with(Image{"GIF89a", "a picture"})), "the image is not a PNG file"));
}

TEST(Report, WritesImagesAsBase64) {
  for (const auto& [tail, encoded] : {std::pair<std::string, std::string>{"", "iVBORw0KGgo="},
                                      {"a", "iVBORw0KGgph"},
                                      {"ab", "iVBORw0KGgphYg=="}}) {
    const std::string html = render_html(with(Image{"\x89PNG\r\n\x1a\n" + tail, "a picture"}));
    EXPECT_TRUE(contains(html, "data:image/png;base64," + encoded + "\"")) << tail;
  }
}

TEST(Report, WritesARepeatedVectorOnce) {
  Chart c = chart();
  c.series.push_back({"up", c.series[0].x, {4, 5, 6}});
  Report report = with(c);
  report.sections[0].blocks.push_back(c);
  const Value data = from_json(report_data(report), "data");
  EXPECT_EQ(data.at("arrays").as_list().size(), 3u);
  EXPECT_EQ(data.at("blocks").as_list().size(), 2u);
}

TEST(Report, SaysTheResultOfMarkedRowsInWords) {
  Table table{"checks", {{"name", ""}, {"worst", "N"}}, {}};
  table.rows = {{{"force", 21.25}, Mark::pass},
                {{"speed", 11.0}, Mark::fail},
                {{"gimbal", ""}, Mark::skipped}};
  const std::string html = render_html(with(table));
  EXPECT_TRUE(contains(html,
                       "<tr class=\"pass\"><td class=\"mark\">pass</td><td>force</td>"
                       "<td class=\"number\">21.25</td>"));
  EXPECT_TRUE(contains(html, "<tr class=\"fail\"><td class=\"mark\">fail</td>"));
  EXPECT_TRUE(contains(html, "<tr class=\"skipped\"><td class=\"mark\">skipped</td>"));
  EXPECT_TRUE(contains(html, "worst <span class=\"unit\">[N]</span>"));
}

TEST(Report, IsTheSameEachTimeAndNeedsNoNetwork) {
  const std::string html = render_html(with(chart()));
  EXPECT_EQ(html, render_html(with(chart())));
  std::size_t links = 0;
  for (std::size_t at = 0; (at = html.find("//", at)) != std::string::npos; ++at) {
    if (html.compare(at - 5, 5, "http:") == 0 || html.compare(at - 6, 6, "https:") == 0) {
      EXPECT_EQ(html.compare(at, 20, "//www.w3.org/2000/sv"), 0);
      ++links;
    }
  }
  EXPECT_EQ(links, 1u);
}

TEST(Report, AnEmptyReportIsAPage) {
  const std::string html = render_html({});
  EXPECT_EQ(html.compare(0, 15, "<!doctype html>"), 0);
  EXPECT_EQ(html.substr(html.size() - 8), "</html>\n");
}

TEST(NumberText, FourDigitsAndATrueMinus) {
  EXPECT_EQ(number_text(0), "0");
  EXPECT_EQ(number_text(-0.0), "0");
  EXPECT_EQ(number_text(1), "1");
  EXPECT_EQ(number_text(-2.5), "\u22122.5");
  EXPECT_EQ(number_text(3.14159265), "3.142");
  EXPECT_EQ(number_text(12345.6), "12346");
  EXPECT_EQ(number_text(0.00012345), "0.0001234");
  EXPECT_EQ(number_text(9.99999), "10");
  EXPECT_EQ(number_text(1e-9), "1e\u22129");
  EXPECT_EQ(number_text(2.5e8), "2.5e8");
  EXPECT_EQ(number_text(1e100), "1e100");
  EXPECT_EQ(number_text(-1.5e-10), "\u22121.5e\u221210");
  EXPECT_EQ(number_text(kNan), "\u2013");
  EXPECT_EQ(number_text(1.0 / 3, 2), "0.33");
}

// The viewer stands in the place of the first picture that it may replace; nothing in its files
// ends the elements that hold them.
TEST(Report, ThePageOfAViewerIsInsideOnce) {
  Image image{std::string("\x89PNG\r\n\x1a\n"), "a picture", true};
  Report report = with(image);
  report.sections.front().blocks.push_back(image);
  EXPECT_FALSE(contains(render_html(report), "viewer-page"));
  report.viewer = Viewer{"<html></html>",
                         "a::after { content: '</style>' }",
                         "let a = '</script><!--';",
                         R"({"name": "</script>"})",
                         {{"abc", "1"}}};
  const std::string html = render_html(report);
  std::size_t figures = 0;
  for (std::size_t at = html.find("wide viewed\""); at != std::string::npos;
       at = html.find("wide viewed\"", at + 1))
    ++figures;
  EXPECT_EQ(figures, 1u);
  EXPECT_TRUE(contains(html, "id=\"viewer-script\">let a = '<\\/script><\\!--';</script>"));
  EXPECT_TRUE(contains(html, "id=\"viewer-told\">{\"name\": \"\\u003c/script>\"}</script>"));
  EXPECT_TRUE(contains(html, "id=\"viewer-abc\">MQ==</script>"));
  EXPECT_FALSE(contains(html, "'</style>'"));
}

}  // namespace
}  // namespace lapwing
