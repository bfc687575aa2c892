// SPDX-License-Identifier: Apache-2.0
// The program itself: `lapwing studio` with its working processes, and pages that are clients.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>
#include <thread>

#include "framework/core/files.h"
#include "framework/studio/option_path.h"
#include "framework/studio/patch.h"
#include "framework/trajectory/plan.h"
#include "tests/studio/page_client.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

const fs::path kSource = LAPWING_SOURCE_DIR;
const std::string kProgram = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing";

// A process of the program, with its standard output.
class Started {
 public:
  Started(const fs::path& folder, std::vector<std::string> words) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    process = ::fork();
    if (process == 0) {
      ::dup2(ends[1], STDOUT_FILENO);
      const int errors =
          ::open((folder / "errors.txt").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
      ::dup2(errors, STDERR_FILENO);
      std::vector<char*> pointers{const_cast<char*>(kProgram.c_str())};
      for (std::string& word : words) pointers.push_back(word.data());
      pointers.push_back(nullptr);
      if (::chdir(folder.c_str()) == 0) ::execv(kProgram.c_str(), pointers.data());
      ::_exit(98);
    }
    ::close(ends[1]);
    output_ = ends[0];
  }
  ~Started() {
    end(SIGKILL);
    ::close(output_);
  }
  Started(const Started&) = delete;
  // Up to the end of a line; "" at the end.
  std::string line() const {
    std::string text;
    for (char byte = 0; ::read(output_, &byte, 1) == 1 && byte != '\n';) text += byte;
    return text;
  }
  int end(int signal) {
    if (process <= 0) return status_;
    if (signal != 0) ::kill(process, signal);
    int status = 0;
    ::waitpid(process, &status, 0);
    process = -1;
    status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
    return status_;
  }
  std::vector<pid_t> workers() const {
    std::ifstream list("/proc/" + std::to_string(process) + "/task/" + std::to_string(process) +
                       "/children");
    std::vector<pid_t> found;
    for (pid_t child; list >> child;) found.push_back(child);
    return found;
  }

  pid_t process = -1;

 private:
  int output_ = -1, status_ = -1;
};

class StudioProgram : public testing::Test {
 protected:
  void SetUp() override {
    static int count = 0;
    ::unsetenv("LAPWING_DATA");
    ::unsetenv("XDG_RUNTIME_DIR");
    folder_ = fs::temp_directory_path() /
              ("lapwing_studio_" + std::to_string(::getpid()) + "_" + std::to_string(count++));
    fs::create_directories(folder_ / "page");
    write_file_atomically(folder_ / "page/index.html", "<!doctype html>page");
    write_file_atomically(folder_ / "page/studio.js", "//");
  }
  void TearDown() override {
    server_.reset();
    fs::remove_all(folder_);
  }
  void use(const std::string& example) {
    script_ = fs::path(example).filename();
    fs::copy_file(kSource / "examples" / example, folder_ / script_);
  }
  StudioAddress serve(std::vector<std::string> more = {}) {
    std::vector<std::string> words{"studio", script_.string(), "--no-open", "--assets", "page"};
    words.insert(words.end(), more.begin(), more.end());
    server_.reset();
    server_ = std::make_unique<Started>(folder_, words);
    const std::string line = server_->line();
    if (line.empty()) throw std::runtime_error(read_file(folder_ / "errors.txt"));
    return StudioAddress(line);
  }
  // Runs to the end; what it says on standard error is in `errors_`.
  int run(std::vector<std::string> words) {
    Started program(folder_, std::move(words));
    const int status = program.end(0);
    errors_ = read_file(folder_ / "errors.txt");
    return status;
  }
  std::string journal() const {
    return read_file(folder_ / (script_.stem().string() + ".studio.journal"));
  }

  fs::path folder_, script_;
  std::unique_ptr<Started> server_;
  std::string errors_;
};

