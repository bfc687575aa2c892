// SPDX-License-Identifier: Apache-2.0
// What every map must do: the same as the reference, bit for bit.
#include <array>
#include <cmath>
#include <cstring>
#include <thread>

#include "framework/conformance/findings.h"
#include "framework/conformance/sample_parameters.h"
#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/map/plain_map.h"

namespace lapwing {
namespace {

std::string text(const VoxelKey& key) {
  return "voxel " + std::to_string(key.x) + " " + std::to_string(key.y) + " " +
         std::to_string(key.z);
}

std::string text(const MapRayHit& hit) {
  static constexpr const char* kStates[] = {"unknown", "free", "occupied"};
  return std::string(kStates[static_cast<int>(hit.state)]) + " " + text(hit.voxel) + " at " +
         std::to_string(hit.distance);
}

bool same(const MapRayHit& a, const MapRayHit& b) {
  return a.voxel == b.voxel && a.state == b.state && a.distance == b.distance;
}

// Asked with every parameter; others with the defaults, and with counted observations.
constexpr std::initializer_list<const char*> kOfEveryCase = {"empty", "integration", "ray casts",
                                                             "boxes", "import"};

class MapCheck {
 public:
  MapCheck(const std::function<std::unique_ptr<Map>()>& create, const CheckOptions& options,
           Findings& findings)
      : create_(create),
        options_(options),
        findings_(findings),
        random_(options.seed),
        map_(create()),
        reference_(map_->settings()),
        voxel_(map_->settings().resolution) {}

  // `thorough`: also what costs a while and hardly depends on parameters.
  void run(bool thorough) {
    if (options_.wants("empty")) empty();
    if (options_.only == std::vector<std::string>{"empty"}) return;
    for (int scan = 0; scan < 6; ++scan) integrate(*map_, scan);
    // From one place until the clamps hold.
    const Random before = random_;
    for (int turn = 0; turn < 6; ++turn) {
      random_ = before;
      integrate(*map_, 0);
    }
    if (options_.wants("integration")) compare("integration");
    if (options_.wants("ray casts")) casts();
    if (options_.wants("boxes")) boxes();
    if (options_.wants_any({"import", "touching", "means", "refusals"})) import();
    if (!thorough) return;
    if (options_.wants("touching")) touching();
    if (options_.wants("means")) means();
    if (options_.wants_any({"repeatable", "threads"})) threads();
    if (options_.wants_any({"round trip", "memory"})) round_trip();
    if (options_.wants("refusals")) refusals();
  }

 private:
  // Points in voxels around the origin of the world, a little off the lattice.
  Eigen::Vector3d place(double reach) {
    return {voxel_ * random_.uniform(-reach, reach), voxel_ * random_.uniform(-reach, reach),
            voxel_ * random_.uniform(-reach, reach)};
  }

  void empty() {
    findings_.expect("empty", !map_->bounds() && map_->counts().known == 0,
                     [] { return "a new map knows voxels"; });
    findings_.expect("empty", map_->read({40000, 40000, 40000}).state == VoxelState::unknown,
                     [] { return "a voxel of a new map is not unknown"; });
  }

  std::vector<Eigen::Vector3f> scan_points(const Eigen::Vector3d& from, int scan) {
    std::vector<Eigen::Vector3f> points;
    const Eigen::Vector3d ahead = place(16);
    for (int k = 0; k < 60; ++k) {
      const double spread = scan % 2 ? 3 : 12;
      points.push_back((from + ahead + place(spread)).cast<float>());
    }
    // Along an axis and a diagonal, the same point twice, in the voxel of the origin.
    points.push_back((from + voxel_ * Eigen::Vector3d(9.5, 0, 0)).cast<float>());
    points.push_back((from + voxel_ * Eigen::Vector3d(-7, 7, 7)).cast<float>());
    points.push_back(points.front());
    if (scan == 4) points.push_back(from.cast<float>());
    return points;
  }

  void integrate(Map& map, int scan) {
    Eigen::Vector3d from = place(8);
    if (scan == 3) from = Eigen::Vector3d::Constant(0.5 * voxel_);  // in the middle of a voxel
    const std::vector<Eigen::Vector3f> points = scan_points(from, scan);
    map.integrate(points, from.cast<float>());
    if (&map == map_.get()) reference_.integrate(points, from.cast<float>());
  }

