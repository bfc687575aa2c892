// SPDX-License-Identifier: Apache-2.0
// litchi and wpml: files by the rules of their makers' documents, and the flight that becomes of
// them. No client of either judged them.
#include <gmock/gmock.h>

#include <regex>
#include <set>
#include <sstream>

#include "framework/export/flown_comparison.h"
#include "framework/verify/certificate.h"
#include "tests/plugins/exporters/placed_plan.h"

namespace lapwing {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

// A certified flight of 30 s along a quarter circle, the camera on its middle.
Plan quarter_circle() {
  Plan plan = placed_plan();
  plan.certificate = Certificate{{{.name = "clearance", .worst = 1, .pass = true}}}.to_value();
  plan.trajectory.samples.clear();
  for (int i = 0; i <= 300; ++i) {
    const double a = i / 300.0 * M_PI / 2;
    Sample s;
    s.time = 0.1 * i;
    s.position = {30 * std::cos(a), 30 * std::sin(a), 10 + i / 100.0};
    s.velocity = {-M_PI / 2 * std::sin(a), M_PI / 2 * std::cos(a), 0.1};
    s.yaw = a + M_PI;
    s.gimbal_pitch = -0.3 - 0.001 * i;
    plan.trajectory.samples.push_back(s);
  }
  return plan;
}

// With images on the way, two of them in one place.
Plan quarter_scan() {
  Plan plan = quarter_circle();
  plan.kind = "scan";
  plan.task.scan.emplace();
  auto& samples = plan.trajectory.samples;
  for (std::size_t i = 101; i < 160; ++i) {  // a rest, in which the camera turns
    samples[i] = samples[100];
    samples[i].time = 0.1 * static_cast<double>(i);
    samples[i].velocity.setZero();
    samples[i].yaw += 0.01 * static_cast<double>(i - 100);
  }
  for (std::size_t i = 160; i <= 300; ++i) {
    const double a = (1.0 / 3 + (static_cast<double>(i) - 160) / 140 * 2 / 3) * M_PI / 2;
    samples[i].position = {30 * std::cos(a), 30 * std::sin(a), samples[100].position.z()};
    samples[i].velocity = {-2.24 * std::sin(a), 2.24 * std::cos(a), 0};
  }
  for (const std::size_t i : {30u, 105u, 155u, 250u})
    plan.task.scan->views.push_back(
        {samples[i].time, samples[i].position, samples[i].yaw, samples[i].gimbal_pitch});
  return plan;
}

// A file of an archive without compression: its size stands 18 bytes into its header, its name 30.
std::string stored_file(const std::string& zip, const std::string& name) {
  const std::size_t at = zip.find("PK\x03\x04");
  for (std::size_t header = at; header != std::string::npos;
       header = zip.find("PK\x03\x04", header + 4))
    if (zip.compare(header + 30, name.size(), name) == 0) {
      std::size_t size = 0;
      for (std::size_t i = 4; i-- > 0;)
        size = 256 * size + static_cast<unsigned char>(zip[header + 18 + i]);
      return zip.substr(header + 30 + name.size(), size);
    }
  return "";
}

// What Litchi's own description of its files rules out; empty for a good file.
std::vector<std::string> litchi_faults(const std::string& text) {
  std::vector<std::string> faults;
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  std::string wanted =
      "latitude,longitude,altitude(m),heading(deg),curvesize(m),rotationdir,gimbalmode,"
      "gimbalpitchangle";
  for (int i = 1; i <= 15; ++i)
    wanted += ",actiontype" + std::to_string(i) + ",actionparam" + std::to_string(i);
  wanted +=
      ",altitudemode,speed(m/s),poi_latitude,poi_longitude,poi_altitude(m),poi_altitudemode,"
      "photo_timeinterval,photo_distinterval";
  if (line != wanted) faults.emplace_back("header");
  int rows = 0;
  for (; std::getline(lines, line); ++rows) {
    std::vector<double> n;
    std::istringstream words(line);
    for (std::string word; std::getline(words, word, ',');) {
      char* end = nullptr;
      n.push_back(std::strtod(word.c_str(), &end));
      if (word.empty() || *end || !std::isfinite(n.back())) faults.push_back("number " + word);
    }
    if (n.size() != 46) {
      faults.emplace_back("columns");
      continue;
    }
    if (std::abs(n[0]) > 90 || std::abs(n[1]) > 180) faults.emplace_back("place");
    if (n[2] < -200 || n[2] > 500) faults.emplace_back("altitude");
    if (n[3] < 0 || n[3] > 360) faults.emplace_back("heading");
    if (n[7] < -90 || n[7] > 30) faults.emplace_back("pitch");
    bool ended = false;
    for (std::size_t i = 8; i < 38; i += 2) {
      if (n[i] < -1 || n[i] > 5) faults.emplace_back("action");
      if (n[i] >= 0 && ended) faults.emplace_back("action after the last");
      ended = ended || n[i] < 0;
      if (n[i] < 0 && n[i + 1] != 0) faults.emplace_back("unused action");
    }
    if (n[39] < 0 || n[39] > 15) faults.emplace_back("speed");
    if (n[44] != -1 || n[45] != -1) faults.emplace_back("interval");
  }
  if (rows < 2 || rows > 99) faults.emplace_back("number of waypoints");
  return faults;
}

// What the documents of WPML rule out.
std::vector<std::string> wpml_faults(const std::string& text, bool executed) {
  std::vector<std::string> faults;
  const auto expect = [&](bool good, const std::string& what) {
    if (!good) faults.push_back(what);
  };
  // Well-formed: every element ends in order, text holds no bare < or &.
  std::vector<std::string> open;
  const std::regex tag("<(/?)([A-Za-z:]+)[^<>]*>");
  for (std::sregex_iterator found(text.begin(), text.end(), tag), end; found != end; ++found) {
    if ((*found)[1].length() == 0)
      open.push_back((*found)[2]);
    else if (!open.empty() && open.back() == (*found)[2])
      open.pop_back();
    else
      faults.push_back("</" + (*found)[2].str() + ">");
  }
  expect(open.empty(), "elements without an end");
  expect(text.find("http://www.opengis.net/kml/2.2") != std::string::npos, "namespace of KML");
  expect(text.find("http://www.dji.com/wpmz/1.0.2") != std::string::npos, "namespace of WPML");
  const auto all = [&](const std::string& name) {
    std::vector<std::string> texts;
    const std::regex element("<wpml:" + name + ">([^<]*)</wpml:" + name + ">");
    for (std::sregex_iterator found(text.begin(), text.end(), element), end; found != end; ++found)
      texts.push_back((*found)[1]);
    return texts;
  };
  const auto among = [&](const std::string& name, const std::vector<std::string>& words,
                         std::size_t least) {
    const auto texts = all(name);
    expect(texts.size() >= least, name + " is missing");
    for (const std::string& word : texts)
      expect(std::count(words.begin(), words.end(), word) == 1, name + " " + word);
  };
  const auto between = [&](const std::string& name, double low, double high) {
    const auto texts = all(name);
    expect(!texts.empty(), name + " is missing");
    for (const std::string& number : texts)
      expect(std::stod(number) >= low && std::stod(number) <= high, name + " " + number);
  };
  among("flyToWaylineMode", {"safely", "pointToPoint"}, 1);
  among("finishAction", {"goHome", "noAction", "autoLand", "gotoFirstWaypoint"}, 1);
  among("exitOnRCLost", {"goContinue", "executeLostAction"}, 1);
  among("executeRCLostAction", {"goBack", "landing", "hover"}, 1);
  among("droneEnumValue", {"60", "67", "77", "89", "91"}, 1);
  if (executed)
    among("executeHeightMode", {"WGS84", "relativeToStartPoint", "realTimeFollowSurface"}, 1);
  among("waypointHeadingMode",
        {"followWayline", "manually", "fixed", "smoothTransition", "towardPOI"}, 2);
  among("waypointTurnMode",
        {"coordinateTurn", "toPointAndStopWithDiscontinuityCurvature",
         "toPointAndStopWithContinuityCurvature", "toPointAndPassWithContinuityCurvature"},
        2);
  among("actionTriggerType",
        {"reachPoint", "betweenAdjacentPoints", "multipleTiming", "multipleDistance"}, 1);
  among("actionActuatorFunc",
        {"takePhoto", "startRecord", "stopRecord", "gimbalRotate", "gimbalEvenlyRotate",
         "rotateYaw", "hover"},
        1);
  between("takeOffSecurityHeight", 1.2, 1500);
  between("globalTransitionalSpeed", 0, 15);
  between("waypointSpeed", 0.01, 15);
  between("waypointHeadingAngle", -180, 180);
  between("executeHeight", -1500, 1500);
  const auto indices = all("index");
  for (std::size_t i = 0; i < indices.size(); ++i)
    expect(indices[i] == std::to_string(i), "index " + indices[i]);
  const auto groups = all("actionGroupId");
  expect(std::set<std::string>(groups.begin(), groups.end()).size() == groups.size(), "groups");
  return faults;
}

std::string waylines_in(const std::string& zip) {
  return stored_file(zip, "wpmz/waylines.wpml");
}

TEST(Routes, FilesAreBuiltAsTheirMakersSay) {
  for (const Plan& plan : {quarter_circle(), quarter_scan()}) {
    EXPECT_THAT(litchi_faults(exporter_named("litchi")->write(plan)), IsEmpty());
    const std::string zip = exporter_named("wpml")->write(plan);
    EXPECT_THAT(wpml_faults(waylines_in(zip), true), IsEmpty());
    EXPECT_THAT(wpml_faults(stored_file(zip, "wpmz/template.kml"), false), IsEmpty());
  }
}

TEST(Routes, EveryRuleHasAFileThatBreaksIt) {
  const std::string csv = exporter_named("litchi")->write(quarter_circle());
  const auto broken = [](std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
  };
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{"altitude(m)", "altitude"},
                                                        {",-1,0", ""},
                                                        {"46.51", "96.51"},
                                                        {",12.00,", ",612.00,"},
                                                        {",270.00,", ",370.00,"},
                                                        {"-17.19", "-97.19"},
                                                        {",2,0.00", ",9,0.00"},
                                                        {",-1,-1\n", ",1,-1\n"},
                                                        {",-1,0", ",-1,3"}})
    EXPECT_THAT(litchi_faults(broken(csv, from, to)), Not(IsEmpty())) << from;
  const std::string kml = waylines_in(exporter_named("wpml")->write(quarter_circle()));
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"</Placemark>", ""},
           {"1.0.2", "9"},
           {"goHome", "home"},
           {">77<", ">78<"},
           {"relativeToStartPoint", "relative"},
           {"smoothTransition", "smooth"},
           {"coordinateTurn", "turn"},
           {"reachPoint", "reach"},
           {"startRecord", "start"},
           {"wpml:index>1<", "wpml:index>7<"},
           {"takeOffSecurityHeight>20.0", "takeOffSecurityHeight>1"},
           {"waypointHeadingAngle>-90", "waypointHeadingAngle>-190"}})
    EXPECT_THAT(wpml_faults(broken(kml, from, to), true), Not(IsEmpty())) << from;
}

