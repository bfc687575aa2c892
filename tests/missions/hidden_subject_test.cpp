// SPDX-License-Identifier: Apache-2.0
// Films whose subject is hidden, and films that can look round what hides it.
#include "tests/missions/flown_film.h"

namespace lapwing {
namespace {

// Lower and narrower than the wall: the flight can look over it.
constexpr const char* kBoard = "v 0 -0.4 0\nv 0 0.4 0\nv 0 0.4 2.2\nv 0 -0.4 2.2\nf 1 2 3 4\n";
// Between the flight, at x = -6, and whatever stands east of it: 12 m wide and 8 m high.
constexpr const char* kWall = "v 0 -6 0\nv 0 6 0\nv 0 6 8\nv 0 -6 8\nf 1 2 3 4\n";

class HiddenSubject : public Filming {
 protected:
  Flown film_of(const std::string& subject, const std::string& more, const std::string& options,
                const char* name) {
    write_file_atomically(folder_ / "wall.obj", kWall);
    write_file_atomically(folder_ / "board.obj", kBoard);
    write_file_atomically(folder_ / "hidden.lua",
                          "return require('mission.film').shot { name = 'hidden', duration = 8, "
                          "subject = { position = {" +
                              subject + "}, height = 1.8 }, obstacles = { " + more +
                              " }, "
                              "keyframes = { { time = 0, position = {-6, -2, 3} }, { time = 8, "
                              "position = {-6, 2, 3} } "
                              "} }");
    return fly((folder_ / "hidden.lua").string(), options, name);
  }
  static std::string failures(const Flown& flown) {
    std::string names;
    for (const Value& check : flown.result.at("certificate").at("checks").as_list()) {
      const Value *pass = check.find("pass"), *required = check.find("required");
      if (check.find("skipped") || !pass || pass->as_boolean()) continue;
      names += (required->as_boolean() ? "" : "(") + check.at("name").as_text() +
               (required->as_boolean() ? " " : ") ");
    }
    return names;
  }
};

constexpr const char* kMesh = "{ type = 'mesh', name = 'house', file = 'wall.obj' }";

TEST_F(HiddenSubject, BehindAMeshTheFilmIsRefused) {
  const Flown flown = film_of("4, 0, 1", kMesh, "", "behind");
  EXPECT_EQ(flown.status, 1);
  EXPECT_EQ(failures(flown), "line_of_sight ");
}

// Without the cost the subject is hidden for a while; with it the flight looks round the mesh.
TEST_F(HiddenSubject, AMeshThatCanBeLookedRoundIs) {
  const std::string board = "{ type = 'mesh', name = 'board', file = 'board.obj' }";
  const Flown blind =
      film_of("4, 0, 1", board, "--set line_of_sight=reported --set weights.occlusion=0", "blind");
  EXPECT_EQ(failures(blind), "(line_of_sight) ");
  const Flown flown = film_of("4, 0, 1", board, "", "round");
  EXPECT_EQ(flown.status, 0) << to_json(flown.result.at("notes"));
  EXPECT_EQ(failures(flown), "");
}

TEST_F(HiddenSubject, WhereItIsReportedAloneTheFilmIsCertified) {
  const Flown flown = film_of("4, 0, 1", kMesh, "--set line_of_sight=reported", "reported");
  EXPECT_EQ(flown.status, 0);
  EXPECT_EQ(failures(flown), "(line_of_sight) ");
}

TEST_F(HiddenSubject, InFrontOfTheMeshItIsCertified) {
  const Flown flown = film_of("-14, 0, 1", kMesh, "", "front");
  EXPECT_EQ(flown.status, 0) << to_json(flown.result);
  EXPECT_TRUE(verify(read_plan(flown.folder / "plan.json"), flown.folder).feasible());
  EXPECT_EQ(failures(flown), "");
}

}  // namespace
}  // namespace lapwing