TEST_F(StudioProgram, AnswersWithACertifiedPlanAndWhatIsAroundIt) {
  use("filming/castle_flyover.lua");
  const StudioAddress address = serve();
  EXPECT_EQ(address.token.size(), 32u);
  PageClient page(address, "a");
  const Value& welcome = page.welcome;
  EXPECT_EQ(welcome.at("mission").at("kind"), Value("film"));
  EXPECT_EQ(welcome.at("document").at("keyframes").as_list().size(), 3u);
  EXPECT_FALSE(welcome.at("schema").at("options").as_list().empty());
  EXPECT_TRUE(welcome.at("schema").at("plugins").at("shape").find("sphere"));
  EXPECT_FALSE(welcome.at("choices").at("vehicle").as_list().empty());
  EXPECT_FALSE(welcome.at("choices").at("style").as_list()[0].at("layer").as_map().empty());
  std::string blob;
  const Value answer = page.until([&](const Value& m) {
    if (m.at("type") == Value("world")) blob = m.at("obstacles").as_list()[0].at("blob").as_text();
    return m.at("type") == Value("answer") && m.at("grade") == Value("certified");
  });
  const Value& columns = answer.at("plan").at("columns");
  const std::size_t samples = columns.at("time").as_list().size();
  EXPECT_GT(samples, 100u);
  for (const auto& [name, column] : columns.as_map())
    EXPECT_EQ(column.as_list().size(), samples) << name;
  // The camera's axis, turned into the world, points at the castle in the middle of the flight.
  const auto at = [&](const char* name) {
    return columns.at(name).as_list()[samples / 2].as_number();
  };
  const Eigen::Quaterniond q(at("qw"), at("qx"), at("qy"), at("qz"));
  const Eigen::Vector3d sight = q * Eigen::Vector3d::UnitZ(), p(at("x"), at("y"), at("z"));
  EXPECT_GT(sight.dot((Eigen::Vector3d(0, 0, 2) - p).normalized()), 0.99);
  EXPECT_LT((q * Eigen::Vector3d::UnitY()).z(), 0);  // its y is down
  EXPECT_EQ(answer.at("certificate").at("passed"), Value(true));
  const std::string got = answer_to(
      address.port, "GET /blob/" + blob + " HTTP/1.1\r\nHost: " + address.host() + "\r\n\r\n");
  EXPECT_NE(got.find("immutable"), std::string::npos);
  const std::size_t body = got.find("\r\n\r\n") + 4;
  ASSERT_EQ(got.substr(body, 4), "WLB1");
  std::uint32_t counts[3];
  std::memcpy(counts, got.data() + body + 4, sizeof counts);
  EXPECT_EQ(got.size() - body, 16 + 12 * (counts[0] + counts[1]));
  EXPECT_EQ(answer_to(address.port, "GET /blob/" + std::string(64, '0') +
                                        " HTTP/1.1\r\nHost: " + address.host() + "\r\n\r\n")
                .substr(9, 3),
            "404");
  EXPECT_EQ(server_->end(SIGTERM), 0);
  EXPECT_FALSE(fs::exists(folder_ / "castle_flyover.studio.journal"));  // nothing was edited
}

// The layer is the flight: a report that the studio saves, `lapwing run` with the layer, and with
// the same edits by --set plan the same bytes.
TEST_F(StudioProgram, TheLayerPlansTheSameFlightByteForByte) {
  use("filming/castle_flyover.lua");
  PageClient page(serve(), "a");
  const std::vector<std::pair<std::string, Value>> edits{
      {"keyframes[2].position", place(0, -4, 14.25)},
      {"weights.smoothness", Value(0.002)},
      {"keyframes[3].time", Value(21)},
      {"duration", Value(21)},
      {"margin", Value(0.75)},
      {"obstacles[1].radius", Value(4.5)}};
  std::int64_t revision = 0;
  for (std::size_t i = 0; i < edits.size(); ++i) {
    Value::List changes{change(edits[i].first, edits[i].second)};
    if (edits[i].first == "keyframes[3].time") {  // with the duration: the one needs the other
      ++i;
      changes.push_back(change(edits[i].first, edits[i].second));
    }
    page.send(gesture("g" + std::to_string(i), revision, changes));
    const Value told = page.until([](const Value& m) {
      return m.at("type") == Value("document") || m.at("type") == Value("refused");
    });
    ASSERT_EQ(told.at("type"), Value("document")) << to_json(told);
    revision = told.at("revision").as_integer();
  }
  const Value judged = page.until_judged(revision);
  EXPECT_EQ(judged.at("grade"), Value("certified")) << judged.at("message").as_text();
  Value save = page_says("save_report");
  save.set("id", "s");
  page.send(save);
  const Value wrote = page.until_type("wrote");
  EXPECT_EQ(wrote.at("status"), Value("ok"));
  const std::string saved = read_file(folder_ / "out/castle_flyover/plan.json");
  ASSERT_EQ(run({"run", "castle_flyover.lua", "--config", "castle_flyover.studio.yaml", "-o",
                 "layer", "--quiet"}),
            0)
      << errors_;
  EXPECT_TRUE(read_file(folder_ / "layer/plan.json") == saved);
  std::vector<std::string> words{"run", "castle_flyover.lua", "-o", "set", "--quiet"};
  for (const auto& [path, value] : edits)
    words.insert(words.end(), {"--set", path + "=" + to_json(value, -1)});
  ASSERT_EQ(run(words), 0) << errors_;
  EXPECT_TRUE(read_file(folder_ / "set/plan.json") == saved);
  // And so does the script that is written out, but for what tells that it is another.
  Value lua = page_says("export_lua");
  lua.set("id", "l");
  page.send(lua);
  page.until_type("wrote");
  ASSERT_EQ(run({"run", "castle_flyover.studio.lua", "-o", "lua", "--quiet"}), 0) << errors_;
  EXPECT_TRUE(read_file(folder_ / "lua/plan.json") == saved);
  // What is drawn is that flight, within the solver's tolerance.
  const Plan plan = read_plan(folder_ / "set/plan.json");
  const Value& x = judged.at("plan").at("columns").at("x");
  ASSERT_EQ(x.as_list().size(), plan.trajectory.samples.size());
  for (std::size_t i = 0; i < plan.trajectory.samples.size(); ++i)
    ASSERT_NEAR(x.as_list()[i].as_number(), plan.trajectory.samples[i].position.x(), 0.1);
  // Another camera on the vehicle, which is then a table in place of a name.
  Value vehicle;
  for (const Value& one : page.welcome.at("choices").at("vehicle").as_list())
    if (one.at("name") == Value("vehicles/solo")) vehicle = one.at("layer");
  vehicle.set("camera", "cameras/one_inch");
  page.send(gesture("camera", revision, {change("vehicle", vehicle)}));
  ++revision;
  EXPECT_NE(page.until_judged(revision).at("plan").at("camera").at("name"),
            judged.at("plan").at("camera").at("name"));
  save.set("id", "s2");
  page.send(save);
  page.until_type("wrote");
  ASSERT_EQ(run({"run", "castle_flyover.lua", "--config", "castle_flyover.studio.yaml", "-o",
                 "layer", "--quiet"}),
            0)
      << errors_;
  EXPECT_TRUE(read_file(folder_ / "layer/plan.json") ==
              read_file(folder_ / "out/castle_flyover/plan.json"));
  // All taken back: the script alone, and no layer.
  for (std::int64_t i = revision; i > 0; --i) {
    Value undo = page_says("undo");
    undo.set("id", "u" + std::to_string(i));
    undo.set("base", 2 * revision - i);
    page.send(undo);
    page.until_type("document");
  }
  server_->end(SIGTERM);
  EXPECT_FALSE(fs::exists(folder_ / "castle_flyover.studio.yaml"));
}