TEST(Routes, TheirFlightIsThatOfThePlan) {
  for (const char* format : {"litchi", "wpml"}) {
    const auto exporter = exporter_named(format);
    const Plan film = quarter_circle(), scan = quarter_scan();
    const std::string text = exporter->write(film);
    const FlownComparison compared = compare_flown(film, *exporter->flown(film, text), {});
    EXPECT_LE(compared.across, 0.5) << format;
    EXPECT_LT(std::abs(compared.late), 2);
    EXPECT_LT(compared.camera, 0.1);
    const FlownComparison images =
        compare_flown(scan, *exporter->flown(scan, exporter->write(scan)), {});
    EXPECT_EQ(images.images_missed, 0u) << format;
    EXPECT_LT(images.image_distance, 0.5);
    EXPECT_LT(images.image_angle, 0.06);
    EXPECT_TRUE(says(exporter->losses(film, text), "take-off place, which is at z = -2 m"));
  }
  // It is read from the bytes.
  const auto litchi = exporter_named("litchi");
  std::string moved = litchi->write(quarter_circle());
  moved.replace(moved.find("46.519"), 6, "46.529");
  EXPECT_GT(compare_flown(quarter_circle(), *litchi->flown(quarter_circle(), moved), {}).across,
            100);
}

// Points of a row, or of a placemark: what stands behind a key.
std::vector<double> numbers_after(const std::string& text, const std::string& key) {
  std::vector<double> numbers;
  for (std::size_t at = 0; (at = text.find(key, at)) != std::string::npos; ++at)
    numbers.push_back(std::strtod(text.c_str() + at + key.size(), nullptr));
  return numbers;
}

