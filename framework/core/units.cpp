// SPDX-License-Identifier: Apache-2.0
#include "framework/core/units.h"

#include <array>
#include <charconv>
#include <cmath>

namespace lapwing {

namespace {

// Exponents of metre, kilogram, second, ampere, radian and pixel. Radian and pixel count as
// dimensions of their own, so that an angle is never taken for a ratio.
using Dimension = std::array<int, 6>;

// One of this unit is numerator / denominator SI units. The two are kept apart because
// 36 * 1000 / 3600 is exactly 10, and 36 * (1000 / 3600) is not.
struct Unit {
  Dimension dimension{};
  double numerator = 1.0;
  double denominator = 1.0;
};

struct NamedUnit {
  std::string_view name;
  Unit unit;
};

constexpr Dimension kNone{};
constexpr Dimension kLength{1};
constexpr Dimension kMass{0, 1};
constexpr Dimension kTime{0, 0, 1};
constexpr Dimension kFrequency{0, 0, -1};
constexpr Dimension kForce{1, 1, -2};
constexpr Dimension kTorque{2, 1, -2};
constexpr Dimension kPower{2, 1, -3};
constexpr Dimension kVoltage{2, 1, -3, -1};
constexpr Dimension kCurrent{0, 0, 0, 1};
constexpr Dimension kAngle{0, 0, 0, 0, 1};
constexpr Dimension kAngularRate{0, 0, -1, 0, 1};
constexpr Dimension kPixel{0, 0, 0, 0, 0, 1};
constexpr double kPi = std::numbers::pi;

constexpr NamedUnit kUnits[] = {
    {"1", {kNone}},
    {"%", {kNone, 1, 100}},
    {"percent", {kNone, 1, 100}},
    {"m", {kLength}},
    {"km", {kLength, 1000}},
    {"dm", {kLength, 1, 10}},
    {"cm", {kLength, 1, 100}},
    {"mm", {kLength, 1, 1000}},
    {"um", {kLength, 1, 1e6}},
    {"ft", {kLength, 3048, 10000}},
    {"in", {kLength, 254, 10000}},
    {"kg", {kMass}},
    {"g", {kMass, 1, 1000}},
    {"s", {kTime}},
    {"ms", {kTime, 1, 1000}},
    {"us", {kTime, 1, 1e6}},
    {"min", {kTime, 60}},
    {"h", {kTime, 3600}},
    {"Hz", {kFrequency}},
    {"kHz", {kFrequency, 1000}},
    {"N", {kForce}},
    {"kN", {kForce, 1000}},
    {"mN", {kForce, 1, 1000}},
    {"gf", {kForce, 980665, 1e8}},
    {"kgf", {kForce, 980665, 1e5}},
    {"Nm", {kTorque}},
    {"J", {kTorque}},
    {"W", {kPower}},
    {"kW", {kPower, 1000}},
    {"V", {kVoltage}},
    {"A", {kCurrent}},
    {"rad", {kAngle}},
    {"mrad", {kAngle, 1, 1000}},
    {"deg", {kAngle, kPi, 180}},
    {"\u00b0", {kAngle, kPi, 180}},
    {"rpm", {kAngularRate, 2 * kPi, 60}},
    {"px", {kPixel}},
};

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

// "m^2" times or divided into `product`. False when the name is unknown or the power no integer.
bool apply_factor(std::string_view factor, int sign, Unit& product) {
  int power = 1;
  if (const std::size_t caret = factor.find('^'); caret != factor.npos) {
    const std::string_view digits = factor.substr(caret + 1);
    const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), power);
    if (code != std::errc{} || end != digits.data() + digits.size()) return false;
    if (power < -9 || power > 9) return false;
    factor = factor.substr(0, caret);
  }
  power *= sign;
  for (const NamedUnit& known : kUnits) {
    if (known.name != factor) continue;
    for (std::size_t i = 0; i < product.dimension.size(); ++i) {
      product.dimension[i] += power * known.unit.dimension[i];
    }
    for (int i = 0; i < std::abs(power); ++i) {
      product.numerator *= power > 0 ? known.unit.numerator : known.unit.denominator;
      product.denominator *= power > 0 ? known.unit.denominator : known.unit.numerator;
    }
    return true;
  }
  return false;
}

// Reads "kg m^2/s^2", "kg*m^2", "1/s"; "/" divides by the next factor only, as in "m/s/s".
std::optional<Unit> parse_unit(std::string_view text) {
  Unit product;
  text = trimmed(text);
  int sign = 1;
  while (!text.empty()) {
    const std::size_t end = text.find_first_of(" */");
    if (!apply_factor(text.substr(0, end), sign, product)) return std::nullopt;
    if (end == text.npos) return product;
    sign = 1;
    std::string_view rest = trimmed(text.substr(end));
    if (rest.front() == '/' || rest.front() == '*') {
      sign = rest.front() == '/' ? -1 : 1;
      rest = trimmed(rest.substr(1));
    }
    if (rest.empty()) return std::nullopt;
    text = rest;
  }
  return product;
}

}  // namespace

std::optional<double> parse_quantity(std::string_view text, std::string_view unit) {
  text = trimmed(text);
  if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
  double number = 0.0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (code != std::errc{} || !std::isfinite(number)) return std::nullopt;
  const std::string_view written =
      trimmed(text.substr(static_cast<std::size_t>(end - text.data())));
  if (written.empty() || written == trimmed(unit)) return number;
  const std::optional<Unit> from = parse_unit(written);
  const std::optional<Unit> to = parse_unit(unit);
  if (!from || !to || from->dimension != to->dimension) return std::nullopt;
  const double converted =
      number * (from->numerator * to->denominator) / (from->denominator * to->numerator);
  if (!std::isfinite(converted)) return std::nullopt;
  return converted;
}

}  // namespace lapwing