// A film of a file: its keyframes stand in the document, and what is edited in the layer.
TEST_F(StudioProgram, FilmsOfFilesAreEditedLikeOthers) {
  write_file_atomically(folder_ / "file.json", R"({"refLLH": {"lat": 47, "lng": 8, "altitude": 400},
    "keyframeTimes": [0, 8, 16], "keyFrameList": [
    {"lookFromNED": {"n": -20, "e": 0, "d": -8}, "lookAtNED": {"n": 0, "e": 0, "d": -2}},
    {"lookFromNED": {"n": -14, "e": 12, "d": -10}, "lookAtNED": {"n": 0, "e": 1, "d": -2}},
    {"lookFromNED": {"n": 0, "e": 20, "d": -8}, "lookAtNED": {"n": 0, "e": 2, "d": -2}}]})");
  write_file_atomically(folder_ / "film.lua", R"(local film = require "mission.film"
return film.from_file { name = "film", input = "file.json" }
)");
  script_ = "film.lua";
  PageClient page(serve(), "a");
  EXPECT_EQ(page.welcome.at("document").at("subjects").as_list()[0].at("name"), Value("look-at"));
  ASSERT_EQ(page.welcome.at("document").at("keyframes").as_list().size(), 3u);
  EXPECT_EQ(page.until_judged(0).at("grade"), Value("certified"));
  page.send(gesture("g", 0, {change("keyframes[2].position", place(12, -13, 12))}));
  EXPECT_EQ(page.until_type("document").at("patch").as_list().size(), 1u);
  EXPECT_EQ(page.until_judged(1).at("grade"), Value("certified"));
  page.send_text(R"({"type": "save_report", "id": "s"})");
  EXPECT_EQ(page.until_type("wrote").at("status"), Value("ok"));
  ASSERT_EQ(run({"run", "film.lua", "--config", "film.studio.yaml", "-o", "layer", "--quiet"}), 0)
      << errors_;
  EXPECT_TRUE(read_file(folder_ / "layer/plan.json") == read_file(folder_ / "out/film/plan.json"));
  page.send_text(R"({"type": "export_lua", "id": "l"})");
  page.until_type("wrote");
  ASSERT_EQ(run({"run", "film.studio.lua", "-o", "lua", "--quiet"}), 0) << errors_;
  EXPECT_TRUE(read_file(folder_ / "layer/plan.json") == read_file(folder_ / "lua/plan.json"));
  page.send_text(R"({"type": "undo", "id": "u", "base": 1})");
  page.until_judged(2);
  // A page reads what the script may read, and no other file.
  const fs::path elsewhere = folder_.string() + "_elsewhere.json";
  fs::copy_file(folder_ / "file.json", elsewhere);
  page.send(gesture("read", 2, {change("input", elsewhere.string())}));
  EXPECT_EQ(page.until_type("refused").at("id"), Value("read"));
  page.send(preview(1, {change("input", elsewhere.string())}));
  const Value refused = page.until(
      [](const Value& m) { return m.at("type") == Value("answer") && m.at("edit") == Value(1); });
  EXPECT_EQ(refused.at("grade"), Value("refused"));
  EXPECT_NE(refused.at("message").as_text().find("not found"), std::string::npos)
      << refused.at("message").as_text();
  fs::remove(elsewhere);
  page.send(preview(2, {change("sandbox", Value(Value::Map{{"memory", Value(1)}}))}));
  EXPECT_EQ(page.until([](const Value& m) {
                  return m.at("type") == Value("answer") && m.at("edit") == Value(2) &&
                         m.at("grade") != Value("step") && m.at("grade") != Value("converged");
                })
                .at("grade"),
            Value("certified"));
  server_->end(SIGTERM);
  EXPECT_FALSE(fs::exists(folder_ / "film.studio.yaml"));
}

