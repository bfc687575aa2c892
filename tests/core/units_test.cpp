// SPDX-License-Identifier: Apache-2.0
#include "framework/core/units.h"

namespace lapwing {
namespace {

struct Case {
  const char* text;
  const char* unit;
  double value;
};

TEST(Units, ConvertsIntoTheUnitAskedFor) {
  const double right_angle = std::numbers::pi / 2;
  const Case cases[] = {
      {"2.5", "m", 2.5},
      {"36 km/h", "m/s", 10.0},
      {"36km/h", "m/s", 10.0},
      {"250 ms", "s", 0.25},
      {"-90 deg", "rad", -right_angle},
      {"-90 deg", "deg", -90.0},
      {"90\u00b0", "rad", right_angle},
      {"+1e3 mm", "m", 1.0},
      {"  12 N ", "N", 12.0},
      {"1.5 kN", "N", 1500.0},
      {"800 g", "kg", 0.8},
      {"0.2 Nm", "N m", 0.2},
      {"3 kg*m/s^2", "N", 3.0},
      {"7 kg m^2", "kg*m^2", 7.0},
      {"2 kHz", "1/s", 2000.0},
      {"2 1/s", "Hz", 2.0},
      {"9.81 m/s/s", "m/s^2", 9.81},
      {"60 rpm", "rad/s", 2 * std::numbers::pi},
      {"180 deg/s", "rad/s", std::numbers::pi},
      {"4 px", "px", 4.0},
      {"50 %", "", 0.5},
      {"50 percent", "1", 0.5},
      {"0.5", "percent", 0.5},
      {"100 cm^2", "m^2", 0.01},
      {"2 min", "s", 120.0},
      {"3 images", "images", 3.0},  // a unit that only its owner knows
  };
  for (const Case& c : cases) {
    const std::optional<double> value = parse_quantity(c.text, c.unit);
    ASSERT_TRUE(value.has_value()) << c.text << " in " << c.unit;
    EXPECT_NEAR(*value, c.value, 1e-15 * std::max(1.0, std::abs(c.value))) << c.text;
  }
  EXPECT_EQ(*parse_quantity("36 km/h", "m/s"), 10.0);  // exactly, not 9.999...
}

TEST(Units, RefusesOtherDimensionsAndNoise) {
  const Case cases[] = {
      {"3 kg", "m", 0},     {"3 rad", "", 0},          {"3 px", "m", 0},
      {"3 Hz", "rad/s", 0}, {"3 m", "m/s", 0},         {"", "m", 0},
      {"m", "m", 0},        {"fast", "m/s", 0},        {"3 m m", "m", 0},
      {"3 m/", "m", 0},     {"3 /s", "1/s", 0},        {"nan", "m", 0},
      {"inf m", "m", 0},    {"1e999 m", "m", 0},       {"1e308 km", "mm", 0},
      {"0x10", "m", 0},     {"1,5 m", "m", 0},         {"+-3", "m", 0},
      {"3 m^", "m", 0},     {"3 m^1.5", "m", 0},       {"3 m^99", "m", 0},
      {"3 M", "m", 0},      {"3 m; s", "m", 0},        {"3 deg", "s", 0},
      {"2 images", "m", 0}, {"2 voxels", "images", 0},
  };
  for (const Case& c : cases) {
    EXPECT_FALSE(parse_quantity(c.text, c.unit).has_value()) << c.text << " in " << c.unit;
  }
}

}  // namespace
}  // namespace lapwing
