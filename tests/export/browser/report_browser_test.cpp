// SPDX-License-Identifier: Apache-2.0
// Opens reports in headless Chromium and asks the page what it drew.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <regex>

#include "framework/core/files.h"
#include "framework/export/flight_report.h"
#include "tests/export/synthetic_flight.h"
#include "tests/tool.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

std::string browser() {
  return tool_on_path({"chromium", "chromium-browser", "google-chrome"});
}

// A new empty folder, gone with this object.
struct Folder {
  fs::path path;
  Folder() {
    std::string name = (fs::temp_directory_path() / "lapwing_report_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path = name;
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

// The document after its scripts ran, as markup; `probe` runs after the page's own script.
std::string opened(std::string html, const std::string& probe) {
  const Folder folder;
  html.insert(html.rfind("</body>"), "<script>\n" + probe + "\n</script>\n");
  write_file_atomically(folder.path / "report.html", html);
  const std::string command =
      "timeout 30 '" + browser() +
      "' --headless --no-sandbox --disable-gpu --disable-quic --no-first-run"
      " --disable-background-networking --disable-component-update --disable-sync"
      " --window-size=1000,900 --virtual-time-budget=2000 --user-data-dir='" +
      (folder.path / "profile").string() + "' --dump-dom 'file://" +
      (folder.path / "report.html").string() + "' >'" + (folder.path / "dom").string() + "' 2>'" +
      (folder.path / "log").string() + "'";
  const int status = std::system(command.c_str());
  if (status != 0) {
    ADD_FAILURE() << "chromium ended with status " << WEXITSTATUS(status) << ":\n"
                  << read_file(folder.path / "log");
  }
  return read_file(folder.path / "dom");
}

// The text that the probe left in an attribute of <html>, or "".
std::string attribute(const std::string& dom, const std::string& name) {
  std::smatch found;
  const std::string head = dom.substr(0, dom.find("<head"));
  return std::regex_search(head, found, std::regex("data-" + name + "=\"([^\"]*)\""))
             ? found[1]
             : std::string();
}

// Per figure: kind, drawn points, and whether it has a size; the drawing of a scene has ink.
constexpr const char* kListFigures = R"(
const list = [];
for (const figure of document.querySelectorAll("figure[data-block]")) {
  const drawing = figure.querySelector("svg, canvas");
  const box = drawing.getBoundingClientRect();
  let ink = drawing.querySelectorAll(".series").length;
  if (drawing.tagName === "CANVAS") {
    const { data } = drawing.getContext("2d").getImageData(0, 0, drawing.width, drawing.height);
    ink = 0;
    for (let i = 3; i < data.length; i += 4) if (data[i] > 0) ++ink;
  }
  list.push([figure.querySelector("figcaption").textContent, drawing.dataset.samples,
    box.width > 200 && box.height > 100 ? "sized" : "empty", ink > 0 ? "ink" : "blank"].join(":"));
}
document.documentElement.dataset.figures = list.join(";");
document.documentElement.dataset.headings =
  [...document.querySelectorAll("h2")].map((h) => h.textContent).join(";");
document.documentElement.dataset.overflow =
  document.documentElement.scrollWidth > window.innerWidth;
document.documentElement.dataset.requests = performance.getEntriesByType("resource").length;
)";

void expect_complete(const std::string& dom, int samples) {
  EXPECT_EQ(attribute(dom, "error"), "");
  EXPECT_EQ(attribute(dom, "ready"), "true");
  EXPECT_EQ(attribute(dom, "requests"), "0");
  EXPECT_EQ(attribute(dom, "overflow"), "false") << "the page is wider than the window";
  EXPECT_EQ(
      attribute(dom, "headings"),
      "Summary;Path;Camera;Motion;Inputs;Direction;Keyframes;Solver;Certificate;Configuration");
  const std::string one = ":" + std::to_string(samples) + ":sized:ink";
  const std::string two = ":" + std::to_string(2 * samples) + ":sized:ink";
  const std::string three = ":" + std::to_string(3 * samples) + ":sized:ink";
  EXPECT_EQ(attribute(dom, "figures"),
            "Path from above" + one + ";Path from the south" + one + ";Path in space" + one +
                ";Gimbal angles" + two + ";Gimbal rates" + two + ";Position" + three +
                ";Speed across" + one + ";Climb and descent" + one + ";Acceleration across" + one +
                ";Acceleration up" + one + ";Thrust" + one + ";Yaw torque" + one + ";Yaw" + one +
                ";Yaw rate" + one + ";Weighted cost per term:36:sized:ink" +
                ";Violation and step length:18:sized:ink");
}

class ReportInBrowser : public testing::Test {
 protected:
  void SetUp() override {
    if (browser().empty()) GTEST_SKIP() << "there is no chromium (package chromium)";
  }
};

// Drawing of ten times the samples takes at most ten times as long, on a machine of any speed. What
// other programs delay is measured again, twice at most.
TEST_F(ReportInBrowser, LongFlightsStaySmallAndQuick) {
  const std::string probe = std::string(kListFigures) +
                            "document.documentElement.dataset.drawing = performance.measure('draw',"
                            " 'draw-begin', 'draw-end').duration;";
  const auto milliseconds = [&](int samples) {
    const std::string html = render_html(flight_report(synthetic_flight(300, samples, 10)));
    EXPECT_LT(html.size(), 3u << 20);
    const std::string dom = opened(html, probe);
    expect_complete(dom, samples);
    return std::atof(attribute(dom, "drawing").c_str());
  };
  const double few = milliseconds(301);
  double many = milliseconds(3001);
  EXPECT_GT(few, 0);
  for (int again = 0; again < 2 && many >= 10 * few; ++again) many = milliseconds(3001);
  EXPECT_LT(many, 10 * few) << few << " ms for 301 samples";
}

TEST_F(ReportInBrowser, ShowsWhatTheCameraFilms) {
  Plan plan = synthetic_flight(20, 201, 4);
  add_film(plan);
  const std::string html = render_html(flight_report(plan));
  EXPECT_LT(html.size(), 1u << 20);
  const std::string dom = opened(html, std::string(kListFigures) + R"(
const root = document.documentElement.dataset;
const frames = [...document.querySelectorAll(".strip .picture")];
root.frames = frames.length;
root.sizes = frames.every((f) => f.clientWidth > 150 && f.clientHeight > 80);
const boxes = frames.map((f) => f.querySelector("rect"));
root.boxes = boxes.filter((b) => b && b.getBoundingClientRect().width > 3).length;
root.zones = document.querySelectorAll(".zone").length;
const charts = [...document.querySelectorAll("figure.chart")];
root.spans = charts.filter((f) => f.querySelector(".span")).length;
root.charts = charts.length;
// The load event comes after every image, before the document is printed.
window.addEventListener("load", () => {
  // The subject is orange or blue inside its box, and the frame is not.
  const canvas = document.createElement("canvas");
  const pen = canvas.getContext("2d", { willReadFrequently: true });
  let seen = 0;
  frames.forEach((frame, i) => {
    const image = frame.querySelector("img");
    canvas.width = image.naturalWidth;
    canvas.height = image.naturalHeight;
    pen.drawImage(image, 0, 0);
    const share = (name) => Number(boxes[i].getAttribute(name));
    const x = (share("x") + share("width") / 2) * canvas.width;
    const y = (share("y") + share("height") / 2) * canvas.height;
    const [r, , b] = pen.getImageData(x, y, 1, 1).data;
    if (Math.abs(r - b) > 25) ++seen;
  });
  root.seen = seen;
});
)");
  EXPECT_EQ(attribute(dom, "error"), "");
  EXPECT_EQ(attribute(dom, "ready"), "true");
  EXPECT_EQ(attribute(dom, "requests"), "0");
  EXPECT_EQ(attribute(dom, "overflow"), "false");
  const int frames = std::stoi(attribute(dom, "frames"));
  EXPECT_GE(frames, 9);
  EXPECT_EQ(attribute(dom, "sizes"), "true");
  EXPECT_EQ(attribute(dom, "boxes"), std::to_string(frames));
  EXPECT_EQ(attribute(dom, "seen"), std::to_string(frames)) << "subjects inside their boxes";
  EXPECT_EQ(attribute(dom, "zones"), "4") << "two zones in two path views";
  EXPECT_EQ(attribute(dom, "spans"), std::to_string(std::stoi(attribute(dom, "charts")) - 2))
      << "the cut is shaded in all charts but the solver's";
  for (const char* title : {"Camera error", "Skewness", "Subject in the image, from its lower",
                            "Subject in the image, from its left"}) {
    EXPECT_NE(attribute(dom, "figures").find(title), std::string::npos) << title;
  }
  EXPECT_EQ(attribute(dom, "figures").find("blank"), std::string::npos);
}

TEST_F(ReportInBrowser, DrawsWhatItPromisesAndAnswersPointerAndKeys) {
  const std::string html = render_html(flight_report(synthetic_flight(20, 201, 4)));
  const std::string dom = opened(html, std::string(kListFigures) + R"(
// A browser without a window draws frames when it likes: before the first hover, take timers.
window.requestAnimationFrame = (callback) => setTimeout(callback, 16);
const root = document.documentElement.dataset;
const figures = [...document.querySelectorAll("figure[data-block]")];
const named = (title) => figures.find((f) => f.querySelector("figcaption").textContent === title);
const at = (target, type, x, y, more) => {
  const box = target.getBoundingClientRect();
  target.dispatchEvent(new PointerEvent(type, { clientX: box.left + x * box.width,
    clientY: box.top + y * box.height, bubbles: true, ...more }));
};
const speed = named("Speed across").querySelector("svg");
at(speed, "pointermove", 0.5, 0.5);
root.tip = named("Speed across").querySelector(".tip").textContent;
root.linked = figures.filter((f) => f.querySelector("g:not([visibility=hidden]) > .cursor")).length;
root.dot = named("Path from above").querySelector(".dot").getAttribute("visibility");
speed.dispatchEvent(new KeyboardEvent("keydown", { key: "Home" }));
root.home = named("Speed across").querySelector(".tip b").textContent;
speed.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight" }));
root.next = named("Speed across").querySelector(".tip b").textContent;
at(speed, "pointerleave", 0.5, 0.5);
root.hidden = named("Speed across").querySelector(".tip").hidden;
const canvas = document.querySelector("canvas");
const views = [canvas.dataset.view];
const then = (action) => new Promise((done) => {
  action();
  setTimeout(() => {
    views.push(canvas.dataset.view);
    done();
  }, 50);
});
const drag = (shiftKey) => {
  at(canvas, "pointerdown", 0.5, 0.5, { shiftKey });
  at(canvas, "pointermove", 0.6, 0.55, { shiftKey });
  at(canvas, "pointerup", 0.6, 0.55);
};
then(() => drag(false)).then(() => then(() => drag(true)))
  .then(() => then(() => canvas.dispatchEvent(new WheelEvent("wheel", { deltaY: -100 }))))
  .then(() => then(() => canvas.dispatchEvent(new KeyboardEvent("keydown", { key: "Home" }))))
  .then(() => { root.views = views.join(";"); });
)");
  EXPECT_EQ(attribute(dom, "error"), "");
  EXPECT_EQ(attribute(dom, "ready"), "true");
  EXPECT_TRUE(
      std::regex_search(attribute(dom, "tip"), std::regex("^time [0-9.]+ sacross [0-9.]+ m/s$")))
      << attribute(dom, "tip");
  EXPECT_EQ(attribute(dom, "linked"), "11") << "charts over time that show the common cursor";
  EXPECT_EQ(attribute(dom, "dot"), "visible");
  EXPECT_EQ(attribute(dom, "home"), "time 0 s");
  EXPECT_EQ(attribute(dom, "next"), "time 0.1 s");
  EXPECT_EQ(attribute(dom, "hidden"), "true");
  std::vector<std::vector<double>> views;
  std::stringstream lines(attribute(dom, "views"));
  for (std::string line; std::getline(lines, line, ';');) {
    std::stringstream words(line);
    views.emplace_back(std::istream_iterator<double>(words), std::istream_iterator<double>());
    ASSERT_EQ(views.back().size(), 5u);
  }
  ASSERT_EQ(views.size(), 5u);
  EXPECT_NE(views[1][0], views[0][0]) << "a drag turns";
  EXPECT_NE(views[1][1], views[0][1]) << "a drag tilts";
  EXPECT_GT(views[2][3], views[1][3]) << "a drag with shift moves";
  EXPECT_EQ(views[2][0], views[1][0]) << "a drag with shift does not turn";
  EXPECT_GT(views[3][2], views[2][2]) << "the wheel zooms";
  EXPECT_EQ(views[4], views[0]) << "Home resets";
}

// Bounds of a path below 1 m once asked for text without digits, and the page drew no chart.
TEST_F(ReportInBrowser, PathsNearTheOriginAreDrawn) {
  Plan plan = synthetic_flight(20, 101, 5);
  plan.environment = {};
  plan.task.keyframes.clear();
  for (Sample& s : plan.trajectory.samples) s.position *= 0.01;
  const std::string dom = opened(render_html(flight_report(plan)), kListFigures);
  EXPECT_EQ(attribute(dom, "error"), "");
  EXPECT_NE(attribute(dom, "figures").find("Path from above:101:sized:ink"), std::string::npos)
      << attribute(dom, "figures");
}

// A line to the east and north runs to the right for those who look from the south or the east, to
// the left for those who look from the north or the west; a zone and a box lie on the same side.
TEST_F(ReportInBrowser, EverySideShowsRightWhatIsRightOfTheSpectator) {
  Drawing drawing;
  drawing.lines = {{"line", {{1, 2, 0}, {9, 8, 3}}, {}, {}}};
  drawing.boxes = {{"box", {8, 7, 0}, {9, 8, 1}}};
  drawing.zones = {{"zone", {{8, 7}, {9, 7}, {9, 8}}, 0, 2}};
  Report report;
  for (const Projection side : {Projection::from_south, Projection::from_east,
                                Projection::from_north, Projection::from_west}) {
    const std::string name = projection_names().at(static_cast<std::size_t>(side));
    report.sections.push_back({name, {PathView{name, side, drawing}}});
  }
  const std::string dom = opened(render_html(report), R"(
document.documentElement.dataset.sides =
  [...document.querySelectorAll("figure[data-block] svg")].map((svg) => {
    const line = svg.querySelector(".series"), [box, zone] =
      [".body", ".zone"].map((name) => svg.querySelector(name).getBBox());
    const from = line.getPointAtLength(0).x, to = line.getPointAtLength(line.getTotalLength()).x;
    const middle = (b) => b.x + b.width / 2, near = (x) => Math.abs(x - to) < Math.abs(x - from);
    return [from < to ? "right" : "left", near(middle(box)), near(middle(zone)), box.width > 1,
      svg.getAttribute("aria-label").replace(/^[^:]*: /, "")].join(" ");
  }).join(";");
)");
  EXPECT_EQ(attribute(dom, "error"), "");
  const auto heights = [](const std::string& text) { return text + " m, up from 0 to 3 m"; };
  EXPECT_EQ(attribute(dom, "sides"),
            heights("right true true true east from 1 to 9") + ";" +
                heights("right true true true north from 2 to 8") + ";" +
                heights("left true true true west from \u22129 to \u22121") + ";" +
                heights("left true true true south from \u22128 to \u22122"));
}

TEST_F(ReportInBrowser, HostileTextAndGapsBreakNothing) {
  const std::string hostile = "</script><script>window.hit = 1</script><img src=x onerror='hit=1'>";
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Report report;
  report.title = hostile;
  Chart chart;
  chart.title = chart.x.label = chart.y.unit = hostile;
  chart.series = {{hostile, {0, 1, 2, 3}, {nan, 1, nan, 2}}, {"none", {}, {}}, {"n", {0}, {nan}}};
  chart.markers = {{hostile, 1}};
  chart.spans = {{hostile, 0, 2}};
  Chart empty;
  empty.title = "empty";
  Chart logarithmic = chart;
  logarithmic.y.logarithmic = true;
  Scene3D scene;
  scene.drawing.lines = {{hostile, {{0, 0, 0}, {nan, 1, 1}, {1, 1, 1}}, {0, 1, 2}, {nan, 1, nan}}};
  scene.drawing.points = {{hostile, {1, 1, 1}}};
  PathView view{"view", Projection::from_east, scene.drawing};
  Scene3D nothing;
  report.sections = {{hostile, {chart, empty, logarithmic, view, scene, nothing}}};
  const std::string dom = opened(render_html(report), std::string(kListFigures) +
                                                          R"(
document.documentElement.dataset.hit = String(window.hit);
document.documentElement.dataset.markup =
  (document.querySelector("main").outerHTML.match(/.{20}(NaN|Infinity|undefined).{20}/) || [""])[0];
// Last, an error, to show that errors are seen.
document.documentElement.dataset.before = document.documentElement.dataset.error || "none";
undefinedFunction();
)");
  EXPECT_EQ(attribute(dom, "ready"), "true");
  EXPECT_EQ(attribute(dom, "before"), "none");
  EXPECT_NE(attribute(dom, "error").find("undefinedFunction"), std::string::npos);
  EXPECT_EQ(attribute(dom, "hit"), "undefined");
  EXPECT_EQ(attribute(dom, "markup"), "")
      << "an attribute or a text of a drawing that holds NaN or Infinity";
}

}  // namespace
}  // namespace lapwing
