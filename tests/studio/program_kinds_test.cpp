// SPDX-License-Identifier: Apache-2.0
// The program with missions of other kinds than films: what a page is told of them beside the plan.
#include "tests/studio/kinds_fixture.h"

namespace lapwing {
namespace {

// What the page shows of a scan is what the run writes, to the byte.
TEST_F(StudioKinds, AScanTellsWhatItsRunWrites) {
  use("scan/church.lua");
  const std::vector<std::string> options{"--config",     "scan/small", "--set",
                                         "resolution=1", "--set",      "tour.budget=90"};
  const StudioAddress address = serve(options);
  PageClient page(address, "a");
  const auto [world, answer] = told(page);
  const Value& scan = world.at("scan");
  EXPECT_EQ(scan.at("candidates").as_list().size(), 150u);
  EXPECT_EQ(scan.at("first_views").as_list().size(), 40u);
  EXPECT_EQ(scan.at("region").as_list().size(), 1u);
  EXPECT_GT(scan.at("score").as_list().back().as_number(), 0);
  // Each view is a place of the flight.
  const Value& columns = answer.at("plan").at("columns");
  const double duration = answer.at("plan").at("duration").as_number();
  ASSERT_GT(scan.at("views").as_list().size(), 2u);
  for (const Value& view : scan.at("views").as_list())
    EXPECT_LE(view.at("time").as_number(), duration);
  EXPECT_EQ(columns.at("time").as_list().size(), columns.at("x").as_list().size());
  // The picture needs the surface that planning made.
  EXPECT_EQ(picture(page, 10).at("type"), Value("picture"));
  std::vector<std::string> words{"run", script_.string(), "-o", "flown", "--json"};
  words.insert(words.end(), options.begin(), options.end());
  EXPECT_EQ(run(words), 0) << errors_;
  EXPECT_EQ(blob(address, scan.at("surface")), read_file(folder_ / "flown/prediction.ply"));
  EXPECT_NE(read_file(folder_ / "flown/report.html").find(scan.at("prediction_words").as_text()),
            std::string::npos);
  EXPECT_NE(read_file(folder_ / "flown/report.html").find(scan.at("words").as_text()),
            std::string::npos);
}

// An edit of the budget keeps the views of the plan before, and is the plan of the run all the
// same; a drag of it tells what that plan will come to.
TEST_F(StudioKinds, ABudgetIsEstimatedWhileItIsDraggedAndPlannedOnTheSameViews) {
  use("scan/church.lua");
  const std::vector<std::string> options{"--config", "scan/small", "--set", "resolution=1"};
  const StudioAddress address = serve(options);
  PageClient page(address, "a");
  const auto begun = std::chrono::steady_clock::now();
  const std::int64_t revision = told(page).second.at("revision").as_integer();
  const auto first = std::chrono::steady_clock::now() - begun;
  page.send_text(R"({"type": "preview", "edit": 7,
                     "patch": [{"path": "tour.budget", "value": 150}]})");
  const Value estimate = page.until([](const Value& m) {
    return m.at("type") == Value("estimate") || m.at("type") == Value("refused");
  });
  ASSERT_EQ(estimate.at("type"), Value("estimate")) << to_json(estimate);
  EXPECT_EQ(estimate.at("edit"), Value(std::int64_t{7}));
  EXPECT_EQ(estimate.at("tab"), Value("a"));
  // A drag that needs other views is not estimated; it is planned when it is let go of.
  page.send_text(R"({"type": "preview", "edit": 8,
                     "patch": [{"path": "candidates.most", "value": 90}]})");
  const Value none = page.until([](const Value& m) {
    return m.at("type") == Value("estimate") && m.at("edit") == Value(std::int64_t{8});
  });
  EXPECT_EQ(none.find("images"), nullptr);
  const auto began = std::chrono::steady_clock::now();
  page.send_text(R"({"type": "gesture", "id": "g", "label": "budget",
                     "patch": [{"path": "tour.budget", "value": 150}], "base": )" +
                 std::to_string(revision) + "}");
  Value world, answer;
  page.until([&](const Value& m) {
    if (m.at("type") == Value("world")) world = m;
    if (m.at("type") == Value("answer")) answer = m;
    EXPECT_NE(m.at("type"), Value("estimate"));
    return m.at("type") == Value("answer") && m.at("revision") == Value(revision + 1) &&
           m.at("grade") == Value("certified");
  });
  EXPECT_LT(std::chrono::steady_clock::now() - began, first);
  std::vector<std::string> words{"run",   script_.string(), "-o", "flown", "--json",
                                 "--set", "tour.budget=150"};
  words.insert(words.end(), options.begin(), options.end());
  EXPECT_EQ(run(words), 0) << errors_;
  const Plan plan = read_plan(folder_ / "flown/plan.json");
  const Value& drawn = answer.at("plan");
  EXPECT_NEAR(drawn.at("duration").as_number(), plan.trajectory.duration(), 1e-6);
  const Value::List& views = world.at("scan").at("views").as_list();
  ASSERT_EQ(views.size(), plan.task.scan->views.size());
  for (std::size_t k = 0; k < views.size(); ++k)
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(views[k].at("position").as_list()[i].as_number(),
                plan.task.scan->views[k].position[static_cast<Eigen::Index>(i)]);
  EXPECT_EQ(blob(address, world.at("scan").at("surface")),
            read_file(folder_ / "flown/prediction.ply"));
  // Within a tenth of what was estimated.
  const auto near = [](const Value& said, double is) {
    EXPECT_NEAR(said.as_number(), is, 0.1 * is);
  };
  std::set<std::vector<double>> places;
  for (const PlannedView& view : plan.task.scan->views)
    places.insert({view.position.x(), view.position.y(), view.position.z(), view.yaw, view.pitch});
  near(estimate.at("images"), static_cast<double>(places.size()));
  near(estimate.at("seconds"), plan.trajectory.duration());
  near(estimate.at("seen"), world.at("scan").at("areas").at("seen").as_number());
}