  void compare(const std::string& check) {
    std::unordered_map<VoxelKey, VoxelLeaf, VoxelKeyHash> left;
    reference_.for_each_leaf([&](const VoxelLeaf& leaf) { left[leaf.key] = leaf; });
    std::string wrong;
    map_->for_each_leaf([&](const VoxelLeaf& leaf) {
      const int edge = 1 << leaf.level;
      for (int k = 0; k < edge * edge * edge; ++k) {
        const VoxelKey key{static_cast<std::uint16_t>(leaf.key.x + k % edge),
                           static_cast<std::uint16_t>(leaf.key.y + k / edge % edge),
                           static_cast<std::uint16_t>(leaf.key.z + k / edge / edge)};
        const auto found = left.find(key);
        if (!wrong.empty()) return;
        if (found == left.end()) {
          wrong = text(key) + " is known, or comes twice";
          return;
        }
        if (found->second.log_odds != leaf.log_odds ||
            found->second.observations != leaf.observations)
          wrong = text(key) + " has log odds " + std::to_string(leaf.log_odds) + " and " +
                  std::to_string(leaf.observations) + " observations, not " +
                  std::to_string(found->second.log_odds) + " and " +
                  std::to_string(found->second.observations);
        left.erase(found);
      }
    });
    if (wrong.empty() && !left.empty()) wrong = text(left.begin()->first) + " is not known";
    findings_.expect(check, wrong.empty(), [&] { return wrong; });
    reads(check);
  }

  void reads(const std::string& check) {
    const VoxelCounts counts = map_->counts(), right = reference_.counts();
    findings_.expect(check,
                     counts.known == right.known && counts.free == right.free &&
                         counts.occupied == right.occupied,
                     [] { return "the numbers of known, free and occupied voxels are wrong"; });
    findings_.expect(check, map_->bounds() == reference_.bounds(),
                     [] { return "the bounds are not those of the known voxels"; });
    for (int k = 0; k < 500; ++k) {
      const VoxelKey key = map_->grid().key(place(20));
      const VoxelReading a = map_->read(key), b = reference_.read(key);
      VoxelState state;
      map_->read_states({&key, 1}, {&state, 1});
      findings_.expect(check,
                       a.known == b.known && a.state == b.state && a.log_odds == b.log_odds &&
                           a.observations == b.observations && state == b.state,
                       [&] { return text(key) + " is read otherwise than it is listed"; });
    }
  }

  std::vector<MapRay> some_rays() {
    std::vector<MapRay> rays;
    for (int k = 0; k < 150; ++k) {
      const Eigen::Vector3d from = place(10);
      rays.push_back({from, place(1).normalized(), voxel_ * random_.uniform(1, 60)});
    }
    // Where nothing can be told by chance: along axes and diagonals, from faces and corners.
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          if (x == 0 && y == 0 && z == 0) continue;
          const Eigen::Vector3d direction = Eigen::Vector3d(x, y, z).normalized();
          for (const double at : {0.0, 0.5, 2.0})
            rays.push_back({Eigen::Vector3d::Constant(at * voxel_), direction, 40 * voxel_});
        }
    // A view: many from one place.
    const Eigen::Vector3d eye = place(4);
    for (int k = 0; k < 100; ++k)
      rays.push_back({eye, Eigen::Vector3d(1, 0.006 * k - 0.3, 0.1).normalized(), 30 * voxel_});
    rays.push_back({place(5), Eigen::Vector3d::UnitX(), 2 * map_->grid().reach()});
    return rays;
  }

  void casts() {
    clear_room(*map_);
    clear_room(reference_);
    const std::vector<MapRay> rays = some_rays();
    std::vector<MapRayHit> hits(rays.size()), right(rays.size());
    map_->cast(rays, hits);
    reference_.cast(rays, right);
    for (std::size_t k = 0; k < rays.size(); ++k)
      findings_.expect("ray casts", same(hits[k], right[k]), [&] {
        return "ray " + std::to_string(k) + " meets " + text(hits[k]) + ", not " + text(right[k]);
      });
  }