// Corners that turn little, on lines that are shorter than twice the tolerance.
Plan fine_zigzag() {
  Plan plan = quarter_circle();
  for (std::size_t i = 0; i < plan.trajectory.samples.size(); ++i) {
    Sample& s = plan.trajectory.samples[i];
    const double along = 0.1 * static_cast<double>(i), phase = std::fmod(along, 8);
    s.position = {along, 0.25 * std::abs(phase - 4), 10};
    s.velocity = {1, phase < 4 ? -0.25 : 0.25, 0};
  }
  return plan;
}

TEST(Routes, CurvesFitTheirLines) {
  Value given = with("tolerance", 8);
  given.set("time_tolerance", 0.5);
  given.set("angle_tolerance", 2);
  const Plan plan = fine_zigzag();
  const std::string kml = waylines_in(exporter_named("wpml", given)->write(plan));
  const auto radii = numbers_after(kml, "<wpml:waypointTurnDampingDist>");
  const auto longitudes = numbers_after(kml, "<coordinates>");
  ASSERT_GT(radii.size(), 5u);
  const double metres = 6378137 * M_PI / 180 * std::cos(kLatitude * M_PI / 180);
  double most = 0;
  for (std::size_t k = 1; k < radii.size(); ++k) {  // no line climbs; they lie nearly along x
    const double line = metres * (longitudes[k] - longitudes[k - 1]) * 1.04;
    EXPECT_LE(radii[k - 1] + radii[k], line) << k;
    most = std::max(most, (radii[k - 1] + radii[k]) / line);
  }
  EXPECT_GT(most, 0.5);  // they are as long as their lines allow
  const auto litchi = exporter_named("litchi", given);
  std::string text = litchi->write(plan);
  EXPECT_NO_THROW(litchi->flown(plan, text));
  // The fifth word of the third row.
  std::size_t at = text.find('\n', text.find('\n') + 1) + 1;
  for (int word = 0; word < 4; ++word) at = text.find(',', at) + 1;
  text.replace(at, text.find(',', at) - at, "40");
  try {
    litchi->flown(plan, text);
    ADD_FAILURE() << "curves that meet were flown";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(HasSubstr("points 1 and 2: curves of "),
                                             HasSubstr("40 m on a line of ")));
  }
}