// A zone, a region and a start that are dragged are estimated on the views of the plan before.
// Where a region was never seen, and where a place cannot be, that is said in words.
TEST_F(StudioKinds, ZonesRegionsAndStartsAreEstimatedWhileTheyAreDragged) {
  use("scan/church.lua");
  const std::vector<std::string> options{"--config", "scan/small", "--set", "resolution=1"};
  const StudioAddress address = serve(options);
  PageClient page(address, "a");
  told(page);
  int edit = 0;
  const auto estimate = [&](const std::string& patch) {
    page.send_text(R"({"type": "preview", "edit": )" + std::to_string(++edit) + R"(, "patch": [)" +
                   patch + "]}");
    return page.until([&](const Value& m) {
      return m.at("type") == Value("estimate") && m.at("edit") == Value(std::int64_t{edit});
    });
  };
  const auto region = [](const std::string& corners) {
    return R"({"path": "regions", "value": [{"name": "site", "from": -0.3, "to": 46, "corners": )" +
           corners + "}]}";
  };
  const Value zone = estimate(R"({"path": "no_fly_zones", "value": [
      {"name": "tower", "corners": [22, -10, 45, -10, 45, 20, 22, 20]}]})");
  const Value moved = estimate(region("[-14, -28, 26, -28, 26, 36, -14, 36]"));
  const Value start = estimate(R"({"path": "start", "value": [-30, -20, 52]})");
  for (const Value& told : {zone, moved, start}) {
    ASSERT_NE(told.find("images"), nullptr) << to_json(told);
    EXPECT_GT(told.at("images").as_integer(), 5);
    EXPECT_LE(told.at("seconds").as_number(), 300);
    EXPECT_GT(told.at("seconds").as_number(), 240);
    EXPECT_GT(told.at("seen").as_number(), 0);
    EXPECT_LT(told.at("seen").as_number(), told.at("known").as_number());
  }
  EXPECT_EQ(zone.at("changed"), Value(true));
  // A second battery needs no other views.
  const Value two = estimate(R"({"path": "batteries", "value": 2})");
  EXPECT_EQ(two.at("tours"), Value(std::int64_t{2}));
  EXPECT_EQ(two.at("changed"), Value(false));
  const Value far = estimate(region("[400, -33, 440, -33, 440, 31, 400, 31]"));
  EXPECT_EQ(far.find("images"), nullptr);
  EXPECT_NE(far.at("why").as_text().find("shows nothing of 100 %"), std::string::npos);
  const Value closed = estimate(R"({"path": "no_fly_zones", "value": [
      {"name": "all", "corners": [-90, -90, 90, -90, 90, 90, -90, 90]}]})");
  EXPECT_NE(closed.at("why").as_text().find("forbid all 40 images"), std::string::npos);
  // Within a tenth of the images and the seconds that the run plans.
  std::vector<std::string> words{"run",   script_.string(),      "-o", "flown", "--json",
                                 "--set", "start=[-30, -20, 52]"};
  words.insert(words.end(), options.begin(), options.end());
  EXPECT_EQ(run(words), 0) << errors_;
  const Plan plan = read_plan(folder_ / "flown/plan.json");
  const double seconds = plan.trajectory.duration();
  const auto images = static_cast<double>(plan.task.scan->views.size());
  EXPECT_NEAR(start.at("seconds").as_number(), seconds, 0.1 * seconds);
  EXPECT_NEAR(start.at("images").as_number(), images, 0.1 * images);
}

