// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/png.h"
#include "framework/export/film_charts.h"
#include "framework/export/film_strip.h"
#include "framework/export/flight_report.h"
#include "tests/export/synthetic_flight.h"

namespace lapwing {
namespace {

constexpr const char* kSignature = "\x89PNG\r\n\x1a\n";

Plan film() {
  Plan plan = synthetic_flight(20, 201, 4);
  add_film(plan);
  return plan;
}

Section camera_of(const Plan& plan) {
  return camera_section(plan, vehicle_from_value(plan.vehicle));
}

const Chart& chart(const Section& section, const std::string& start) {
  for (const Block& block : section.blocks) {
    const auto* c = std::get_if<Chart>(&block);
    if (c && c->title.starts_with(start)) return *c;
  }
  throw Error("no chart " + start);
}

TEST(FilmStrip, TimesAreEvenNearKeyframesAndOutsideCuts) {
  Plan plan = film();
  plan.cuts.clear();
  plan.task.keyframes.resize(2);
  plan.task.keyframes[0].time = 5.2;   // nearest to 5.4545, a third of 1.818 is 0.606
  plan.task.keyframes[1].time = 11.9;  // 0.99 from 10.909, 0.83 from 12.727: near to none
  const std::vector<double> times = strip_times(plan);
  ASSERT_EQ(times.size(), 12u);
  EXPECT_EQ(times.front(), 0);
  EXPECT_NEAR(times.back(), 20, 1e-12);
  EXPECT_EQ(times[3], 5.2);
  EXPECT_NEAR(times[4], 20.0 * 4 / 11, 1e-12);
  EXPECT_NEAR(times[6], 20.0 * 6 / 11, 1e-12);
  plan.cuts = {{5, 8}};
  for (const double time : strip_times(plan)) EXPECT_FALSE(time >= 5 && time <= 8) << time;
  EXPECT_EQ(strip_times(plan).size(), 10u);
  plan.cuts = {{0, 20}};
  EXPECT_TRUE(strip_times(plan).empty());
  EXPECT_EQ(strip_times(film(), 1).size(), 1u);
  EXPECT_TRUE(strip_times(film(), 0).empty());
}

TEST(FilmStrip, FramesCarryTheBoxesOfWhatIsAskedFor) {
  const Plan plan = film();
  const Vehicle vehicle = vehicle_from_value(plan.vehicle);
  const FilmStrip strip = film_strip(plan, vehicle, {4, 16});
  ASSERT_EQ(strip.frames.size(), 2u);
  for (const FilmFrame& frame : strip.frames) {
    EXPECT_TRUE(frame.png.starts_with(kSignature));
    EXPECT_EQ(frame.width, 288);
    EXPECT_EQ(frame.height, 162);
    EXPECT_LT(frame.png.size(), 60000u);
    ASSERT_EQ(frame.boxes.size(), 1u);
  }
  EXPECT_EQ(strip.frames[0].caption, "4 s \u00b7 keyframe 2 \u00b7 tower");
  EXPECT_EQ(strip.frames[1].boxes[0].label, "boat <&>");
  // The box is where the camera of the vehicle itself has it, whatever the frame's size.
  const Sample& s = plan.trajectory.samples[40];
  const Pinhole pinhole = vehicle.camera.pinhole();
  const CameraView view{pinhole, s.position, camera_axes(s.yaw + s.gimbal_yaw, s.gimbal_pitch)};
  const auto box = view.box_of({0.5, -1.5, 6}, 12, 5);
  EXPECT_NEAR(strip.frames[0].boxes[0].left, (box->left + 0.5) / pinhole.width, 1e-9);
  EXPECT_NEAR(strip.frames[0].boxes[0].bottom, (box->bottom + 0.5) / pinhole.height, 1e-9);
}

TEST(FilmStrip, OneFrameHasTheSizeThatIsAskedFor) {
  const Plan plan = film();
  const Vehicle vehicle = vehicle_from_value(plan.vehicle);
  const std::string of_strip = film_strip(plan, vehicle, {4}).frames[0].png;
  EXPECT_TRUE(film_frame(plan, vehicle, 4, 288, 288) == of_strip);
  const std::string png = film_frame(plan, vehicle, 4, 640, 200);  // as many as fit
  const auto number_at = [&png](std::size_t at) {
    return static_cast<unsigned char>(png[at]) * 256 + static_cast<unsigned char>(png[at + 1]);
  };
  EXPECT_EQ(number_at(22), 200);  // of the PNG's header: across, down
  EXPECT_EQ(number_at(18), 356);
  EXPECT_THROW(film_frame(plan, vehicle, -1, 64, 64), InputError);
  EXPECT_THROW(film_frame(plan, vehicle, 20.5, 64, 64), InputError);
}

TEST(FilmStrip, SamePlanSameBytes) {
  const std::string html = render_html(flight_report(film()));
  EXPECT_EQ(render_html(flight_report(film())), html);
  EXPECT_LT(html.size(), 1u << 20);
  EXPECT_NE(html.find("boat &lt;&amp;&gt;"), std::string::npos);
  EXPECT_EQ(html.find("boat <&>"), std::string::npos);
}

// Whatever stands before the camera is in the picture, moving or still; what hides nothing tints
// it.
TEST(FilmStrip, ShowsEveryShape) {
  Plan plan = film();
  plan.environment.obstacles.clear();
  const Vehicle vehicle = vehicle_from_value(plan.vehicle);
  const auto picture = [&] { return film_strip(plan, vehicle, {4}).frames[0].png; };
  const std::string empty = picture();
  const Sample& s = plan.trajectory.samples[40];
  const Eigen::Vector3d ahead =
      s.position + 0.3 * (plan.environment.subjects[0].position(4) - s.position);
  const auto shown = [&](Obstacle obstacle) {
    plan.environment.obstacles = {std::move(obstacle)};
    plan.environment = with_shapes(plan.environment);
    return picture();
  };
  const Obstacle pole = obstacle_at("pole", "capsule",
                                    {{"from", place_value(ahead - Eigen::Vector3d(0, 0, 2))},
                                     {"to", place_value(ahead + Eigen::Vector3d(0, 0, 2))},
                                     {"radius", 0.2}});
  EXPECT_NE(shown(pole), empty);
  EXPECT_NE(shown(obstacle_at("tent", "cone",
                              {{"base", place_value(ahead - Eigen::Vector3d(0, 0, 1))},
                               {"radius", 0.5},
                               {"height", 2.0}})),
            empty);
  EXPECT_NE(shown(zone_at("house", {{ahead.x() - 1, ahead.y() - 1},
                                    {ahead.x() + 1, ahead.y() - 1},
                                    {ahead.x(), ahead.y() + 1}})),
            empty);
  Obstacle moving = pole;
  moving.times = {4, 8};
  moving.moves = {{0, 0, 1e4}, {0, 0, 0}};
  EXPECT_EQ(shown(moving), empty) << "it is elsewhere at that time";
  Obstacle glass = pole;
  glass.opaque = false;
  EXPECT_NE(shown(glass), empty);
  EXPECT_NE(shown(glass), shown(pole));
}

TEST(FilmStrip, HostilePlansStillHaveAReport) {
  Plan plan = film();
  plan.environment.obstacles.push_back(sphere_at("far", {9e5, 0, 0}, 3));
  plan.environment = with_shapes(plan.environment);
  plan.environment.obstacles.push_back(obstacle_at("unknown", "tripod", {}));
  plan.environment.subjects.push_back({"nowhere", {0}, {{0, 0, 1e7}}});
  Vehicle vehicle = vehicle_from_value(plan.vehicle);
  vehicle.camera = {"slit", 1, 10000, 500, 500, 0, 5000};
  plan.vehicle = to_value(vehicle);
  EXPECT_NO_THROW(render_html(flight_report(plan)));
  plan.trajectory.samples.resize(1);
  plan.cuts.clear();
  plan.task.framing.clear();
  plan.task.keyframes.clear();
  EXPECT_NO_THROW(render_html(flight_report(plan)));
}

TEST(FilmCharts, ShowErrorSkewnessAndPlaceWhereAskedFor) {
  const Plan plan = film();
  const Section section = camera_of(plan);
  const Chart& error = chart(section, "Camera error");
  ASSERT_EQ(error.series.size(), 2u);
  EXPECT_EQ(error.series[0].name, "tower");
  EXPECT_NEAR(error.series[0].y[20], degrees(0.1), 1e-6);  // looks 0.1 rad too high
  EXPECT_TRUE(std::isnan(error.series[0].y[95]));          // in the cut
  EXPECT_TRUE(std::isnan(error.series[0].y[150]));         // then the boat is asked for
  EXPECT_TRUE(std::isnan(error.series[1].y[20]));
  EXPECT_NEAR(error.series[1].y[150], degrees(0.1), 1e-6);
  ASSERT_EQ(error.spans.size(), 1u);
  EXPECT_EQ(error.spans[0].from, 9);
  EXPECT_EQ(error.markers.size(), 6u);

  const Sample& s = plan.trajectory.samples[20];
  const Eigen::Vector3d d = Eigen::Vector3d(0.5, -1.5, 6) - s.position;
  const Eigen::Vector3d half(0, 0, d.z() < 0 ? 6 : -6);
  const double expected = (d + half).dot(d) / (d - half).dot(d) - 1;  // (3.9)
  const double shown = chart(section, "Skewness").series[0].y[20];
  EXPECT_NEAR(std::abs(shown), std::abs(expected), 1e-9);
  EXPECT_EQ(shown < 0, d.z() < 0);

  const Chart& up = chart(section, "Subject in the image, from its lower");
  ASSERT_EQ(up.series.size(), 6u);
  EXPECT_EQ(up.series[0].name, "tower top");
  EXPECT_GT(up.series[0].y[20], up.series[1].y[20]);
  EXPECT_GT(up.series[1].y[20], up.series[2].y[20]);
  EXPECT_LT(up.series[1].y[20], 50);  // too high a look puts it below the middle
  const Chart& across = chart(section, "Subject in the image, from its left");
  EXPECT_NEAR(across.series[1].y[20], 50, 0.1);
  EXPECT_GT(across.series[0].y[20], 50);
  EXPECT_LT(across.series[2].y[20], 50);
}

TEST(FilmCharts, WithoutSubjectsThereIsTheGimbalAlone) {
  Plan plan = synthetic_flight(20, 201, 4);
  EXPECT_EQ(camera_of(plan).blocks.size(), 3u);  // strip, angles, rates
  plan.trajectory.has_gimbal = false;
  for (const Section& section : flight_sections(plan)) EXPECT_NE(section.title, "Camera");
}

TEST(Png, RefusesPicturesThatContradictThemselves) {
  EXPECT_TRUE(encode_png({1, 2, {0, 1, 2, 3, 4, 5}}).starts_with(kSignature));
  EXPECT_THROW(encode_png({1, 2, {0, 1, 2}}), Error);
  EXPECT_THROW(encode_png({0, 0, {}}), Error);
}

}  // namespace
}  // namespace lapwing