TEST_F(StudioProgram, FliesPicturesAndExports) {
  use("filming/castle_flyover.lua");
  const StudioAddress address = serve();
  PageClient page(address, "a");
  page.until_judged(0);
  const auto ask = [&](const std::string& text) {
    page.send_text(text);
    return page.until([](const Value& m) {
      return m.at("type") != Value("answer") && m.at("type") != Value("worker");
    });
  };
  const Value calm = ask(R"({"type": "fly", "edit": 1, "wind": [0, 0, 0], "seed": 1})");
  const Value windy = ask(R"({"type": "fly", "edit": 2, "wind": [4, 3, 0], "gust": 1, "seed": 1})");
  EXPECT_EQ(calm.at("kept"), Value(true));
  const auto worst = [](const Value& flown) {
    return flown.at("worst").at("position_error").as_number();
  };
  EXPECT_GT(worst(windy), 2 * worst(calm));
  EXPECT_GT(calm.at("samples").at("x").as_list().size(), 500u);
  const Value picture =
      ask(R"({"type": "picture", "edit": 3, "time": 10, "width": 320, "height": 200})");
  ASSERT_EQ(picture.at("type"), Value("picture"));
  const std::string png =
      answer_to(address.port, "GET /blob/" + picture.at("blob").as_text() +
                                  " HTTP/1.1\r\nHost: " + address.host() + "\r\n\r\n");
  EXPECT_NE(png.find("image/png"), std::string::npos);
  EXPECT_NE(png.find("\x89PNG"), std::string::npos);
  EXPECT_EQ(
      ask(R"({"type": "picture", "edit": 3, "time": 99, "width": 32, "height": 20})").at("type"),
      Value("failed"));
  const Value gltf = ask(R"({"type": "export", "id": "e1", "format": "gltf", "parameters": {}})");
  EXPECT_FALSE(gltf.at("loss").as_list().empty());
  EXPECT_TRUE(fs::exists(folder_ / gltf.at("files").as_list()[0].as_text()));
  const Value csv = ask(R"({"type": "export", "id": "e2", "format": "csv"})");
  EXPECT_EQ(csv.at("files").as_list()[0], Value("out/castle_flyover/castle_flyover.csv"));
  EXPECT_NE(ask(R"({"type": "export", "id": "e3", "format": "cvs"})")
                .at("why")
                .as_text()
                .find("did you mean 'csv'"),
            std::string::npos);
  EXPECT_EQ(
      ask(R"({"type": "export", "id": "e4", "format": "csv", "parameters": {"x": 1}})").at("type"),
      Value("failed"));
  // What cannot be flown is exported on request alone.
  page.send(gesture(
      "hasty", 0,
      {change("keyframes[2].time", 1), change("keyframes[3].time", 2), change("duration", 2)}));
  const Value hasty = page.until_judged(1);
  ASSERT_EQ(hasty.at("grade"), Value("rejected"));
  EXPECT_EQ(hasty.at("certificate").at("passed"), Value(false));
  EXPECT_NE(ask(R"({"type": "export", "id": "e5", "format": "csv"})")
                .at("why")
                .as_text()
                .find("not certified"),
            std::string::npos);
  EXPECT_EQ(
      ask(R"({"type": "export", "id": "e6", "format": "csv", "uncertified": true})").at("type"),
      Value("wrote"));
  // Somebody else's file stays.
  write_file_atomically(folder_ / "castle_flyover.studio.lua", "-- mine\n");
  EXPECT_NE(
      ask(R"({"type": "export_lua", "id": "l"})").at("why").as_text().find("is there already"),
      std::string::npos);
}

// The plan keeps the battery's time; the flight along few waypoints past the castle takes longer.
TEST_F(StudioProgram, AFileWhoseFlightBreaksWhatThePlanKeepsIsNotWritten) {
  write_file_atomically(folder_ / "past.lua", R"(local film = require "mission.film"
return film.shot {
  name = "past", duration = 24,
  origin = { latitude_deg = 46.5, longitude_deg = 6.6, height = 0, height_of = "ground" },
  vehicle = { mass = 1.5, drag = 0.2, inertia = {0.015, 0.015, 0.025}, yaw_share = 0.2,
    rotors = { thrust = {0.2, 8}, torque_coefficient = 0.016, arm_length = 0.23 },
    limits = { speed_across = 10, climb_speed = 2.5, descent_speed = 2, acceleration_across = 4,
               yaw_rate_deg = 90 },
    gimbal = { yaw_deg = {0, 0}, yaw_rate_deg = 0, pitch_deg = {-90, 0}, pitch_rate_deg = 90 },
    flight_time = 24.5, camera = "cameras/action" },
  subject = { position = {0, 0, 2}, height = 4, width = 5 },
  keyframes = { { time = 0, position = {-14, 0, 5} }, { time = 12, position = {0, 9, 6} },
                { time = 24, position = {14, 0, 5} } },
  obstacles = { { type = "sphere", name = "castle", center = {0, 0, 2}, radius = 6 },
                { type = "mesh", name = "tent", file = "tent.obj" } },
})");
  write_file_atomically(folder_ / "tent.obj",
                        "v 0 -20 0\nv 4 -20 0\nv 2 -16 0\nv 2 -18 3\n"
                        "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  script_ = "past.lua";
  PageClient page(serve(), "a");
  ASSERT_EQ(page.until_judged(0).at("grade"), Value("certified"));
  const auto ask = [&](const char* tolerances) {
    page.send_text(R"({"type": "export", "id": "e", "format": "qgc_plan", "parameters": )" +
                   std::string(tolerances) + "}");
    return page.until([](const Value& m) {
      return m.at("type") == Value("wrote") || m.at("type") == Value("failed");
    });
  };
  const char* const coarse = R"({"tolerance": 10, "angle_tolerance": 180, "time_tolerance": 1000,
                                "finish": "hover"})";
  const Value refused = ask(coarse);
  ASSERT_EQ(refused.at("type"), Value("failed")) << to_json(refused);
  const std::string& why = refused.at("why").as_text();
  EXPECT_NE(why.find("the file would break what the plan keeps"), std::string::npos) << why;
  EXPECT_NE(why.find("flight_time"), std::string::npos) << why;
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  // `lapwing export` refuses the same file. Along more waypoints there is time.
  ASSERT_EQ(run({"run", "past.lua", "-o", "run", "--quiet"}), 0) << errors_;
  EXPECT_EQ(run({"export", "run/plan.json", "--format",
                 "qgc_plan:tolerance=10,angle_tolerance=180,time_tolerance=1000,finish=hover", "-o",
                 "past.plan"}),
            2);
  EXPECT_NE(errors_.find("the file would break what the plan keeps"), std::string::npos) << errors_;
  const Value wrote = ask(R"({"finish": "hover"})");
  ASSERT_EQ(wrote.at("type"), Value("wrote")) << to_json(wrote);
  EXPECT_TRUE(fs::exists(folder_ / wrote.at("files").as_list()[0].as_text()));
  EXPECT_NE(to_json(wrote.at("loss")).find("m across the path of the plan"), std::string::npos)
      << to_json(wrote.at("loss"));
}