  // Free space with a few obstacles, for rays and boxes to move in.
  static void clear_room(Map& map) {
    std::vector<VoxelLeaf> leaves;
    const auto at = [](int x, int y, int z) {
      return VoxelKey{static_cast<std::uint16_t>(kCenterKey + x),
                      static_cast<std::uint16_t>(kCenterKey + y),
                      static_cast<std::uint16_t>(kCenterKey + z)};
    };
    for (int k = 0; k < 8; ++k)
      leaves.push_back({at(k & 1 ? 0 : -16, k & 2 ? 0 : -16, k & 4 ? 0 : -16), 4, 3, -HUGE_VALF});
    leaves.push_back({at(8, -4, 0), 2, 1, HUGE_VALF});
    leaves.push_back({at(-10, 3, -7), 0, 1, HUGE_VALF});
    leaves.push_back({at(4, 8, -2), 1, 1, 0.0f});
    map.import(leaves);
  }

  void boxes() {
    for (int k = 0; k < 100; ++k) {
      const Eigen::Vector3d from = place(12), to = k % 5 ? place(12) : from;
      const Eigen::Vector3d half = place(2).cwiseAbs();
      findings_.expect(
          "boxes",
          map_->swept_box_free(from, to, half) == reference_.swept_box_free(from, to, half),
          [&] { return "a box on its way is free in one map and not in the other"; });
      findings_.expect(
          "boxes",
          map_->box_free(from - half, from + half) == reference_.box_free(from - half, from + half),
          [&] { return "a box is free in one map and not in the other"; });
    }
  }

  // In the cleared room: from -16 to 16 voxels, an obstacle from 8 to 12, -4 to 0, 0 to 4.
  void touching() {
    const auto free = [&](double x, double y, double z, double half) {
      const Eigen::Vector3d middle = voxel_ * Eigen::Vector3d(x, y, z);
      const Eigen::Vector3d edges = Eigen::Vector3d::Constant(half * voxel_);
      return map_->box_free(middle - edges, middle + edges);
    };
    import_room();
    findings_.expect("touching", free(-13, -13, 13, 3),
                     [] { return "a box that touches what is unknown is not free"; });
    findings_.expect("touching", !free(-13.1, -13, 13, 3),
                     [] { return "a box that reaches into what is unknown is free"; });
    findings_.expect("touching", free(6, -2, 2, 2),
                     [] { return "a box that touches an obstacle is not free"; });
    findings_.expect("touching", !free(6.01, -2, 2, 2),
                     [] { return "a box that reaches into an obstacle is free"; });
    findings_.expect("touching", !free(10, -2, 2, 0) && free(2, -2, 2, 0),
                     [] { return "a point is not judged as the voxel that holds it"; });
    const Eigen::Vector3d a = voxel_ * Eigen::Vector3d(2, 2, 2),
                          b = voxel_ * Eigen::Vector3d(14, 2, 2),
                          half = Eigen::Vector3d::Constant(2 * voxel_);
    findings_.expect("touching", map_->swept_box_free(a, b, half),
                     [] { return "a box that slides along an obstacle is not free"; });
  }

  void import_room() {
    map_ = create_();
    clear_room(*map_);
  }

  void import() {
    std::vector<VoxelLeaf> leaves;
    for (int k = 0; k < 26; ++k) {
      const int level = k == 7 ? 5 : k % 5, edge = 1 << level;
      const VoxelKey key = map_->grid().key(place(24));
      leaves.push_back(
          {{static_cast<std::uint16_t>(key.x & -edge), static_cast<std::uint16_t>(key.y & -edge),
            static_cast<std::uint16_t>(key.z & -edge)},
           static_cast<std::uint8_t>(level),
           static_cast<std::uint16_t>(random_.integer(0, 65535)),
           static_cast<float>(random_.uniform(-3, 3))});
    }
    map_->import(leaves);
    reference_.import(leaves);
    for (int scan = 0; scan < 2; ++scan) integrate(*map_, scan);
    compare("import");
  }