// A file that the mission reads changes: nothing of the plan before is kept.
TEST_F(StudioKinds, ViewsOfThePlanBeforeGoWithTheFilesThatTheyAreOf) {
  fs::create_directories(folder_ / "scene");
  const auto write_scene = [&](const char* height) {
    write_file_atomically(folder_ / "scene/hut.lua", std::string(R"(
return function(options)
  local scene = lapwing.scene { name = "hut", seed = options.seed }
  scene:quad({-30, -30, 0}, {30, -30, 0}, {30, 30, 0}, {-30, 30, 0})
  scene:box({-4, -3, 0}, {4, 3, )") + height + R"(})
  scene:region({-6, -5, -0.4}, {6, 5, 7})
  return scene
end
)");
  };
  write_scene("4");
  script_ = "hut.lua";
  write_file_atomically(folder_ / script_, R"(
return require("mission.scan").of_scene {
  name = "hut", scene = "hut", resolution = 0.5, range = 30, reach = 8,
  tour = { budget = 60, iterations = 60 }, usable = { range = 30 },
  camera = { width = 80, height = 60, focal = 46 }, safe_height = 9,
  surface = { spacing = 0.8, cell = 1, trim = 2 },
  candidates = { most = 60, step = 2.5, distance_apart = 2 },
  motions = { alpha = 0.3, coarse = 40 },
}
)");
  const StudioAddress address = serve();
  PageClient page(address, "a");
  const Value low = told(page).first.at("scan").at("areas");
  // An edit on the same views, which does not read the scene's file again.
  page.send_text(R"({"type": "gesture", "id": "g", "label": "budget", "base": 0,
                     "patch": [{"path": "tour.budget", "value": 70}]})");
  page.until([](const Value& m) {
    return m.at("type") == Value("answer") && m.at("revision") == Value(std::int64_t{1}) &&
           m.at("grade") == Value("certified");
  });
  write_scene("6");
  Value areas;
  page.until([&](const Value& m) {
    if (m.at("type") == Value("world")) areas = m.at("scan").at("areas");
    return !areas.is_null() && m.at("type") == Value("answer") &&
           m.at("grade") == Value("certified") && areas.at("known") != low.at("known");
  });
  EXPECT_GT(areas.at("known").as_number(), low.at("known").as_number());
}

