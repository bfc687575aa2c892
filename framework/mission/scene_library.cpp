// SPDX-License-Identifier: Apache-2.0
// lapwing.scene and what a scene can be asked for: bodies, frames, colours, random numbers.
#include <lua.hpp>

#include <cmath>

#include "framework/mission/guard.h"
#include "framework/mission/run.h"
#include "framework/mission/scene_script.h"

namespace lapwing {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kMostCorners = 10'000;     // of a polygon
constexpr int kMostHeights = 4'000'000;  // of a terrain

SceneObject::Parts& parts(lua_State* state) {
  return *object_argument<SceneObject>(state, 1, kSceneType).parts;
}

double number_argument(lua_State* state, int index, const char* what) {
  int is_number = 0;
  const double number = lua_tonumberx(state, index, &is_number);
  if (!is_number || lua_type(state, index) != LUA_TNUMBER) {
    throw InputError(std::string(what) + ": expected a number, got " + luaL_typename(state, index));
  }
  return number;
}

double number_or(lua_State* state, int index, const char* what, double otherwise) {
  return lua_isnoneornil(state, index) ? otherwise : number_argument(state, index, what);
}

int integer_argument(lua_State* state, int index, const char* what) {
  const double number = number_argument(state, index, what);
  if (number != std::floor(number) || std::abs(number) > 1e9) {
    throw InputError(std::string(what) + ": expected a whole number");
  }
  return static_cast<int>(number);
}

// A list of exactly N numbers.
template <int N>
Eigen::Matrix<double, N, 1> vector_argument(lua_State* state, int index, const char* what) {
  Eigen::Matrix<double, N, 1> v;
  bool good = lua_istable(state, index) && static_cast<int>(lua_rawlen(state, index)) == N;
  for (int i = 0; good && i < N; ++i) {
    good = lua_rawgeti(state, index, i + 1) == LUA_TNUMBER;
    v[i] = lua_tonumber(state, -1);
    lua_pop(state, 1);
  }
  if (!good) {
    throw InputError(std::string(what) + ": expected a list of " + std::to_string(N) + " numbers");
  }
  return v;
}

// A list of points of N numbers each.
template <int N>
std::vector<Eigen::Matrix<double, N, 1>> points_argument(lua_State* state, int index,
                                                         const char* what) {
  const int count = lua_istable(state, index) ? static_cast<int>(lua_rawlen(state, index)) : 0;
  if (count < 3 || count > kMostCorners) {
    throw InputError(std::string(what) + ": expected a list of at least three corners");
  }
  std::vector<Eigen::Matrix<double, N, 1>> points;
  for (int i = 1; i <= count; ++i) {
    lua_rawgeti(state, index, i);
    points.push_back(vector_argument<N>(state, lua_gettop(state), what));
    lua_pop(state, 1);
  }
  return points;
}

ParameterTable new_scene_table() {
  ParameterTable table;
  table.required_text("name", "name of the scene")
      .integer("seed", 1, "seed of its random numbers", at_least(0));
  return table;
}

// lapwing.scene{name = "street", seed = 1}
int scene(lua_State* state) {
  const Parameters given = table_argument(state, 1, new_scene_table(), "lapwing.scene");
  SceneObject object{
      std::make_shared<SceneObject::Parts>(static_cast<std::uint64_t>(given.integer("seed")))};
  object.parts->name = given.text("name");
  new_object(state, kSceneType, std::move(object));
  return 1;
}

// scene:color(red, green, blue), 0 to 255
int color(lua_State* state) {
  Rgb rgb{};
  for (int i = 0; i < 3; ++i) {
    const double v = number_argument(state, 2 + i, "color");
    if (!(v >= 0 && v <= 255)) throw InputError("color: expected numbers from 0 to 255");
    rgb[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(std::lround(v));
  }
  parts(state).builder.set_color(rgb);
  return 0;
}

// scene:push(origin [, yaw [, scale]]) and scene:pop()
int push(lua_State* state) {
  parts(state).builder.push(vector_argument<3>(state, 2, "push"), number_or(state, 3, "push", 0),
                            number_or(state, 4, "push", 1));
  return 0;
}

int pop(lua_State* state) {
  parts(state).builder.pop();
  return 0;
}

int face(lua_State* state) {
  parts(state).builder.face(points_argument<3>(state, 2, "face"));
  return 0;
}

int quad(lua_State* state) {
  const auto corner = [&](int i) { return vector_argument<3>(state, 2 + i, "quad"); };
  parts(state).builder.quad(corner(0), corner(1), corner(2), corner(3));
  return 0;
}

int box(lua_State* state) {
  parts(state).builder.box(vector_argument<3>(state, 2, "box"),
                           vector_argument<3>(state, 3, "box"));
  return 0;
}

// scene:prism(corners, floor, ceiling)
int prism(lua_State* state) {
  parts(state).builder.prism(points_argument<2>(state, 2, "prism"),
                             number_argument(state, 3, "prism"),
                             number_argument(state, 4, "prism"));
  return 0;
}

// scene:tube(from, to, radius [, radius at `to` [, sides]])
int tube(lua_State* state) {
  const double radius = number_argument(state, 4, "tube");
  const int sides = lua_isnoneornil(state, 6) ? 8 : integer_argument(state, 6, "tube");
  parts(state).builder.tube(vector_argument<3>(state, 2, "tube"),
                            vector_argument<3>(state, 3, "tube"), radius,
                            number_or(state, 5, "tube", radius), sides);
  return 0;
}

// scene:ball(center, radii [, detail [, roughness]])
int ball(lua_State* state) {
  const int detail = lua_isnoneornil(state, 4) ? 1 : integer_argument(state, 4, "ball");
  parts(state).builder.ball(vector_argument<3>(state, 2, "ball"),
                            vector_argument<3>(state, 3, "ball"), detail,
                            number_or(state, 5, "ball", 0));
  return 0;
}

// scene:terrain(corner, step, columns, heights)
int terrain(lua_State* state) {
  const auto count = lua_istable(state, 5) ? lua_rawlen(state, 5) : 0;
  if (count < 4 || count > kMostHeights) {
    throw InputError("terrain: expected a list of four to four million heights");
  }
  std::vector<double> heights;
  for (lua_Unsigned i = 1; i <= count; ++i) {
    lua_rawgeti(state, 5, static_cast<lua_Integer>(i));
    heights.push_back(number_argument(state, lua_gettop(state), "terrain: a height"));
    lua_pop(state, 1);
  }
  parts(state).builder.terrain(vector_argument<2>(state, 2, "terrain"),
                               number_argument(state, 3, "terrain"),
                               integer_argument(state, 4, "terrain"), heights);
  return 0;
}

// scene:region(lower, upper): the region of interest
int region(lua_State* state) {
  const Vector3d lower = vector_argument<3>(state, 2, "region");
  const Vector3d upper = vector_argument<3>(state, 3, "region");
  if (!(lower.array() < upper.array()).all()) {
    throw InputError("region: lower must be below upper on every axis");
  }
  parts(state).region = {lower, upper};
  return 0;
}

// scene:moves{step = 0.7, clear = 2}: how explorations of it should move
int moves(lua_State* state) {
  parts(state).moves = table_argument(state, 2, scene_moves_table(), "moves").value();
  return 0;
}

// scene:uniform(low, high), scene:integer(low, high): the scene's own random numbers
int uniform(lua_State* state) {
  const double low = number_argument(state, 2, "uniform");
  const double high = number_argument(state, 3, "uniform");
  if (!(low < high)) throw InputError("uniform: expected the first number below the second");
  lua_pushnumber(state, parts(state).random.uniform(low, high));
  return 1;
}

int integer(lua_State* state) {
  const int low = integer_argument(state, 2, "integer");
  const int high = integer_argument(state, 3, "integer");
  if (low > high) throw InputError("integer: expected the first number not above the second");
  lua_pushinteger(state, static_cast<lua_Integer>(parts(state).random.integer(low, high)));
  return 1;
}

// scene:triangles(): how many there are so far
int triangles(lua_State* state) {
  lua_pushinteger(state, static_cast<lua_Integer>(parts(state).builder.mesh().triangles.size()));
  return 1;
}

}  // namespace

ParameterTable scene_moves_table() {
  return ParameterTable()
      .optional_number("step", "m", "step to a neighbour", above(0))
      .optional_number("turn_deg", "deg", "turn to a neighbour", between(1, 180))
      .optional_number("body", "m", "edge of the box that must be free", above(0))
      .optional_number("clear", "m", "edge of the box that is free at the start", above(0))
      .optional_number("speed", "m/s", "speed between viewpoints", above(0));
}

void open_scene_library(lua_State* state) {
  static const Binding methods[] = {
      {"color", &guarded<color>, "(red: number, green: number, blue: number)",
       "sets the colour of the following parts, 0 to 255"},
      {"push", &guarded<push>, "(origin: number[], yaw?: number, scale?: number)",
       "begins a coordinate frame for the following parts"},
      {"pop", &guarded<pop>, "()", "ends the current frame"},
      {"quad", &guarded<quad>, "(a: number[], b: number[], c: number[], d: number[])",
       "a flat face, seen from the side on which its corners go counter-clockwise"},
      {"face", &guarded<face>, "(corners: number[][])",
       "a flat face with any number of corners, seen as `quad`"},
      {"box", &guarded<box>, "(lower: number[], upper: number[])", "a box"},
      {"prism", &guarded<prism>, "(corners: number[][], floor: number, ceiling: number)",
       "a body over {x, y} corners"},
      {"tube", &guarded<tube>,
       "(from: number[], to: number[], radius: number, radius_to?: number, sides?: integer)",
       "a bar, or a cone"},
      {"ball", &guarded<ball>,
       "(center: number[], radii: number[], detail?: integer, roughness?: number)", "an ellipsoid"},
      {"terrain", &guarded<terrain>,
       "(corner: number[], step: number, columns: integer, heights: number[])",
       "a surface over a grid"},
      {"region", &guarded<region>, "(lower: number[], upper: number[])",
       "sets the region of interest, which a scene needs"},
      {"moves", &guarded<moves>, "(moves: @)",
       "sets the motions that explorations of it use by default, such as smaller steps indoors",
       &scene_moves_table},
      {"uniform", &guarded<uniform>, "(low: number, high: number): number",
       "a random number between both, from the seed of the scene"},
      {"integer", &guarded<integer>, "(low: integer, high: integer): integer",
       "a random integer between both, from the seed of the scene"},
      {"triangles", &guarded<triangles>, "(): integer", "number of triangles so far"}};
  static const Binding functions[] = {{"scene", &guarded<scene>, "(settings: @): lapwing.scene",
                                       "an empty scene, in metres", &new_scene_table}};
  define_type<SceneObject>(state, kSceneType, {methods});
  lua_getglobal(state, "lapwing");
  bind_functions(state, "lapwing", functions);
  lua_pop(state, 1);
}

}  // namespace lapwing
