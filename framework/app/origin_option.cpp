// SPDX-License-Identifier: Apache-2.0
#include "framework/app/origin_option.h"

#include <charconv>

#include "framework/core/error.h"
#include "framework/geometry/geodetic_origin.h"

namespace lapwing {
namespace {

constexpr const char* kOriginForm =
    "--origin: expected LAT,LON,HEIGHT,OF, OF being ellipsoid, sea or ground, as in "
    "46.5191,6.5668,0,ground";

// Of --origin: "46.5191,6.5668,395,sea".
GeodeticOrigin origin_from_text(const std::string& text) {
  double figures[3] = {};
  const char* at = text.data();
  const char* const end = text.data() + text.size();
  for (double& figure : figures) {
    const auto [next, error] = std::from_chars(at, end, figure);
    if (error != std::errc{} || next == end || *next != ',')
      throw InputError(std::string(kOriginForm) + ", got '" + text + "'");
    at = next + 1;
  }
  const auto reference = height_of_named(std::string_view(at, static_cast<std::size_t>(end - at)));
  if (!reference) throw InputError(std::string(kOriginForm) + ", got '" + text + "'");
  return stated_origin(figures[0], figures[1], figures[2], *reference, "--origin");
}

}  // namespace

void give_origin(Plan& plan, const std::string& text) {
  if (text.empty()) return;
  if (plan.geodetic_origin)
    throw InputError("--origin: the plan states an origin of its own, in `frame.geodetic_origin`");
  plan.geodetic_origin = origin_from_text(text);
}

}  // namespace lapwing
