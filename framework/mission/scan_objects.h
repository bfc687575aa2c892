// SPDX-License-Identifier: Apache-2.0
// What scan missions hold: what is known of a place, the graph of views made from it, tours.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "framework/map/ray_gaps.h"
#include "framework/mission/flight_rules.h"
#include "framework/mission/map_objects.h"
#include "framework/picture/mesh_picture.h"
#include "framework/surface/point_fusion.h"
#include "framework/vehicle/pursuit.h"
#include "framework/vehicle/smooth_leg.h"
#include "framework/view/passes.h"
#include "framework/view/scan_graph.h"
#include "framework/view/tour_solver.h"
#include "framework/view/tour_start.h"

namespace lapwing {

// All that planning may know: made from depth images or files, never from the scene itself
// (reading 4.9).
struct Prior {
  Mapping mapping;
  FusionOptions fusion_options;
  std::optional<PointFusion> fusion;
  std::vector<FusedPoint> earlier;         // of the mesh of an earlier flight
  std::shared_ptr<const MeshScene> mesh;   // null until it is made or read
  std::vector<Viewpoint> views;            // from which depth images were taken
  MapRays rays;                            // of those images, and of files
  bool surveyed = false;                   // map and mesh are of a surveyor's data
  std::optional<SceneView> scene;          // the scene flown in, for the report alone
  std::shared_ptr<const MeshScene> truth;  // that scene, for the report's figures alone
};

struct PriorObject {
  std::shared_ptr<Prior> prior;
};

// How legs are flown, and so what they take.
struct LegFlight {
  Vehicle vehicle;
  PursuitSettings flight;
  std::optional<SmoothLegSettings> smooth;  // legs are flown by solutions, not by pursuit
  double view_seconds = 0;                  // s, of the view at a leg's end at least

  // Of a way, its view at the end included: at least the way at full speed and what a view costs
  // (reading 4.6), and as long as the vehicle and its camera need, either way.
  double seconds(const Points& way, const Viewpoint& from, const Viewpoint& to) const;
};

// What of a region the rules of a flight keep from being seen: m^2 of the known surface.
struct HiddenPart {
  std::string name;    // of the region, or "" of all of them together
  double visible = 0;  // from places that are free, whatever the rules say
  double hidden = 0;   // of it, what no candidate that the rules allow sees
};

// A graph, and what its tours take in seconds.
struct ScanWork : LegFlight {
  std::shared_ptr<Prior> prior;
  std::shared_ptr<const VisibleVoxels> visible;  // through every pixel of the camera
  bool weighed_fully = false;                    // so is the score of the graph
  std::shared_ptr<const ViewInformation> information;
  ScanGraph graph;
  std::vector<double> seconds;  // of each motion, a view's own included
  ViewIslands islands{0, {}};   // of the views that are joined by motions
  int home = 0;                 // of the views, where tours begin
  // Views that every tour is to take, ascending, and the score in which they count more than all
  // else; null where there are none.
  std::vector<int> pinned;
  std::shared_ptr<const ViewScore> pinned_score;
  Eigen::AlignedBox3d allowed;  // where the vehicle's middle may be
  Eigen::Vector3d body;         // half edges of the vehicle's box, m
  double mesh_room = 0;         // m from the prior mesh that the box keeps beside
  std::shared_ptr<const FlightRules> rules = std::make_shared<const FlightRules>();
  std::vector<HiddenPart> hidden;    // what the rules keep from all candidates
  std::vector<Viewpoint> forbidden;  // a sample of the views that only the rules forbid
  // Of views that are taken in passing: their numbers, pass by pass, and the courses, rad.
  std::vector<std::vector<int>> passes;
  std::vector<double> courses;