TEST_F(StudioProgram, FollowsItsScriptWithAndWithoutEdits) {
  use("filming/castle_flyover.lua");
  PageClient page(serve(), "a");
  page.until_judged(0);
  const std::string text = read_file(folder_ / script_);
  const auto write = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    ASSERT_NE(changed.find(from), std::string::npos);
    changed.replace(changed.find(from), from.size(), to);
    write_file_atomically(folder_ / script_, changed);
  };
  const auto resolve = [&](const char* take) {
    Value message = page_says("resolve_script");
    message.set("take", take);
    page.send(message);
    return page.until_type("document");
  };
  write("radius = 5", "radius = 4");  // without edits the document follows
  const Value followed = page.until_type("document");
  EXPECT_EQ(to_json(followed.at("patch"), -1), R"([{"path":"obstacles[1].radius","value":4.0}])");
  write("radius = 5", "radius = (4");  // an error: told with its line, and the document stays
  const Value error = page.until_type("script_error");
  EXPECT_EQ(error.at("line"), Value(16)) << to_json(error);
  write("radius = 5", "radius = 4");
  page.until_type("answer");
  page.send(gesture("g", 1, {change("keyframes[2].position", place(0, -4, 14))}));
  page.until_judged(2);
  write("radius = 5", "radius = 3");
  EXPECT_EQ(page.until_type("script_changed").at("conflict"), Value(false));
  const Value both = resolve("both");
  EXPECT_EQ(to_json(both.at("patch"), -1), R"([{"path":"obstacles[1].radius","value":3.0}])");
  write("{  0, -2, 14}", "{  0, -3, 14}");
  EXPECT_EQ(page.until_type("script_changed").at("conflict"), Value(true));
  const Value theirs = resolve("theirs");
  EXPECT_EQ(theirs.at("revision"), Value(4));
  page.send_text(R"({"type": "undo", "id": "u", "base": 4})");  // the edit is back, on their script
  EXPECT_EQ(to_json(page.until_type("document").at("patch"), -1),
            R"([{"path":"keyframes[2].position","value":[0.0,-4.0,14.0]},)"
            R"({"path":"obstacles[1].radius","value":3.0}])");
  EXPECT_EQ(page.until_judged(5).at("grade"), Value("certified"));
  server_->end(SIGTERM);
  // Changed while nobody looked: asked for when it is opened.
  write("{ 18,  4,  5}", "{ 18,  6,  5}");
  PageClient again(serve(), "b");
  EXPECT_EQ(again.welcome.at("revision"), Value(5));
  EXPECT_EQ(again.until_type("script_changed").at("conflict"), Value(true));
  again.send_text(R"({"type": "resolve_script", "take": "mine"})");
  again.until_type("document");
  EXPECT_EQ(again.until_judged(6).at("grade"), Value("certified"));
  again.send_text(R"({"type": "resolve_script", "take": "mine"})");
  EXPECT_EQ(again.until_type("refused").at("id"), Value("resolve_script"));
}

TEST_F(StudioProgram, OpensAScriptWithAnErrorAndFollowsIt) {
  use("filming/castle_flyover.lua");
  const std::string text = read_file(folder_ / script_);
  write_file_atomically(folder_ / script_, "local film = require \"mission.film\"\nreturn {\n");
  PageClient page(serve(), "a");
  EXPECT_TRUE(page.welcome.at("document").is_null());
  const Value error = page.until_type("script_error");
  EXPECT_GT(error.at("line").as_integer(), 0) << to_json(error);
  page.send(gesture("g", 0, {change("margin", 1)}));
  EXPECT_EQ(page.until_type("refused").at("id"), Value("g"));
  write_file_atomically(folder_ / script_, text);
  const Value welcome = page.until_type("welcome");
  EXPECT_EQ(welcome.at("document").at("keyframes").as_list().size(), 3u);
  EXPECT_EQ(page.until_judged(0).at("grade"), Value("certified"));
}

