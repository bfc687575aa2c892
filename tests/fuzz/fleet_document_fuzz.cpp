// SPDX-License-Identifier: Apache-2.0
// Fleet documents: whatever the bytes, a fleet that is written and read back as itself, or an
// InputError.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "framework/core/error.h"
#include "framework/core/json.h"
#include "framework/trajectory/fleet.h"
#include "framework/trajectory/plan_digest.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lapwing;
  try {
    const Value document = from_json({reinterpret_cast<const char*>(data), size}, "input");
    (void)check_digest(document);
    const Fleet fleet = fleet_from_value(document);
    if (!is_fleet(document)) std::abort();
    (void)swaps_of(fleet);
    for (const FleetTour& tour : fleet.tours) {
      // Files lie beside the document.
      if (tour.file.find('/') != tour.file.npos || tour.file == "..") std::abort();
      (void)name_of_tour(tour);
    }
    const std::string text = fleet_text(fleet);
    const Value written = from_json(text, "written");
    if (fleet_text(fleet_from_value(written)) != text) std::abort();
    if (!check_digest(written).changed.empty()) std::abort();
  } catch (const InputError&) {
  }
  return 0;
}