// Two batteries: two tours, each with its certificate, and the fleet's over both; each can be flown
// and exported, and the report is that of the fleet.
TEST_F(StudioKinds, AScanOfTwoBatteriesTellsBothTours) {
  use("scan/church.lua");
  const std::vector<std::string> options{"--config", "scan/small",     "--set", "resolution=1",
                                         "--set",    "tour.budget=90", "--set", "batteries=2"};
  const StudioAddress address = serve(options);
  PageClient page(address, "a");
  const auto [world, answer] = told(page);
  const Value::List& tours = answer.at("tours").as_list();
  ASSERT_EQ(tours.size(), 2u);
  EXPECT_EQ(tours[0].at("name"), Value("drone 1, battery 1"));
  EXPECT_TRUE(tours[0].at("plan").is_null());  // it is the answer's
  const double first = answer.at("plan").at("duration").as_number();
  EXPECT_GE(tours[1].at("start").as_number(), first);  // one drone
  EXPECT_GT(tours[1].at("plan").at("duration").as_number(), 0);
  for (const Value& tour : tours) EXPECT_EQ(tour.at("certificate").at("passed"), Value(true));
  const auto has_check = [](const Value& certificate, const char* name) {
    for (const Value& check : certificate.at("checks").as_list())
      if (check.at("name") == Value(name)) return true;
    return false;
  };
  EXPECT_TRUE(has_check(answer.at("certificate"), "sequence"));
  EXPECT_FALSE(has_check(tours[1].at("certificate"), "sequence"));
  std::set<std::int64_t> of;
  for (const Value& view : world.at("scan").at("views").as_list())
    of.insert(view.at("tour").as_integer());
  EXPECT_EQ(of, (std::set<std::int64_t>{0, 1}));
  const auto asked = [&](const std::string& text) {
    page.send_text(text);
    return page.until([](const Value& m) {
      return m.at("type") == Value("wrote") || m.at("type") == Value("failed") ||
             m.at("type") == Value("picture");
    });
  };
  const std::string picture =
      R"({"type": "picture", "edit": 1, "time": 10, "width": 64, "height": 36)";
  const Value one = asked(picture + "}"), two = asked(picture + R"(, "tour": 1})"),
              none = asked(picture + R"(, "tour": 2})");
  EXPECT_NE(one.at("blob"), two.at("blob"));
  EXPECT_EQ(none.at("type"), Value("failed"));
  const Value csv = asked(R"({"type": "export", "id": "x", "format": "csv", "tour": 1})");
  ASSERT_EQ(csv.at("type"), Value("wrote")) << to_json(csv);
  const Value report = asked(R"({"type": "save_report", "id": "r"})");
  ASSERT_EQ(report.at("type"), Value("wrote")) << to_json(report);
  EXPECT_TRUE(report.at("loss").as_list().empty()) << to_json(report);
  const fs::path folder = fs::path(report.at("files").as_list().at(0).as_text()).parent_path();
  EXPECT_TRUE(fs::exists(folder / "fleet.json"));
  EXPECT_EQ(read_file(csv.at("files").as_list().at(0).as_text()),
            read_file(folder / "trajectory_2.csv"));
}