TEST_F(StudioProgram, OpensOtherMissionsAndFilmsOfSeveralProblems) {
  use("racing/seven_gates.lua");
  {
    PageClient page(serve(), "a");
    EXPECT_EQ(page.welcome.at("mission").at("editable"), Value(false));
    const Value answer = page.until_judged(0);
    EXPECT_EQ(answer.at("grade"), Value("certified")) << answer.at("message").as_text();
    EXPECT_EQ(answer.at("plan").at("gates").as_list().size(), 7u);
  }
  write_file_atomically(folder_ / "free.lua", R"(local film = require "mission.film"
return film.shot { timing = "free", subject = { position = {0, 0, 2}, height = 4 },
  keyframes = { { time = 0, position = {-18, -6, 3} }, { time = 10, position = {0, -12, 9} } } }
)");
  script_ = "free.lua";
  PageClient page(serve(), "a");
  EXPECT_EQ(page.welcome.at("mission").at("editable"), Value(true));
  EXPECT_EQ(page.until_judged(0).at("grade"), Value("certified"));
  page.send(gesture("g", 0, {change("keyframes[2].position", place(0, -11, 8))}));
  EXPECT_EQ(page.until_judged(1).at("grade"), Value("certified"));
}

TEST_F(StudioProgram, SaysWhatIsInTheWayOfStarting) {
  use("filming/castle_flyover.lua");
  const StudioAddress address = serve();
  write_file_atomically(folder_ / "other.lua", read_file(folder_ / script_));
  const auto fails = [&](std::vector<std::string> words, const std::string& why) {
    words.insert(words.begin(), {"studio", "--no-open"});
    EXPECT_EQ(run(words), 2);
    EXPECT_NE(errors_.find(why), std::string::npos) << errors_;
  };
  fails({"other.lua", "--assets", "page", "--port", std::to_string(address.port)}, "it is in use");
  fails({script_.string(), "--assets", "page"}, "another studio has this mission open");
  fails({"none.lua", "--assets", "page"}, "none.lua");
  fails({"other.lua", "--assets", "nowhere"}, "no index.html");
  fails({"page/index.html", "--assets", "page", "--port", "0"}, "--port");
  fails({"page/studio.js", "--assets", "page", "--data", "nowhere"}, "nowhere");
  EXPECT_FALSE(fs::exists(folder_ / "other.studio.journal"));
}

// ---- loss ---------------------------------------------------------------------------------------

std::optional<Value> value_at(const Value& document, const std::string& path) {
  const OptionPath parsed = option_path(path);
  const Value* found = find_at(document, parsed, parsed.size());
  return found ? std::optional<Value>(*found) : std::nullopt;
}

