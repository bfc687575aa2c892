// SPDX-License-Identifier: Apache-2.0
// The program itself: `lapwing studio` with its working processes, and pages that are clients.
#include "tests/studio/program_fixture.h"

namespace lapwing {
namespace {

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

// A ball in the way, which the flight passes on the side that the drag began on; planned from the
// beginning it takes the other side.
TEST_F(StudioProgram, WhatIsCertifiedIsTheFlightThatTheScriptPlans) {
  write_file_atomically(folder_ / "past.lua", R"(local film = require "mission.film"
return film.shot {
  name = "past", duration = 20,
  keyframes = { { time = 0, position = {-12, 1, 3}, yaw_deg = 0 },
                { time = 20, position = {12, 1, 3} } },
  obstacles = { { type = "cylinder", name = "tower", base = {0, 0, -20}, radius = 3,
                  height = 60 } },
})");
  script_ = "past.lua";
  PageClient page(serve(), "a");
  const auto side = [](const Value& answer) {
    const Value::List& y = answer.at("plan").at("columns").at("y").as_list();
    return y[y.size() / 2].as_number();
  };
  const auto last_of = [](const Value& m) {
    return m.at("type") == Value("answer") && !m.at("certificate").is_null();
  };
  const Value first = page.until_judged(0);
  ASSERT_EQ(first.at("grade"), Value("certified"));
  ASSERT_GT(side(first), 3);
  Value last;
  for (int i = 1; i <= 8; ++i) {
    const double y = 1 - 0.25 * i;
    page.send(preview(i, {change("keyframes[1].position", place(-12, y, 3)),
                          change("keyframes[2].position", place(12, y, 3))}));
    last = page.until(last_of);
  }
  EXPECT_GT(side(last), 3);  // as it was dragged
  page.send(gesture("g", 0,
                    {change("keyframes[1].position", place(-12, -1, 3)),
                     change("keyframes[2].position", place(12, -1, 3))}));
  const Value settled = page.until_judged(1);
  ASSERT_EQ(settled.at("grade"), Value("certified"));
  EXPECT_LT(side(settled), -3);
  EXPECT_NE(settled.at("message").as_text().find("another way"), std::string::npos);
  const auto same_as_run = [&](const char* id, std::vector<std::string> words) {
    page.send_text(std::string(R"({"type": "export", "format": "csv", "id": ")") + id + R"("})");
    const fs::path csv = page.until_type("wrote").at("files").as_list()[0].as_text();
    words.insert(words.begin(), {"run", "past.lua", "-o", id, "--quiet"});
    EXPECT_EQ(run(words), 0) << errors_;
    EXPECT_TRUE(read_file(csv) == read_file(folder_ / id / "trajectory.csv")) << id;
  };
  page.send_text(R"({"type": "save_report", "id": "s"})");
  EXPECT_EQ(page.until_type("wrote").at("loss"), Value::list());
  same_as_run("edited", {"--config", "past.studio.yaml"});
  // Taken back, it is the flight of before, on its side.
  page.send_text(R"({"type": "undo", "id": "u", "base": 1})");
  const Value undone = page.until_judged(2);
  EXPECT_EQ(to_json(undone.at("plan")), to_json(first.at("plan")));
  same_as_run("undone", {});
  // And again after a restart, where nothing is remembered.
  server_->end(SIGTERM);
  PageClient other(serve(), "b");
  EXPECT_EQ(to_json(other.until_judged(2).at("plan")), to_json(first.at("plan")));
}

// A film of many stages is dragged with fewer of them, and judged whole.
TEST_F(StudioProgram, LongFilmsAreDraggedCoarsely) {
  write_file_atomically(folder_ / "long.lua", R"(local film = require "mission.film"
return film.shot {
  name = "long", keyframes = { { time = 0, position = {0, 0, 5}, yaw_deg = 0 },
    { time = 60, position = {100, 20, 15} }, { time = 120, position = {200, 0, 5} } } })");
  script_ = "long.lua";
  PageClient page(serve(), "a");
  const auto samples = [](const Value& answer) {
    return answer.at("plan").at("columns").at("time").as_list().size();
  };
  const Value first = page.until_judged(0);
  ASSERT_EQ(first.at("grade"), Value("certified"));
  EXPECT_EQ(samples(first), 1201u);
  page.send(preview(1, {change("keyframes[2].position", place(100, 22, 15))}));
  const Value dragged = page.until([](const Value& m) {
    return m.at("type") == Value("answer") && m.at("grade") == Value("converged");
  });
  EXPECT_EQ(samples(dragged), 601u);
  EXPECT_NE(dragged.at("message").as_text().find("when you let go"), std::string::npos);
  page.send(gesture("g", 0, {change("keyframes[2].position", place(100, 22, 15))}));
  std::set<std::string> grades;
  const Value judged = page.until([&](const Value& m) {
    if (m.at("type") != Value("answer")) return false;
    if (!m.at("edit").is_null()) grades.insert(m.at("grade").as_text());
    return m.at("edit").is_null() && m.at("revision") == Value(1) && !m.at("certificate").is_null();
  });
  EXPECT_EQ(judged.at("grade"), Value("certified"));
  EXPECT_EQ(samples(judged), 1201u);
  EXPECT_EQ(judged.at("message").as_text(), "");
  EXPECT_EQ(grades.count("certified"), 0u);
}

// The certificate has what `lapwing run` judges, provenance too.
TEST_F(StudioProgram, TheCertificateIsTheOneOfARun) {
  use("filming/castle_flyover.lua");
  PageClient page(serve({"--set", "margin=0.8"}), "a");
  EXPECT_EQ(page.until_judged(1).at("certificate").at("passed"), Value(true));
  page.send(gesture("g", 1, {change("margin", 0.75)}));
  const Value judged = page.until_judged(2);
  ASSERT_EQ(run({"run", "castle_flyover.lua", "--set", "margin=0.75", "-o", "run", "--quiet"}), 0);
  const Certificate theirs =
      Certificate::from_value(read_plan(folder_ / "run/plan.json").certificate);
  const Value::List& mine = judged.at("certificate").at("checks").as_list();
  ASSERT_EQ(mine.size(), theirs.checks.size());
  bool provenance = false;
  for (std::size_t i = 0; i < mine.size(); ++i) {
    EXPECT_EQ(mine[i].at("name"), Value(theirs.checks[i].name));
    EXPECT_EQ(mine[i].at("text").as_text(), result_of(theirs.checks[i]));
    provenance = provenance || (theirs.checks[i].name == "provenance" && mine[i].find("detail"));
  }
  EXPECT_TRUE(provenance);
}

// Zero problems, or several: the meshes that the script names are pictured and exported.
TEST_F(StudioProgram, FilmsOfSeveralProblemsShowTheirMeshes) {
  write_file_atomically(folder_ / "tent.obj",
                        "v 0 -20 0\nv 4 -20 0\nv 2 -16 0\nv 2 -18 3\n"
                        "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  write_file_atomically(folder_ / "tent.lua", R"(local film = require "mission.film"
return film.shot {
  name = "tent", timing = "path_first",
  subject = { position = {0, 0, 2}, height = 4, width = 5 },
  keyframes = { { time = 0, position = {-14, 0, 5} }, { time = 12, position = {0, 12, 6} },
                { time = 24, position = {14, 0, 5} } },
  obstacles = { { type = "mesh", name = "tent", file = "tent.obj" } },
})");
  script_ = "tent.lua";
  PageClient page(serve(), "a");
  page.until_judged(0);
  const auto ask = [&](const std::string& text) {
    page.send_text(text);
    return page.until([](const Value& m) {
      return m.at("type") == Value("picture") || m.at("type") == Value("wrote") ||
             m.at("type") == Value("failed");
    });
  };
  const Value picture =
      ask(R"({"type": "picture", "edit": 1, "time": 10, "width": 64, "height": 36})");
  EXPECT_EQ(picture.at("type"), Value("picture")) << to_json(picture);
  const Value gltf = ask(R"({"type": "export", "id": "e", "format": "gltf", "uncertified": true})");
  ASSERT_EQ(gltf.at("type"), Value("wrote")) << to_json(gltf);
  EXPECT_NE(read_file(gltf.at("files").as_list()[0].as_text()).find("tent"), std::string::npos);
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
  const fs::path written = gltf.at("files").as_list()[0].as_text();
  EXPECT_TRUE(written.is_absolute() && fs::exists(written)) << written;
  const Value csv = ask(R"({"type": "export", "id": "e2", "format": "csv"})");
  EXPECT_EQ(csv.at("files").as_list()[0],
            Value((fs::canonical(folder_) / "out/castle_flyover/castle_flyover.csv").string()));
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

}  // namespace
}  // namespace lapwing