TEST(Routes, HeightsCountFromThePlansHome) {
  Plan plan = quarter_circle();
  plan.home = Home{{60, 0, 4}, std::nullopt, std::nullopt, {}};
  for (const char* format : {"litchi", "wpml"}) {
    const auto exporter = exporter_named(format);
    const std::string text = exporter->write(plan);
    EXPECT_TRUE(says(exporter->losses(plan, text), "at z = 4 m of the plan: from 6 m to 9 m"));
    EXPECT_LE(compare_flown(plan, *exporter->flown(plan, text), {}).across, 0.5);
  }
}

TEST(Routes, RefuseOrSayHeightsBelowTheTakeOffPlace) {
  using testing::AllOf;
  for (const char* format : {"litchi", "wpml"}) {
    const Plan plan = quarter_circle();  // from z = 10 m to 13 m
    EXPECT_THAT(refusal_of(*exporter_named(format, with("home_z", 11)), plan),
                AllOf(HasSubstr("the first waypoint (z = 10 m) is 1 m below the take-off place"),
                      HasSubstr("z = 11 m"), HasSubstr("`home_z`")));
    EXPECT_EQ(refusal_of(*exporter_named(format, with("home_z", 9.9)), plan), "");
    // Later ones may lie lower: beside a hill.
    Plan falling = plan;
    for (Sample& s : falling.trajectory.samples) {
      s.position.z() = 20 - s.position.z();
      s.velocity.z() = -s.velocity.z();
    }
    const auto exporter = exporter_named(format, with("home_z", 9));
    EXPECT_TRUE(says(exporter->losses(falling, exporter->write(falling)),
                     "waypoints are below the take-off place, the lowest by 2 m (at 30 s"));
    // The ground of the origin is at z = -2 m.
    for (Sample& s : falling.trajectory.samples) s.position.z() -= 9.5;
    EXPECT_THAT(refusal_of(*exporter_named(format), falling),
                AllOf(HasSubstr(": waypoint "), HasSubstr("above the ground of the origin")));
  }
}

