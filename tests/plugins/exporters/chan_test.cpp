// SPDX-License-Identifier: Apache-2.0
// What a compositing program makes of the lines, by code of its own: the pixel in which a point of
// the world lies.
#include <gtest/gtest.h>

#include <sstream>

#include "framework/core/error.h"
#include "framework/export/film_view.h"
#include "framework/trajectory/interpolate.h"
#include "tests/plugins/exporters/planned_camera.h"

namespace lapwing {
namespace {

std::vector<std::vector<double>> chan_lines(const std::string& text) {
  std::vector<std::vector<double>> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream words(line);
    lines.emplace_back();
    for (double number; words >> number;) lines.back().push_back(number);
  }
  return lines;
}

// Rows of the rotation matrix Ry Rx written out; y up, looking along -z; square pixels.
Eigen::Vector2d chan_pixel(const std::vector<double>& f, const Eigen::Vector3d& world,
                           const Pinhole& camera) {
  const double x = f[4] * M_PI / 180, y = f[5] * M_PI / 180;
  const double cx = std::cos(x), sx = std::sin(x), cy = std::cos(y), sy = std::sin(y);
  const Eigen::Vector3d d(world.x() - f[1], world.z() - f[2], -world.y() - f[3]);
  const double right = cy * d.x() - sy * d.z();
  const double up = sy * sx * d.x() + cx * d.y() + cy * sx * d.z();
  const double back = sy * cx * d.x() - sx * d.y() + cy * cx * d.z();
  const double scale = camera.height / 2.0 / std::tan(f[7] * M_PI / 360);
  return {camera.width / 2.0 - 0.5 + scale * right / -back,
          camera.height / 2.0 - 0.5 - scale * up / -back};
}

TEST(Chan, PointsFallWhereThePlansCameraSeesThem) {
  const Plan plan = planned_camera();
  const Pinhole camera = filming_drone().camera.pinhole();
  const auto frames = chan_lines(exporter_named("chan", with_frame_rate(25))->write(plan));
  ASSERT_EQ(frames.size(), 51u);  // 2.03 s
  for (std::size_t i = 0; i < frames.size(); ++i) {
    ASSERT_EQ(frames[i].size(), 8u);
    EXPECT_EQ(frames[i][0], static_cast<double>(i + 1));
    EXPECT_EQ(frames[i][6], 0);
    const CameraView view = view_of(sample_at(plan.trajectory, i / 25.0), camera);
    for (const double x : {10.0, 300.0})
      for (const double y : {20.0, 200.0}) {
        const Eigen::Vector2d pixel =
            chan_pixel(frames[i], view.position + 7 * view.ray(x, y), camera);
        EXPECT_NEAR(pixel.x(), x, 1e-6);
        EXPECT_NEAR(pixel.y(), y, 1e-6);
      }
  }
}

TEST(Chan, StatesWhatLiesBetweenAndAfterItsFrames) {
  Plan plan = planned_camera();
  const auto chan = exporter_named("chan", with_frame_rate(10));
  const auto said = chan->losses(plan, chan->write(plan));
  // The sagitta of a chord of 0.1 rad on a circle of 10 m is 12.5 mm.
  EXPECT_TRUE(says(said, "at most 12.5 mm")) << said[1];
  EXPECT_TRUE(says(said, "the last 0.03 s"));
  EXPECT_FALSE(says(said, "cuts"));
  plan.cuts = {{0.5, 0.7}};
  EXPECT_TRUE(says(chan->losses(plan, chan->write(plan)), "cuts are not marked"));
  // A file that was changed is seen to be far away: the loss is read from its bytes.
  std::string text = chan->write(plan);
  const std::size_t tab = text.find('\t', text.find("\n5\t") + 1);
  text.insert(tab + 1, "1");
  EXPECT_FALSE(says(chan->losses(plan, text), "at most 12.5 mm"));
}

TEST(Chan, SaysThatAPlanIsNotCertified) {
  Plan plan = planned_camera();
  EXPECT_EQ(exporter_named("chan")->write(plan).rfind("# not certified\n1\t", 0), 0u);
  plan.certificate = Value::map();
  plan.certificate.set("feasible", true);
  EXPECT_EQ(exporter_named("chan")->write(plan).rfind("1\t", 0), 0u);
}

TEST(Chan, RefusesWhatItCannotHold) {
  for (const double rate : {0.0, -24.0, 1e9})
    EXPECT_THROW(exporter_named("chan", with_frame_rate(rate)), InputError);
  Plan race = planned_camera();
  race.kind = "race";
  race.trajectory.has_gimbal = false;
  try {
    exporter_named("chan")->write(race);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("kind race without a camera"), std::string::npos);
  }
  Plan none = planned_camera();
  none.trajectory.samples.clear();
  EXPECT_THROW(exporter_named("chan")->write(none), InputError);
  Plan still = planned_camera();
  still.trajectory.samples.resize(1);
  const auto chan = exporter_named("chan");
  EXPECT_EQ(chan_lines(chan->write(still)).size(), 1u);
  EXPECT_TRUE(says(chan->losses(still, chan->write(still)), "1 frames"));
  Plan endless = planned_camera();
  endless.trajectory.samples.back().time = 1e7;
  EXPECT_THROW(chan->write(endless), InputError);
}

}  // namespace
}  // namespace lapwing
