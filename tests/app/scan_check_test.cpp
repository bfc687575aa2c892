// SPDX-License-Identifier: Apache-2.0
// lapwing scan check, on photographs and COLMAP models of views that are stated here.
#include <gmock/gmock.h>

#include "framework/core/json.h"
#include "framework/core/random.h"
#include "framework/geometry/depth_camera.h"
#include "framework/photogrammetry/exif_position.h"
#include "framework/photogrammetry/similarity.h"
#include "framework/trajectory/plan.h"
#include "tests/app/program_fixture.h"
#include "tests/gps_photo.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

constexpr GeodeticPoint kOrigin{47.4, 8.5, 450};

class ScanCheck : public CommandLine {
 protected:
  // Eight views on two lines, 12 m apart, that look down at 45 degrees.
  ScanCheck() {
    plan_.mission = "roof";
    plan_.kind = "scan";
    plan_.geodetic_origin = GeodeticOrigin{47.4, 8.5, 450, HeightOf::ellipsoid};
    plan_.vehicle = Value::map();
    plan_.configuration = Value::map();
    plan_.configuration.set("span", 0.1 + 0.2);
    for (const double time : {0., 80.}) {
      Sample sample;
      sample.time = time;
      plan_.trajectory.samples.push_back(sample);
    }
    ScanTask scan;
    scan.region = Eigen::AlignedBox3d{Vector3d(-10, -10, 0), Vector3d(50, 20, 10)};
    scan.camera = {640, 480, 400, 400, 319.5, 239.5};
    scan.map = "known";
    scan.seen = 1;
    for (int k = 0; k < 8; ++k)
      scan.views.push_back({10.0 * (k + 1), Vector3d(12 * (k % 4), 12 * (k / 4), 20 + k % 3),
                            k < 4 ? 0.5 : -2.0, -0.78, ViewKind::planned});
    plan_.task.scan = scan;
    write_plan(plan_, folder_ / "plan.json");
  }

  const std::vector<PlannedView>& views() const { return plan_.task.scan->views; }
  // Photographs IMG_1.jpg, ... of the views but for those, `higher` than the plan has them, each up
  // to half a metre off.
  void take_photos(const std::set<int>& without, double higher) {
    Random random(4);
    fs::create_directories(folder_ / "photos");
    for (int k = 0; k < 8; ++k) {
      const Vector3d off(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), higher);
      if (without.contains(k)) continue;
      const Vector3d at = views()[static_cast<std::size_t>(k)].position + off;
      write("photos/IMG_" + std::to_string(k + 1) + ".jpg", gps_photo(to_geodetic(kOrigin, at)));
    }
  }
  // A model of the same photographs; those that `turned` names look elsewhere.
  void write_model(const Similarity& to_world, const std::set<int>& without,
                   const std::set<int>& turned) {
    std::string images;
    for (int k = 0; k < 8; ++k) {
      if (without.contains(k)) continue;
      const PlannedView& view = views()[static_cast<std::size_t>(k)];
      const Pose pose =
          camera_pose(view.position, view.yaw + (turned.contains(k) ? 1 : 0), view.pitch);
      const Eigen::Quaterniond q = (to_world.rotation.conjugate() * pose.orientation).conjugate();
      const Vector3d t = -(q * to_world.inverse(pose.position));
      char line[300];
      std::snprintf(line, sizeof line, "%d %.15g %.15g %.15g %.15g %.15g %.15g %.15g 1 IMG_%d.jpg",
                    k + 1, q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z(), k + 1);
      images += std::string(line) + "\n\n";
    }
    fs::create_directories(folder_ / "model");
    write("model/cameras.txt", "1 PINHOLE 640 480 400 400 320 240\n");
    write("model/images.txt", images);
    write("model/points3D.txt", "");
  }
  Value checked(std::vector<std::string> more, int status) {
    more.insert(more.begin(), {"scan", "check"});
    more.insert(more.end(), {"--plan", "plan.json", "--json"});
    const Finished finished = run(more);
    EXPECT_EQ(finished.status, status) << finished.err;
    return from_json(finished.out, "answer");
  }
  static std::vector<int> missing(const Value& answer) {
    std::vector<int> views;
    for (const Value& view : answer.at("missing").as_list())
      views.push_back(static_cast<int>(view.as_integer()));
    return views;
  }

  Plan plan_;
};

TEST_F(ScanCheck, PhotographsByTheirPositions) {
  if (!reads_exif()) GTEST_SKIP() << "libexif-dev is not installed";
  take_photos({2, 3, 6}, 46.2);
  write("photos/IMG_0.jpg", gps_photo(to_geodetic(kOrigin, {100, 100, 50})));
  const Value answer = checked({"photos", "-o", "rest.lua"}, 1);
  EXPECT_EQ(missing(answer), (std::vector<int>{3, 4, 7}));
  ASSERT_EQ(answer.at("of_no_view").as_list().size(), 1u);
  EXPECT_EQ(answer.at("of_no_view").as_list()[0].as_text(), "IMG_0.jpg");
  EXPECT_NEAR(answer.at("height_offset").as_number(), 46.2, 0.01);
  EXPECT_LT(answer.at("farthest").as_number(), 0.43);
  for (const Value& pair : answer.at("pairs").as_list())
    EXPECT_EQ(pair.at("photograph").as_text(),
              "IMG_" + std::to_string(pair.at("view").as_integer()) + ".jpg");
  const std::string rest = read_file(folder_ / "rest.lua");
  EXPECT_THAT(rest, HasSubstr("name = \"roof rest\""));
  EXPECT_THAT(rest, HasSubstr("position = { 24, 0, 22 }, yaw_deg = 28.64788975654116,"));
  // Numbers read back as they were.
  EXPECT_THAT(rest, HasSubstr("span = 0.30000000000000004"));
  for (const char* view : {"-- view 3\n", "-- view 4\n", "-- view 7\n"})
    EXPECT_THAT(rest, HasSubstr(view));
  EXPECT_THAT(rest, testing::Not(HasSubstr("-- view 1\n")));
  // With the offset said to be none, no photograph is near a view.
  EXPECT_EQ(missing(checked({"photos", "--height-offset", "0"}, 1)).size(), 8u);
}