TEST_F(StudioKinds, AnExplorationTellsHowItsMapGrew) {
  use("explore/city.lua");
  const StudioAddress address = serve({"--set", "steps=6"});
  PageClient page(address, "a");
  const auto [world, answer] = told(page);
  const Value& told = world.at("exploration");
  const Value::List& images = told.at("images").as_list();
  ASSERT_EQ(images.size(), 6u);
  for (std::size_t i = 1; i < images.size(); ++i) {
    EXPECT_GT(images[i].at("time").as_number(), images[i - 1].at("time").as_number());
    EXPECT_GE(images[i].at("observed").as_number(), images[i - 1].at("observed").as_number());
  }
  EXPECT_FALSE(told.at("candidates").as_list().empty());
  const std::string bytes = blob(address, told.at("growth"));
  ASSERT_EQ(bytes.substr(0, 4), "WLG1");
  std::uint32_t count = 0, before = 1;
  float edge = 0;
  std::memcpy(&count, bytes.data() + 4, sizeof count);
  std::memcpy(&edge, bytes.data() + 8, sizeof edge);
  EXPECT_FLOAT_EQ(edge, static_cast<float>(told.at("resolution").as_number()));
  ASSERT_EQ(bytes.size(), 12 + 16 * std::size_t{count});
  // By image, each in the middle of a voxel; the last image found some.
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t image = 0;
    float middle[3];
    std::memcpy(middle, bytes.data() + 12 + 16 * i, sizeof middle);
    std::memcpy(&image, bytes.data() + 24 + 16 * i, sizeof image);
    ASSERT_GE(image, before);
    ASSERT_LE(image, images.size());
    for (const float m : middle) {
      const float at = m / edge - 0.5f;
      ASSERT_NEAR(at, std::round(at), 1e-2);
    }
    before = image;
  }
  EXPECT_EQ(before, images.size());
  EXPECT_EQ(picture(page, 1).at("type"), Value("picture"));
  // As many as the map of the run has.
  EXPECT_EQ(run({"run", script_.string(), "-o", "flown", "--set", "steps=6"}), 0) << errors_;
  const Started info(folder_, {"map", "info", "flown/map.ot", "--json"});
  std::string text;
  for (std::string line = info.line(); !line.empty(); line = info.line()) text += line;
  EXPECT_EQ(from_json(text, "map info").at("occupied"), Value(std::int64_t{count}));
}

// Image by image while it is planned: it waits and takes one more; a newer edit ends it. Then the
// folder of its run, without planning; one of another version is refused.
TEST_F(StudioKinds, AnExplorationIsSteppedThroughAndOpenedFromItsFolder) {
  use("explore/city.lua");
  const StudioAddress address = serve({"--set", "steps=6"});
  PageClient page(address, "a");
  const auto [world, answer] = told(page);
  const Value images = world.at("exploration").at("images");
  // --set was the first edit.
  const Value first = plan_paused(page, 400);
  EXPECT_EQ(first.at("asked"), Value(400));
  EXPECT_EQ(blob(address, first.at("sights")).substr(0, 4), "WLE1");
  // The figures of the finished one.
  const auto expect_finished = [&](const Value& image) {
    const auto at = static_cast<std::size_t>(image.at("image").as_integer() - 1);
    for (const char* key : {"time", "value", "observed", "yaw"})
      EXPECT_EQ(image.at(key), images.as_list().at(at).at(key)) << key;
  };
  expect_finished(first);
  constexpr std::chrono::milliseconds kManyImages{1500};
  for (Value m = page.receive(kManyImages); !m.is_null(); m = page.receive(kManyImages))
    EXPECT_NE(m.at("type"), Value("image")) << to_json(m);
  const auto paced = [&](const std::string& pace) {
    EXPECT_TRUE(page.send_text(R"({"type": "pace", "pace": ")" + pace + R"("})"));
    return page.until_type("image");
  };
  for (const auto& [pace, next] : {std::pair("step", 2), {"step", 3}, {"run", 4}}) {
    const Value image = paced(pace);
    EXPECT_EQ(image.at("image"), Value(next));
    expect_finished(image);
  }
  EXPECT_EQ(page.until_type("image").at("image"), Value(5)) << "it goes on";
  ASSERT_TRUE(page.send_text(R"({"type": "undo", "id": "u", "base": 2})"));
  page.until_judged(3);
  EXPECT_EQ(run({"run", script_.string(), "--set", "steps=6"}), 0) << errors_;
  ASSERT_TRUE(page.send_text(R"({"type": "list_runs", "id": "l"})"));
  const Value::List folders = page.until_type("runs").at("folders").as_list();
  ASSERT_EQ(folders.size(), 1u);
  EXPECT_EQ(folders[0], Value("explore_city"));
  const std::string open = R"({"type": "open_run", "id": "o", "folder": "explore_city"})";
  ASSERT_TRUE(page.send_text(open));
  const Value shown = page.until_type("run");
  EXPECT_EQ(shown.at("exploration").at("images"), images);
  EXPECT_EQ(shown.at("certificate").at("passed"), Value(true));
  EXPECT_EQ(blob(address, shown.at("exploration").at("growth")).substr(0, 4), "WLG1");
  const fs::path file = folder_ / "out/explore_city/episode.json";
  std::string text = read_file(file);
  const std::size_t version = text.find("\"lapwing ") + 9;
  write_file_atomically(file, text.replace(version, text.find('"', version) - version, "0.0.1"));
  ASSERT_TRUE(page.send_text(open));
  const std::string why = page.until_type("failed").at("why").as_text();
  EXPECT_NE(why.find("written by lapwing 0.0.1"), std::string::npos) << why;
  EXPECT_NE(why.find("this is lapwing "), std::string::npos) << why;
}

