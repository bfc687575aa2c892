// SPDX-License-Identifier: Apache-2.0
// How useful a view of what is known so far would be. The plugin kind `utility`.
//
// Thesis 5.3, (5.5): an exploration asks for the utility of every viewpoint that it could reach and
// goes where it is highest. A utility knows the map and the camera; only one whose descriptor has
// the extension `needs_ground_truth` may ask for the surface that is really there.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "framework/core/plugin_object.h"
#include "framework/explore/hidden_voxels.h"
#include "framework/explore/map_means.h"
#include "framework/map/map.h"
#include "framework/view/viewpoint.h"

namespace lapwing {

// Of a descriptor: the utility reads `EpisodeView::truth`.
inline constexpr const char* kNeedsGroundTruth = "needs_ground_truth";

// Of a descriptor, and held to by the checks of plugins. A utility values one view after what is
// known, so that the words speak of one more view: no view takes anything away (every value is at
// least 0), and a view is worth no more after more has been looked at than after less.
inline constexpr const char* kMonotone = "monotone";
inline constexpr const char* kSubmodular = "submodular";

// What only a simulation knows. Thread-safe.
class TrueGain {
 public:
  virtual ~TrueGain() = default;
  // (5.3): by how much an image from there would raise the observed surface (5.2).
  virtual double gain(const Viewpoint& view) const = 0;
};

// What an exploration knows when it asks. Everything outlives the call; nothing changes during it.
struct EpisodeView {
  const Map* map = nullptr;              // counts observations
  const MapMeans* means = nullptr;       // of that map
  Pinhole pinhole;                       // of the camera
  double range = 0;                      // m, of the camera
  double pitch = 0;                      // rad, of the camera; the same for every view
  const TrueGain* truth = nullptr;       // null but for a utility that needs it
  int threads = 1;                       // results are the same for any number
  const HiddenVoxels* hidden = nullptr;  // of the images in the map; null where there are none
};

class ViewUtility : public PluginObject {
 public:
  using Interface = ViewUtility;
  static constexpr const char* kKind = "utility";
  virtual ~ViewUtility() = default;

  // Before an exploration's first image: InputError where the utility does not fit it, as a model
  // that was trained with other voxels does not.
  virtual void require_fit(const EpisodeView&) const {}

  // `values` has as many places as there are views; higher is better, and 0 or less says that there
  // is nothing to gain. The same views of the same map have the same values, alone or among others.
  // Error naming the view whose value is not finite.
  void score(const EpisodeView& known, std::span<const Viewpoint> views,
             std::span<double> values) const;

 protected:
  virtual void values_of(const EpisodeView& known, std::span<const Viewpoint> views,
                         std::span<double> values) const = 0;
};

}  // namespace lapwing