TEST_F(ScanCheck, AllViewsArePhotographed) {
  if (!reads_exif()) GTEST_SKIP() << "libexif-dev is not installed";
  take_photos({}, 0);
  const Value answer = checked({"photos", "-o", "rest.lua"}, 0);
  EXPECT_TRUE(missing(answer).empty());
  EXPECT_FALSE(fs::exists(folder_ / "rest.lua"));
  const Finished finished = run({"scan", "check", "photos", "--plan", "plan.json"});
  EXPECT_THAT(finished.out, HasSubstr("roof: 8 of 8 views are photographed"));
}

TEST_F(ScanCheck, ModelsTellDirections) {
  Similarity to_world;
  write_model(to_world, {1}, {5});
  const Value placed = checked({"model", "--placed"}, 1);
  EXPECT_EQ(missing(placed), (std::vector<int>{2, 6}));
  EXPECT_LT(placed.at("farthest").as_number(), 1e-6);
  EXPECT_EQ(missing(checked({"model", "--placed", "--angle", "70"}, 1)), (std::vector<int>{2}));
  if (!reads_exif()) GTEST_SKIP() << "libexif-dev is not installed";
  to_world.scale = 7.5;
  to_world.rotation = Eigen::Quaterniond(0.4, -0.3, 0.8, 0.2).normalized();
  to_world.translation = Vector3d(3, -40, 12);
  write_model(to_world, {1}, {5});
  take_photos({1}, -31.5);
  const Value answer = checked({"model", "--photos", "photos"}, 1);
  EXPECT_EQ(missing(answer), (std::vector<int>{2, 6}));
  EXPECT_NEAR(answer.at("height_offset").as_number(), -31.5, 0.3);
}

TEST_F(ScanCheck, ViewsOfOnePlaceAreUncertainByPositions) {
  if (!reads_exif()) GTEST_SKIP() << "libexif-dev is not installed";
  plan_.task.scan->views[2].position = plan_.task.scan->views[1].position + Vector3d(0, 1, 0);
  write_plan(plan_, folder_ / "plan.json");
  take_photos({2, 6}, 0);
  const Value answer = checked({"photos", "-o", "rest.lua"}, 1);
  const std::vector<int> gone = missing(answer);
  ASSERT_EQ(gone.size(), 2u);
  EXPECT_TRUE(gone[0] == 2 || gone[0] == 3);
  EXPECT_EQ(gone[1], 7);
  ASSERT_EQ(answer.at("uncertain").as_list().size(), 1u);
  EXPECT_EQ(answer.at("uncertain").as_list()[0].as_integer(), 5 - gone[0]);
  const std::string rest = read_file(folder_ / "rest.lua");
  for (const char* view : {"-- view 2\n", "-- view 3\n", "-- view 7\n"})
    EXPECT_THAT(rest, HasSubstr(view));
  // Models tell them apart.
  write_model({}, {1, 6}, {});
  EXPECT_TRUE(checked({"model", "--placed"}, 1).at("uncertain").as_list().empty());
}

TEST_F(ScanCheck, BadInputIsRefused) {
  write_model({}, {}, {});
  refused({"scan", "check", "model", "--plan", "plan.json"}, {"no scale and place", "--photos"});
  refused({"scan", "check", "model", "--plan", "absent.json"}, {"absent.json"});
  refused({"scan", "check", "model", "--plan", "plan.json", "--placed", "--within", "0"},
          {"--within", "above 0"});
  refused({"scan", "check", "absent", "--plan", "plan.json"}, {"'absent' cannot be listed"});
  fs::create_directories(folder_ / "empty");
  refused({"scan", "check", "empty", "--plan", "plan.json"}, {"holds no photograph"});
  Plan other = plan_;
  other.task.scan.reset();
  other.kind = "film";
  write_plan(other, folder_ / "film.json");
  refused({"scan", "check", "model", "--plan", "film.json", "--placed"},
          {"'film.json' is a plan of a film", "expected that of a scan"});
  if (!reads_exif()) GTEST_SKIP() << "libexif-dev is not installed";
  take_photos({0, 1, 2, 3, 4, 5}, 0);
  refused({"scan", "check", "model", "--plan", "plan.json", "--photos", "photos"},
          {"'photos': 2 of the model's 8 images", "3 are needed"});
  write("empty/a.jpg", "\xff\xd8\xff\xd9");
  refused({"scan", "check", "empty", "--plan", "plan.json", "-o", "rest.lua"},
          {"none of its 1 photographs states a GPS position"});
  other = plan_;
  other.geodetic_origin.reset();
  write_plan(other, folder_ / "nowhere.json");
  refused({"scan", "check", "photos", "--plan", "nowhere.json"},
          {"'nowhere.json' has no origin on the earth", "`origin`"});
}

}  // namespace
}  // namespace lapwing