  void means() {
    map_ = create_();
    PlainMap right(map_->settings());
    clear_room(*map_);
    clear_room(right);
    const Eigen::Vector3d from = place(4);
    const std::vector<Eigen::Vector3f> points = scan_points(from, 0);
    for (int scan = 0; scan < 2; ++scan) {
      map_->integrate(points, from.cast<float>());
      right.integrate(points, from.cast<float>());
      for (int level = 0; level <= 5; ++level) {
        const VoxelKey key = map_->grid().key(place(20));
        MeanReading a, b;
        map_->read_means(level, {&key, 1}, {&a, 1});
        right.read_means(level, {&key, 1}, {&b, 1});
        findings_.expect("means",
                         std::abs(a.occupancy - b.occupancy) < 1e-5 &&
                             std::abs(a.uncertainty - b.uncertainty) < 1e-5,
                         [&] {
                           return "level " + std::to_string(level) + " around " + text(key) +
                                  " has means " + std::to_string(a.occupancy) + " and " +
                                  std::to_string(a.uncertainty) + ", not " +
                                  std::to_string(b.occupancy) + " and " +
                                  std::to_string(b.uncertainty);
                         });
      }
    }
  }

  std::vector<VoxelLeaf> leaves_of(const Map& map) const {
    std::vector<VoxelLeaf> leaves;
    map.for_each_leaf([&](const VoxelLeaf& leaf) { leaves.push_back(leaf); });
    return leaves;
  }

  void threads() {
    const Random before = random_;
    std::vector<std::vector<VoxelLeaf>> results;
    std::vector<std::vector<MapRayHit>> hits;
    for (const int count : {1, 1, 4}) {
      random_ = before;
      map_ = create_();
      map_->set_threads(count);
      for (int scan = 0; scan < 4; ++scan) {
        const Eigen::Vector3d from = place(8);
        std::vector<Eigen::Vector3f> points;
        for (int k = 0; k < 800; ++k) points.push_back((from + place(20)).cast<float>());
        map_->integrate(points, from.cast<float>());
      }
      clear_room(*map_);
      std::vector<MapRay> rays;
      for (int k = 0; k < 6; ++k)
        for (const MapRay& ray : some_rays()) rays.push_back(ray);
      hits.emplace_back(rays.size());
      map_->cast(rays, hits.back());
      results.push_back(leaves_of(*map_));
    }
    const auto equal = [&](std::size_t a, std::size_t b) {
      return results[a] == results[b] &&
             std::equal(hits[a].begin(), hits[a].end(), hits[b].begin(), same);
    };
    findings_.expect("repeatable", equal(0, 1), [] { return "the same scans give two maps"; });
    findings_.expect("threads", equal(0, 2),
                     [] { return "four threads give another map than one"; });
    readers(hits[2]);
  }

  // Const calls from several threads at once.
  void readers(const std::vector<MapRayHit>& expected) {
    const std::vector<MapRay> rays(expected.size() / 6, {place(4), Eigen::Vector3d::UnitY(), 9});
    std::vector<MapRayHit> first(rays.size());
    map_->cast(rays, first);
    std::array<bool, 4> fine{};
    std::vector<std::thread> threads;
    for (bool& ok : fine)
      threads.emplace_back([&] {
        std::vector<MapRayHit> own(rays.size());
        map_->cast(rays, own);
        const VoxelKey key = map_->grid().key(rays.front().origin);
        MeanReading mean, again;
        map_->read_means(4, {&key, 1}, {&mean, 1});
        map_->read_means(4, {&key, 1}, {&again, 1});
        ok = std::equal(own.begin(), own.end(), first.begin(), same) &&
             mean.occupancy == again.occupancy;
      });
    for (std::thread& thread : threads) thread.join();
    findings_.expect("threads", fine[0] && fine[1] && fine[2] && fine[3],
                     [] { return "four readers at once get other answers than one alone"; });
  }

  void round_trip() {
    map_ = create_();
    for (int scan = 0; scan < 4; ++scan) integrate(*map_, scan);
    const std::unique_ptr<Map> again = create_();
    again->import(leaves_of(*map_));
    bool equal = again->counts().known == map_->counts().known;
    for (const VoxelLeaf& leaf : leaves_of(*map_)) {
      const VoxelReading reading = again->read(leaf.key);
      equal &= reading.log_odds == leaf.log_odds && reading.observations == leaf.observations;
    }
    findings_.expect("round trip", equal,
                     [] { return "leaves imported into a new map make another map"; });
    findings_.expect("memory", map_->bytes() > 0 && map_->bytes() < (std::size_t{64} << 20), [&] {
      return "a small map says that it takes " + std::to_string(map_->bytes()) + " bytes";
    });
  }