// Pages of a studio that was killed find the next one, where the user's runtime folder is private.
TEST_F(StudioProgram, AfterAKillTheNextOneHasTheSameAddress) {
  use("filming/castle_flyover.lua");
  const fs::path runtime = folder_ / "runtime";
  fs::create_directory(runtime);
  fs::permissions(runtime, fs::perms::owner_all);
  ::setenv("XDG_RUNTIME_DIR", runtime.c_str(), 1);
  const StudioAddress first = serve();
  const fs::path kept = fs::directory_iterator(runtime)->path();
  EXPECT_EQ(fs::status(kept).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  server_->end(SIGKILL);
  const StudioAddress second = serve();
  EXPECT_EQ(second.port, first.port);
  EXPECT_EQ(second.token, first.token);
  PageClient(second, "a").until_judged(0);
  server_->end(SIGTERM);  // in order: the next one has another token
  EXPECT_TRUE(fs::is_empty(runtime));
  EXPECT_NE(serve().token, first.token);
  server_->end(SIGKILL);
  // What others could have written, and what is none, is not used.
  const auto with_file = [&](const std::string& text, fs::perms mode) {
    write_file_atomically(kept, text);
    fs::permissions(kept, mode);
    const std::string token = serve().token;
    server_->end(SIGKILL);
    return token;
  };
  const std::string token(32, 'a'),
      text = R"({"port": )" + std::to_string(first.port) + R"(, "token": ")" + token + R"("})";
  const fs::perms own = fs::perms::owner_read | fs::perms::owner_write;
  EXPECT_EQ(with_file(text, own), token);
  EXPECT_NE(with_file(text, own | fs::perms::others_write), token);
  EXPECT_NE(with_file(R"({"port": 1, "token": ""})", own), "");
  EXPECT_EQ(with_file("nonsense", own).size(), 32u);
  ::unsetenv("XDG_RUNTIME_DIR");
}

// Killed at random moments of a stream of edits: what was acknowledged is there, all of it can be
// taken back, and the layer is that of the journal.
TEST_F(StudioProgram, AKillOfTheServerLosesNoEditThatWasAcknowledged) {
  use("filming/castle_flyover.lua");
  std::mt19937 random(5);
  const int rounds = std::getenv("LAPWING_MANY_KILLS") ? 100 : 12;
  double margin = 0.5, slowest = 0;
  std::int64_t acknowledged = 0;
  for (int round = 0; round < rounds; ++round) {
    const auto began = std::chrono::steady_clock::now();
    std::optional<PageClient> page;
    page.emplace(serve(), "a");
    slowest = std::max(
        slowest, std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
    std::int64_t revision = page->welcome.at("revision").as_integer();
    ASSERT_GE(revision, acknowledged) << round;
    ASSERT_LE(revision, acknowledged + 1);  // one may have been written and not yet told
    const double now = value_at(page->welcome.at("document"), "margin")->as_number();
    ASSERT_TRUE(now == margin || (revision == acknowledged + 1 && now == margin + 0.001)) << now;
    margin = now;
    acknowledged = revision;
    // After none to four acknowledged edits, and a part of another.
    std::atomic<std::int64_t> told_of = 0;
    std::thread killer([&, edits = random() % 5, pause = random() % 100] {
      while (told_of < static_cast<std::int64_t>(edits))
        std::this_thread::sleep_for(milliseconds(1));
      std::this_thread::sleep_for(milliseconds(pause));
      ::kill(server_->process, SIGKILL);
    });
    for (;;) {
      const double next = margin + 0.001;
      page->send(gesture("g" + std::to_string(round) + "." + std::to_string(revision), revision,
                         {change("margin", next)}));
      Value told;
      do {
        told = page->receive();
      } while (!told.is_null() && told.at("type") != Value("document") &&
               told.at("type") != Value("refused"));
      if (told.is_null()) break;
      EXPECT_EQ(told.at("type"), Value("document")) << to_json(told);
      margin = next;
      acknowledged = ++revision;
      ++told_of;
    }
    killer.join();
    server_->end(SIGKILL);
  }
  EXPECT_GT(acknowledged, rounds);
  EXPECT_LT(slowest, 20) << "s until reconnected";  // 0.1 on an idle machine
  std::printf("%d kills of the server: %lld edits, at most %.2f s until connected again\n", rounds,
              static_cast<long long>(acknowledged), slowest);
  PageClient page(serve(), "a");
  std::int64_t revision = page.welcome.at("revision").as_integer();
  for (std::int64_t left = revision, end = revision; left > 0; --left) {
    page.send_text(R"({"type": "undo", "id": "u)" + std::to_string(left) + R"(", "base": )" +
                   std::to_string(end++) + "}");
    const Value told = page.until_type("document");
    ASSERT_EQ(told.at("can_undo"), Value(left > 1));
    revision = end;
  }
  EXPECT_EQ(page.until_judged(revision).at("grade"), Value("certified"));
  server_->end(SIGTERM);
  EXPECT_FALSE(fs::exists(folder_ / "castle_flyover.studio.yaml"));
}

TEST_F(StudioProgram, AKillOfAWorkerCostsASolveAndNothingElse) {
  use("filming/castle_flyover.lua");
  PageClient page(serve(), "a");
  page.until_judged(0);
  std::mt19937 random(6);
  const int rounds = std::getenv("LAPWING_MANY_KILLS") ? 100 : 12;
  std::int64_t revision = 0;
  int crashes = 0;
  for (int round = 0; round < rounds; ++round) {
    page.send(gesture("g" + std::to_string(round), revision,
                      {change("keyframes[2].position", place(0, -2.1 - 0.1 * round, 14))}));
    std::this_thread::sleep_for(milliseconds(random() % 150));
    const std::vector<pid_t> workers = server_->workers();
    if (workers.empty()) continue;
    ::kill(workers[random() % workers.size()], SIGKILL);
    const Value judged = page.until([&](const Value& m) {
      crashes += m.at("type") == Value("worker") && m.at("state") == Value("crashed");
      EXPECT_NE(m.at("type"), Value("refused")) << to_json(m);
      return m.at("type") == Value("answer") && m.at("revision") == Value(revision + 1) &&
             m.at("grade") == Value("certified");
    });
    ++revision;
    // Time between: many crashes in a short time are answered by a pause.
    std::this_thread::sleep_for(milliseconds(100));
  }
  EXPECT_GE(crashes, rounds / 2);
  EXPECT_EQ(revision, rounds);
}

// What a plugin breaks while its edit is solved costs that edit's answer.
TEST_F(StudioProgram, APluginThatCrashesCostsItsEdit) {
  use("filming/castle_flyover.lua");
  const std::string rogues = std::string(LAPWING_BUILD_DIR) + "/tests/plugin_fixtures/rogue";
  PageClient page(serve({"--plugin-path", rogues}), "a");
  page.until_judged(0);
  page.send_text(R"({"type": "gesture", "id": "g", "base": 0, "label": "", "patch": [{"path":
    "solver", "value": {"type": "rogue_solver", "where": "solve", "how": "crashes"}}]})");
  std::string why;
  const Value judged = page.until([&](const Value& m) {
    if (m.at("type") == Value("worker") && m.at("state") == Value("crashed"))
      why = m.at("message").as_text();
    return m.at("type") == Value("answer") && m.at("revision") == Value(1) &&
           m.at("grade") == Value("refused");
  });
  EXPECT_NE(why.find("rogue_solver"), std::string::npos) << why;
  page.send_text(R"({"type": "undo", "id": "u", "base": 1})");
  EXPECT_EQ(page.until_judged(2).at("grade"), Value("certified"));
}

