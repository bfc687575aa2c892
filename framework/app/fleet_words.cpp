// SPDX-License-Identifier: Apache-2.0
#include "framework/app/fleet_words.h"

#include "framework/core/number_text.h"

namespace lapwing {
namespace {

std::string counted(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

}  // namespace

std::string fleet_in_words(const Fleet& fleet, double end) {
  const auto swaps = static_cast<std::size_t>(swaps_of(fleet));
  return counted(fleet.tours.size(), "tour", "tours") + " of " +
         counted(fleet.tours.size() - swaps, "drone", "drones") + ", " +
         counted(swaps, "change of a battery", "changes of batteries") + ", " +
         plain_number(end, 4) + " s in all";
}

std::string tour_in_words(const FleetTour& tour, const Plan& plan, bool certified) {
  const std::size_t images = plan.task.scan ? plan.task.scan->views.size() : 0;
  return name_of_tour(tour) + ": begins at " + plain_number(tour.start, 4) + " s, " +
         plain_number(plan.trajectory.duration(), 4) + " s of flight, " +
         counted(images, "image", "images") + ", " + (certified ? "certified" : "not certified") +
         ": " + tour.file;
}

}  // namespace lapwing