  template <class Call>
  void refuses(const std::string& what, const Call& call) {
    const std::vector<VoxelLeaf> before = leaves_of(*map_);
    bool refused = false;
    try {
      call();
    } catch (const InputError&) {
      refused = true;
    }
    findings_.expect("refusals", refused, [&] { return what + " is taken"; });
    findings_.expect("refusals", leaves_of(*map_) == before,
                     [&] { return what + " is refused, but changes the map"; });
  }

  void refusals() {
    const Eigen::Vector3f here(0, 0, 0);
    const float far = static_cast<float>(2 * map_->grid().reach());
    const auto scan = [&](const Eigen::Vector3f& point, const Eigen::Vector3f& origin) {
      const std::vector<Eigen::Vector3f> points{
          Eigen::Vector3f::Constant(static_cast<float>(3 * voxel_)), point};
      map_->integrate(points, origin);
    };
    refuses("a point that is not a number", [&] { scan({NAN, 0, 0}, here); });
    refuses("a point at infinity", [&] { scan({0, INFINITY, 0}, here); });
    refuses("a point outside the largest map", [&] { scan({0, 0, far}, here); });
    refuses("an origin outside the largest map", [&] { scan(here, {far, 0, 0}); });
    const auto leaf = [&](VoxelLeaf bad) {
      const std::vector<VoxelLeaf> leaves{{{9, 9, 9}, 0, 0, 1.0f}, bad};
      map_->import(leaves);
    };
    refuses("a leaf that is not a number", [&] { leaf({{8, 8, 8}, 0, 0, NAN}); });
    refuses("a leaf of level 17", [&] { leaf({{0, 0, 0}, 17, 0, 1}); });
    refuses("a leaf between two cubes", [&] { leaf({{2, 0, 0}, 2, 0, 1}); });
    MapRayHit hit;
    for (const MapRay& ray : {MapRay{{NAN, 0, 0}, Eigen::Vector3d::UnitX(), 1},
                              MapRay{{0, 0, 0}, Eigen::Vector3d::Zero(), 1},
                              MapRay{{0, 0, 0}, Eigen::Vector3d::UnitX(), 0},
                              MapRay{{0, 0, 2.0 * far}, Eigen::Vector3d::UnitX(), 1}})
      refuses("a ray without start, direction or range", [&] { map_->cast({&ray, 1}, {&hit, 1}); });
    refuses("a box that is not a number", [&] { (void)map_->box_free({0, 0, NAN}, {1, 1, 1}); });
  }

  const std::function<std::unique_ptr<Map>()>& create_;
  const CheckOptions& options_;
  Findings& findings_;
  Random random_;
  std::unique_ptr<Map> map_;
  PlainMap reference_;
  double voxel_;  // m
};

}  // namespace

std::vector<CheckResult> check_map(const Specimen<Map>& subject, const CheckOptions& options) {
  Findings findings(options);
  const StandardSetting standard(false);
  std::vector<ParameterCase> cases = parameter_cases(subject.parameters, standard);
  // Counting changes what is stored, so that everything is asked again with it.
  ParameterCase counting = cases.front();
  counting.description = "observations";
  counting.parameters.set("observations", true);
  cases.insert(cases.begin() + 1, counting);
  for (std::size_t k = 0; k < cases.size() && !findings.settled(); ++k) {
    findings.set_case(cases[k].description);
    try {
      const std::function<std::unique_ptr<Map>()> create = [&] {
        return subject.create(cases[k].parameters);
      };
      create();
      findings.expect("creation", true, {});
      const bool thorough = k < 2;
      if (!options.wants_answers() || !(thorough || options.wants_any(kOfEveryCase))) continue;
      findings.survives("exceptions", "a call",
                        [&] { MapCheck(create, options, findings).run(thorough); });
    } catch (const InputError& error) {
      findings.expect("creation", !cases[k].must_work,
                      [&] { return std::string("refused: ") + error.what(); });
    } catch (const std::exception& error) {
      findings.fail("creation", std::string("throws: ") + error.what());
    }
  }
  findings.set_case("");
  return std::move(findings).results();
}

}  // namespace lapwing