TEST(Routes, TheClimbKeepsTheLargestHeight) {
  Plan plan = quarter_circle();
  plan.home = Home{{30, 0, -2}, 16, std::nullopt, {}};
  EXPECT_THAT(refusal_of(*exporter_named("wpml"), plan),
              testing::AllOf(HasSubstr("take_off_height=20 m"), HasSubstr("at most 16 m")));
  EXPECT_EQ(refusal_of(*exporter_named("wpml", with("take_off_height", 15)), plan), "");
}

TEST(Routes, RefuseWhatTheyCannotHold) {
  for (const char* format : {"litchi", "wpml"}) {
    const auto exporter = exporter_named(format);
    Plan homeless = quarter_circle();
    homeless.geodetic_origin.reset();
    EXPECT_THAT(refusal_of(*exporter, homeless), HasSubstr("has no origin on the earth"));
    Plan race = quarter_circle();
    race.trajectory.has_gimbal = false;
    EXPECT_THAT(refusal_of(*exporter, race), HasSubstr("without a camera"));
    Plan still = quarter_circle();
    still.trajectory.samples.resize(1);
    EXPECT_THAT(refusal_of(*exporter, still), HasSubstr("has no length"));
    Plan hover = quarter_circle();
    for (Sample& s : hover.trajectory.samples) s.position = {1, 2, 3}, s.velocity.setZero();
    EXPECT_THAT(refusal_of(*exporter, hover), HasSubstr("within 0.5 m"));
    Plan lost = quarter_circle();
    lost.trajectory.samples[9].gimbal_pitch = std::nan("");
    EXPECT_THAT(refusal_of(*exporter, lost), HasSubstr("not finite"));
    Value few = with("most_points", 3);
    few.set("tolerance", 0.05);
    EXPECT_THAT(refusal_of(*exporter_named(format, few), quarter_circle()),
                testing::AllOf(HasSubstr("a file holds 3"), HasSubstr("part=1 to part=")));
    few.set("part", 2);
    const auto part = exporter_named(format, few);
    const auto flown = part->flown(quarter_circle(), part->write(quarter_circle()));
    EXPECT_GT(flown->start, 0);
    EXPECT_LE(compare_flown(quarter_circle(), *flown, {}).across, 0.1);
    Plan high = quarter_circle();
    for (Sample& s : high.trajectory.samples) s.position.z() += 1600;
    EXPECT_THAT(refusal_of(*exporter, high), HasSubstr("the format has"));
  }
  Plan uncertified = quarter_circle();
  uncertified.certificate = Value();
  EXPECT_THAT(refusal_of(*exporter_named("litchi"), uncertified), HasSubstr("no place to say so"));
  EXPECT_THAT(stored_file(exporter_named("wpml")->write(uncertified), "wpmz/template.kml"),
              HasSubstr("Lapwing (not certified)"));
  EXPECT_THROW(exporter_named("wpml", with("drone", "kite")), InputError);
}

}  // namespace
}  // namespace lapwing