// Many flights with errors: the first is that of its seed, and each has a way.
TEST_F(StudioKinds, APlanIsFlownManyTimes) {
  use("racing/round_course.lua");
  const StudioAddress address = serve();
  PageClient page(address, "a");
  const Value answer = told(page).second;
  const auto flown = [&](const std::string& more) {
    page.send_text(R"({"type": "fly", "edit": 1, "wind": [0, 0, 0], "seed": 3)" + more + "}");
    return page.until([](const Value& m) {
      return m.at("type") == Value("flown") || m.at("type") == Value("failed");
    });
  };
  const Value many = flown(R"(, "runs": 12, "mass": 0.03)");
  ASSERT_EQ(many.at("type"), Value("flown")) << to_json(many);
  const Value& runs = many.at("runs");
  EXPECT_EQ(runs.at("count"), Value(std::int64_t{12}));
  EXPECT_GT(runs.at("most").as_number(), runs.at("median").as_number());
  ASSERT_EQ(many.at("ways").as_list().size(), 12u);
  const double duration = answer.at("plan").at("duration").as_number();
  std::set<std::string> ways;
  for (const Value& way : many.at("ways").as_list()) {
    EXPECT_NEAR(static_cast<double>(way.as_list().size()) / 3, duration * 10, 15);
    ways.insert(to_json(way, -1));
  }
  EXPECT_EQ(ways.size(), 12u);  // no two masses are equal
  // The same again; one alone has no ways.
  EXPECT_EQ(flown(R"(, "runs": 12, "mass": 0.03)"), many);
  EXPECT_EQ(flown("").find("ways"), nullptr);
  EXPECT_EQ(flown(R"(, "runs": 1.5)").find("samples"), nullptr);
}