TEST_F(StudioProgram, AFullDiskIsSaidAndNothingIsHalfWritten) {
  use("filming/castle_flyover.lua");
  PageClient page(serve(), "a");
  page.until_judged(0);
  page.send(gesture("g1", 0, {change("margin", 0.6)}));
  page.until_judged(1);
  const std::string before = journal();
  rlimit old{};
  const rlimit full{before.size() + 10, RLIM_INFINITY};
  ASSERT_EQ(::prlimit(server_->process, RLIMIT_FSIZE, &full, &old), 0);
  page.send(gesture("g2", 1, {change("margin", 0.7)}));
  const Value refused = page.until_type("refused");
  EXPECT_EQ(refused.at("id"), Value("g2"));
  EXPECT_NE(refused.at("why").as_text().find("nothing was changed"), std::string::npos);
  EXPECT_EQ(journal(), before);
  EXPECT_EQ(page.until_judged(1).at("grade"), Value("certified"));
  ASSERT_EQ(::prlimit(server_->process, RLIMIT_FSIZE, &old, nullptr), 0);
  page.send(gesture("g2", 1, {change("margin", 0.7)}));
  EXPECT_EQ(page.until_type("document").at("revision"), Value(2));
  server_->end(SIGTERM);
  ASSERT_EQ(run({"config", "castle_flyover.lua", "--config", "castle_flyover.studio.yaml"}), 0);
}

// ---- two tabs, and time -------------------------------------------------------------------------

struct EditingTab {
  EditingTab(const StudioAddress& address, const std::string& tab)
      : page(address, tab),
        document(page.welcome.at("document")),
        revision(page.welcome.at("revision").as_integer()) {}
  // Takes one message; false where none came for so long.
  bool hear(milliseconds patience) {
    const Value message = page.receive(patience);
    if (message.is_null()) return false;
    if (message.at("type") == Value("refused")) ++answered;
    if (message.at("type") != Value("document")) return true;
    apply_patch(document, patch_from(message.at("patch"), "patch"));
    revision = message.at("revision").as_integer();
    heard_at = std::chrono::steady_clock::now();
    const std::string& by = message.at("by").as_text();
    if (by.starts_with(own)) ++answered;
    return true;
  }
  PageClient page;
  Value document;
  std::int64_t revision;
  std::string own;
  int sent = 0, answered = 0;
  std::chrono::steady_clock::time_point heard_at;
};

TEST_F(StudioProgram, TwoTabsEndEqual) {
  use("filming/castle_flyover.lua");
  const StudioAddress address = serve();
  EditingTab tabs[2] = {{address, "a"}, {address, "b"}};
  tabs[0].own = "a";
  tabs[1].own = "b";
  std::mt19937 random(8);
  const int edits = std::getenv("LAPWING_MANY_KILLS") ? 1000 : 150;
  for (int k = 0; k < edits; ++k) {
    EditingTab& tab = tabs[random() % 2];
    const char* paths[] = {"margin", "weights.yaw", "weights.camera", "keyframes[2].position",
                           "obstacles[1].radius"};
    const std::string path = paths[random() % 5];
    const double number = 1 + static_cast<double>(random() % 100) / 50;
    tab.page.send(gesture(
        tab.own + std::to_string(k), tab.revision,
        {change(path, path.ends_with("position") ? place(number, -2, 14) : Value(number))}));
    ++tab.sent;
    for (EditingTab& each : tabs)
      while (each.sent - each.answered > 3) ASSERT_TRUE(each.hear(milliseconds(20000)));
  }
  for (EditingTab& each : tabs)
    while (each.answered < each.sent) ASSERT_TRUE(each.hear(milliseconds(20000)));
  // The newest revision reaches both.
  std::chrono::duration<double, std::milli> apart{0};
  while (tabs[0].revision != tabs[1].revision) {
    EditingTab& behind = tabs[0].revision < tabs[1].revision ? tabs[0] : tabs[1];
    ASSERT_TRUE(behind.hear(milliseconds(20000)));
    apart = tabs[0].heard_at - tabs[1].heard_at;
  }
  EXPECT_LT(std::abs(apart.count()), 100);
  EXPECT_TRUE(same_options(tabs[0].document, tabs[1].document));
  EXPECT_TRUE(same_options(PageClient(address, "c").welcome.at("document"), tabs[0].document));
  EXPECT_GT(tabs[0].revision, edits / 4);
}

double median(std::vector<double> numbers) {
  std::sort(numbers.begin(), numbers.end());
  return numbers[numbers.size() / 2];
}

// From a move of a keyframe to each grade, as the page would see it.
TEST_F(StudioProgram, TellsHowLongAnEditTakes) {
  use("filming/castle_flyover.lua");
  const auto began = std::chrono::steady_clock::now();
  const auto since = [](auto begin) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
        .count();
  };
  PageClient page(serve(), "a");
  page.until_judged(0);
  const double first = since(began);
  std::map<std::string, std::vector<double>> times;
  for (int k = 0; k < 20; ++k) {
    const auto sent = std::chrono::steady_clock::now();
    page.send(preview(k, {change("keyframes[2].position", place(0, -2 - 0.2 * (k % 7), 14))}));
    std::map<std::string, double> first_of;
    page.until([&](const Value& m) {
      if (m.at("type") != Value("answer") || m.at("edit") != Value(k)) return false;
      first_of.emplace(m.at("grade").as_text(), since(sent));
      first_of.emplace("any", since(sent));
      return m.at("grade") == Value("certified");
    });
    for (const auto& [grade, time] : first_of) times[grade].push_back(time);
  }
  std::printf("castle_flyover: certified %.0f ms after the command; after an edit (medians):",
              first);
  for (const auto& [grade, all] : times) std::printf(" %s %.0f ms,", grade.c_str(), median(all));
  std::printf(" of 20\n");
  EXPECT_EQ(times.at("certified").size(), 20u);
  EXPECT_LT(median(times.at("certified")), 2000);
}

}  // namespace
}  // namespace lapwing
