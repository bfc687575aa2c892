// SPDX-License-Identifier: Apache-2.0
// Races through the program, and courses to fly.
#pragma once

#include "framework/core/random.h"
#include "tests/missions/flown_film.h"

namespace lapwing {

inline constexpr const char* kPoint =
    "vehicle = { mass = 1, inertia = {0.01, 0.01, 0.02}, yaw_share = 0.01, flight_time = 600,\n"
    "  rotors = { thrust = {0, 8.62312}, torque_coefficient = 0.02, arm_length = 0.2 },\n"
    "  limits = { speed_across = 60, climb_speed = 60, descent_speed = 60,\n"
    "             acceleration_across = 60, yaw_rate_deg = 180 },\n"
    "  camera = 'cameras/racing' },";

class Race : public Filming {
 protected:
  Flown race(const std::string& text, const std::string& more = "") {
    write_file_atomically(folder_ / "course.lua",
                          "return require 'mission.race'.course { name = 'course', " + text + " }");
    return fly((folder_ / "course.lua").string(), more);
  }
  std::string refused(const std::string& text) {
    write_file_atomically(folder_ / "course.lua",
                          "return require 'mission.race'.course { name = 'course', " + text + " }");
    const std::string command = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing run '" +
                                (folder_ / "course.lua").string() + "' --out '" +
                                (folder_ / "none").string() + "' > /dev/null 2> '" +
                                (folder_ / "stderr.txt").string() + "'";
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 2) << text;
    EXPECT_FALSE(fs::exists(folder_ / "none")) << text;
    return read_file(folder_ / "stderr.txt");
  }
  // In time, and no faster and no harder than kGentle allows.
  static void expect_within_limits(const Flown& flown) {
    expect_certified(flown);
    EXPECT_LE(time_of(flown), 464);
    for (const Sample& s : read_plan(flown.folder / "plan.json").trajectory.samples) {
      EXPECT_LE(s.velocity.norm(), 3.001);
      EXPECT_LE(s.acceleration.norm(), 5.001);
    }
  }
  static void expect_flown_by_rotors(const Flown& flown, std::size_t gates) {
    expect_certified(flown);
    const Plan plan = read_plan(flown.folder / "plan.json");
    EXPECT_EQ(plan.trajectory.motion.name, "rotors");
    EXPECT_EQ(plan.task.gates.size(), gates);
    EXPECT_NE(read_file(flown.folder / "report.html").find("Rotor thrusts"), std::string::npos);
  }
  static double time_of(const Flown& flown) {
    return flown.result.at("race").at("time").as_number();
  }
  static double solve_seconds(const Flown& flown) {
    return flown.result.at("seconds").at("solve").as_number();
  }
  static bool has_tracks() {
    const char* folder = std::getenv("LAPWING_DATA");
    return folder && fs::exists(fs::path(folder) / "tracks/seven_gates.yaml");
  }
};

inline std::string keyframes(const std::vector<Eigen::Vector3d>& points) {
  std::string text = "keyframes = {";
  for (const Eigen::Vector3d& p : points) {
    char line[96];
    std::snprintf(line, sizeof line, "{position = {%.6f, %.6f, %.6f}}, ", p.x(), p.y(), p.z());
    text += line;
  }
  return text + "},";
}

// 3 m/s and 5 m/s^2 in any direction.
inline constexpr const char* kGentle =
    "timing = 'profile', solver = 'iqp', step = 0.3, tolerance = 0.05, thrust = 1,\n"
    "vehicle = { mass = 1, inertia = {0.01, 0.01, 0.02}, yaw_share = 0.1, flight_time = 6000,\n"
    "  rotors = { thrust = {0, 6}, torque_coefficient = 0.02, arm_length = 0.2 },\n"
    "  limits = { speed_across = 2.4, climb_speed = 1.8, descent_speed = 1.8,\n"
    "             acceleration_across = 4, acceleration_up = 3, acceleration_down = 3,\n"
    "             yaw_rate_deg = 180 }, camera = 'cameras/racing' },";

// Of the figures: -10 to 10 m, at least 0.2 m apart.
inline std::vector<Eigen::Vector3d> random_keyframes(std::uint64_t seed) {
  Random random(seed);
  std::vector<Eigen::Vector3d> points;
  while (points.size() < 50) {
    const Eigen::Vector3d p(random.uniform(-10, 10), random.uniform(-10, 10),
                            random.uniform(-10, 10));
    if (points.empty() || (p - points.back()).norm() >= 0.2) points.push_back(p);
  }
  return points;
}

}  // namespace lapwing
