// SPDX-License-Identifier: Apache-2.0
#include "framework/explore/lookahead.h"

#include <algorithm>

#include "framework/explore/viewpoint_index.h"

namespace lapwing {
namespace {

// A view on a way. Those of one length stand together, the shorter ways before the longer.
struct WayNode {
  int view;    // in the index
  int before;  // the node before it; -1 for the first of a way
  double best = 0;
};

bool on_way(const std::vector<WayNode>& nodes, int node, int view) {
  for (; node >= 0; node = nodes[static_cast<std::size_t>(node)].before)
    if (nodes[static_cast<std::size_t>(node)].view == view) return true;
  return false;
}

}  // namespace

int score_ahead(const ViewUtility& utility, const EpisodeView& known,
                std::span<const Viewpoint> views, int length, const NextViews& next,
                std::span<double> values) {
  ViewpointIndex index;
  std::vector<WayNode> nodes;
  for (const Viewpoint& view : views) nodes.push_back({index.add(view), -1});
  std::vector<std::vector<int>> leads;  // by view, where its moves lead to; filled when asked for
  std::vector<bool> known_leads;
  std::size_t begin = 0;
  for (int depth = 1; depth < length; ++depth) {
    const std::size_t end = nodes.size();
    for (std::size_t k = begin; k < end; ++k) {
      const auto at = static_cast<std::size_t>(nodes[k].view);
      leads.resize(static_cast<std::size_t>(index.size()));
      known_leads.resize(leads.size());
      if (!known_leads[at]) {
        known_leads[at] = true;
        std::vector<int> found;
        for (const Viewpoint& view : next(index[nodes[k].view])) found.push_back(index.add(view));
        leads[at] = std::move(found);
      }
      for (const int view : leads[at])
        if (!on_way(nodes, static_cast<int>(k), view)) nodes.push_back({view, static_cast<int>(k)});
    }
    begin = end;
  }
  std::vector<Viewpoint> asked;
  for (int k = 0; k < index.size(); ++k) asked.push_back(index[k]);
  std::vector<double> single(asked.size());
  utility.score(known, asked, single);
  // From the ends of the ways to their beginnings.
  for (std::size_t k = nodes.size(); k-- > 0;) {
    WayNode& node = nodes[k];
    node.best += single[static_cast<std::size_t>(node.view)];
    if (node.before >= 0) {
      double& best = nodes[static_cast<std::size_t>(node.before)].best;
      best = std::max(best, node.best);
    } else {
      values[k] = node.best / length;
    }
  }
  return index.size();
}

}  // namespace lapwing