  // The place of the motion between two views; nothing, or Error, where there is none.
  std::optional<std::size_t> find_motion(int a, int b) const;
  std::size_t motion_between(int a, int b) const;
  double leg_seconds(int a, int b) const { return seconds[motion_between(a, b)]; }
};

struct MissionRun;
struct PluginChoice;
struct SolutionObject;
struct SolveReport;

struct GraphObject {
  std::shared_ptr<const ScanWork> work;
};

// Of the pinned views those that no walk takes, by their numbers in `pinned`, from 1.
std::vector<int> pinned_views_missed(const ScanWork& work,
                                     const std::vector<std::vector<int>>& walks);
// Takes what pinned views count more out of a report about these walks.
void take_out_pinned(const ScanWork& work, const std::vector<std::vector<int>>& walks,
                     const std::vector<int>& reachable, TourReport& report);

struct TourObject {
  std::shared_ptr<const ScanWork> work;
  std::string solver;
  double budget = 0;
  TourReport report;
  std::vector<int> walk;
  std::shared_ptr<const PassFlight> passing = nullptr;  // of a tour of passes
  // Views that it, or another tour of its team, can reach within the budget, ascending; of passes
  // none, as nobody knows.
  std::vector<int> reachable = {};
};

inline constexpr const char* kPriorType = "prior";
inline constexpr const char* kGraphType = "scan graph";
inline constexpr const char* kTourType = "tour";

void open_scan_library(lua_State* state);
// prior, scan_graph, solve_tour, pass_graph, pass_tour, scan_plan.
std::span<const Binding> scan_methods_of_run();

// The parts of that list.
std::span<const Binding> graph_methods_of_run();
std::span<const Binding> graph_memory_methods_of_run();
std::span<const Binding> prior_methods_of_run();
std::span<const Binding> scan_plan_methods_of_run();
std::span<const Binding> pass_methods_of_run();
std::span<const Binding> prism_methods_of_run();  // prisms
void open_prior_type(lua_State* state);
void open_graph_type(lua_State* state);

// The plugin that a field of the table names.
PluginChoice choice_at(lua_State* state, int table, const char* key);

// The parameter `method` of what makes a mesh, and the mesh through points that its `cell`, `trim`
// and `method` describe. InputError and Cancelled as surface_from_points.
void add_surface_method(ParameterTable& table);
TriangleMesh surface_of(const MissionRun& run, const std::vector<FusedPoint>& points,
                        const Parameters& given);

// Arguments that several of them take: {position =, yaw =, pitch =}; {lower =, upper =};
// {width =, height =, focal =}.
ParameterTable viewpoint_table();
Viewpoint viewpoint_of(const Parameters& given);
ParameterTable box_table();
Eigen::AlignedBox3d box_of(const Parameters& given, const std::string& what);
// A box as well, around `prisms` where there are any: {name =, corners = {x, y, ...}, holes =
// {{corners =}}, low =, high =, weight =}.
ParameterTable region_table();
InterestRegion region_of(const Parameters& given);
ParameterTable pinhole_table();
Pinhole pinhole_of(const Parameters& given);

// The most iterations of a solver where a tour of so many views is only estimated, while something
// is dragged: each takes longer the more views there are. Up to 500 views these are no fewer than
// the default of local_search, 2,000.
inline std::int64_t estimate_iterations(std::size_t views) {
  constexpr std::int64_t kLeast = 500, kOfAllViews = 1'000'000;
  return std::max(kLeast, kOfAllViews / static_cast<std::int64_t>(std::max<std::size_t>(views, 1)));
}

// A tour that begins with one that the clock ended may come out otherwise another time: its status
// becomes time_limit as well.
void take_over_time_limit(const TourReport& initial, TourReport& report);

// Of a graph's tours from its home back to it, without a budget. InputError, which names the
// function, where the graph is of passes.
TourDefinition tour_definition(const ScanWork& work, const std::string& function);
SolveReport report_of(const TourReport& tour);

// The legs of a tour, from view to view: {points = {x, y, z, ...}, yaw_from, yaw_to, seconds}, the
// seconds without a pause.
Value legs_of(const TourObject& tour);

// The flight that the solutions of a tour's legs make, with a rest in every view; one stop per view
// of its walk. InputError where a solution is not from view to view.
Pursuit joined_flight(const TourObject& tour, const std::vector<const SolutionObject*>& solutions);

// The flight of a tour of passes as its solution has it: the gimbal turns between passes, and the
// views are where and whither the camera looks at their times.
struct PassedFlight {
  Trajectory trajectory;
  std::vector<PlannedView> views;
  double miss = 0;  // m, farthest of a view from where its pass has it
  double bank = 0;  // rad, largest at an image
};
// InputError where the solution is not of this tour, or its model has no yaw.
PassedFlight passed_flight(const TourObject& tour, const SolutionObject& solution);
// {duration, times, positions, yaws, images = {{time, position}, ...}}: s, m and rad.
Value flight_of_passes(const TourObject& tour);

// Places that are free in the map and so far from the prior mesh, m.
std::unique_ptr<FreeSpace> space_of(const Prior& prior, double mesh_room);
// What a graph's table says of its images, looked into the prior with: `visible` and `information`
// of the work are made, and what views are weighed by is returned; with `within`, both see only
// that part of the region. InputError where the region of
// interest holds no surface.
std::shared_ptr<const VisibleVoxels> make_sight(ScanWork& work, const MissionRun& run,
                                                const Parameters& given,
                                                const PluginChoice& information,
                                                const Eigen::AlignedBox3d* within = nullptr);

// The stops of a way from view to view: its corners, each with a heading on the way from the first
// one's to the last one's, and with the time that the gimbal needs for its share of the tilt.
std::vector<PursuitView> stops_of(const std::vector<Eigen::Vector3d>& points, const Viewpoint& from,
                                  const Viewpoint& to, const Vehicle& vehicle);

}  // namespace lapwing