// Two players fly it, one on the straight way and one aside; of the logs that are left `lapwing
// race` says the same.
TEST_F(StudioKinds, ARaceIsFlownByHandAndAgainFromItsLogs) {
  use("racing/round_course.lua");
  const StudioAddress address = serve();
  PageClient page(address, "a");
  told(page);
  const auto raced = [&](const std::string& text) {
    page.send_text(text);
    return page.until([](const Value& m) {
      return m.at("type") == Value("raced") || m.at("type") == Value("failed");
    });
  };
  const std::string players =
      R"({"type": "race", "id": "g", "players": [{"name": "Anna", "weight": 0.3},
          {"name": "Ben", "speed": 0.8}, {"name": "Plan", "weight": 0, "by_hand": false}]})";
  EXPECT_EQ(
      raced(R"({"type": "race", "id": "x", "players": [{"name": "A", "speed": 9}]})").at("type"),
      Value("failed"));
  EXPECT_EQ(raced(R"({"type": "stick", "id": "x", "time": 0.1, "sticks": [[0, 0]]})").at("type"),
            Value("failed"));
  Value state = raced(players);
  ASSERT_EQ(state.at("type"), Value("raced")) << to_json(state);
  EXPECT_EQ(state.at("players").as_list().size(), 3u);
  EXPECT_EQ(state.at("time"), Value(0.0));
  // A stick that comes too late flies nothing.
  EXPECT_EQ(
      raced(R"({"type": "stick", "id": "g", "time": 9, "sticks": [[0, 0], [0, 0]]})").at("type"),
      Value("failed"));
  for (int k = 1; !state.find("result"); ++k) {
    ASSERT_LT(k, 2000);
    state = raced(R"({"type": "stick", "id": "g", "sticks": [[0.2, 0.05], [-0.1, 0]], "time": )" +
                  std::to_string(0.1 * k) + "}");
    ASSERT_EQ(state.at("type"), Value("raced")) << to_json(state);
  }
  const std::string result = state.at("result").as_text();
  EXPECT_NE(result.find("Anna finished"), std::string::npos) << result;
  EXPECT_NE(result.find("Plan finished"), std::string::npos) << result;
  const fs::path plan = state.at("files").as_list().at(0).as_text();
  const std::string words = read_file(plan.parent_path() / "again.sh");
  const std::string command = words.substr(words.find("lapwing race"));
  const std::string again = "cd '" + plan.parent_path().string() + "' && '" + kProgram + "'" +
                            command.substr(7, command.find(" \"$@\"") - 7) + " --json > '" +
                            (folder_ / "again.json").string() + "'";
  EXPECT_LE(WEXITSTATUS(std::system(again.c_str())), 1);
  const Value game = from_json(read_file(folder_ / "again.json"), "again").at("game");
  int compared = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Value& flown = game.at("pilots").as_list()[k];
    const std::string name = state.at("players").as_list()[k].at("name").as_text();
    const std::size_t line = result.find(name + " ");
    const std::string score = result.substr(line, result.find('\n', line) - line);
    if (!flown.find("score")) continue;
    const double said = std::stod(score.substr(score.find("score ") + 6));
    EXPECT_NEAR(flown.at("score").as_number(), said, 0.005 * said) << score;
    ++compared;
  }
  EXPECT_GE(compared, 2);  // who finished
  const Value& last = state.at("players").as_list()[0];
  EXPECT_EQ(last.at("end"), Value("finished"));
  // It is over: who asks again, as after a lost connection, hears the same.
  EXPECT_EQ(raced(R"({"type": "stick", "id": "g", "time": 300, "sticks": [[0, 0], [0, 0]]})"),
            state);
  // Names that files cannot tell apart are names all the same; the same name twice is none.
  EXPECT_EQ(raced(R"({"type": "race", "id": "h", "players": [{"name": "J\u00f6rg"},
                      {"name": "J\u00fcrg"}]})")
                .at("type"),
            Value("raced"));
  EXPECT_EQ(
      raced(R"({"type": "race", "id": "i", "players": [{"name": "A"}, {"name": "A"}]})").at("type"),
      Value("failed"));
}

TEST_F(StudioKinds, ALightPaintingTellsStrokesAndLightsAndIsExposed) {
  use("light_painting/hello.lua");
  const StudioAddress address = serve();
  PageClient page(address, "a");
  const Value plan = told(page).second.at("plan");
  EXPECT_GT(plan.at("strokes").as_list().size(), 5u);  // of five letters
  double end = 0;
  for (const Value& light : plan.at("lights").as_list()) {
    EXPECT_GE(light.at("start").as_number(), end);
    end = light.at("finish").as_number();
    EXPECT_GT(end, light.at("start").as_number());
  }
  // The exposure grows.
  const Value whole = picture(page, 0), half = picture(page, end / 2), all = picture(page, end);
  EXPECT_EQ(whole.at("type"), Value("picture")) << to_json(whole);
  EXPECT_NE(half.at("blob"), all.at("blob"));
  EXPECT_EQ(blob(address, whole.at("blob")).substr(1, 3), "PNG");
}

}  // namespace
}  // namespace lapwing
