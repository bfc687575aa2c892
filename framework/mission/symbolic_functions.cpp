// SPDX-License-Identifier: Apache-2.0
// The functions of the table `lapwing` that terms are written with.
#include "framework/mission/guard.h"
#include "framework/mission/symbolic_values.h"

namespace lapwing {

namespace {

constexpr const char* name_of(TapeOp op) {
  switch (op) {
    case TapeOp::sin:
      return "lapwing.sin";
    case TapeOp::cos:
      return "lapwing.cos";
    case TapeOp::tan:
      return "lapwing.tan";
    case TapeOp::exp:
      return "lapwing.exp";
    case TapeOp::log:
      return "lapwing.log";
    case TapeOp::sqrt:
      return "lapwing.sqrt";
    default:
      return "lapwing.abs";
  }
}

double rounding(lua_State* state) {
  const SymbolicSetting* setting = symbolic_setting(state);
  return setting ? setting->width : 0.0;
}

void expect_count(lua_State* state, const char* what, int least, int most) {
  const int given = lua_gettop(state);
  if (given >= least && given <= most) return;
  refuse_symbolic(state, std::string(what) + ": expected " + std::to_string(least) +
                             (least == most ? "" : " or more") + " values, got " +
                             std::to_string(given));
}

template <TapeOp kOp>
int function_of_one(lua_State* state) {
  expect_count(state, name_of(kOp), 1, 1);
  const double width = kOp == TapeOp::absolute ? rounding(state) : 0.0;
  push_symbolic(state, symbolic_result(symbolic_setting(state), kOp,
                                       symbolic_argument(state, 1, name_of(kOp)), {}, {}, width));
  return 1;
}

int angle_of_two(lua_State* state) {
  expect_count(state, "lapwing.atan2", 2, 2);
  const SymbolicScalar y = symbolic_argument(state, 1, "lapwing.atan2");
  push_symbolic(state, symbolic_result(symbolic_setting(state), TapeOp::atan2, y,
                                       symbolic_argument(state, 2, "lapwing.atan2")));
  return 1;
}

template <bool kLargest>
int extreme_function(lua_State* state) {
  constexpr const char* kName = kLargest ? "lapwing.max" : "lapwing.min";
  constexpr int kMost = 200;
  expect_count(state, kName, 1, kMost);
  SymbolicEntries entries;
  for (int i = 1; i <= lua_gettop(state); ++i)
    entries.push_back(symbolic_argument(state, i, kName));
  push_symbolic(state, symbolic_extreme(symbolic_setting(state), entries, kLargest));
  return 1;
}

int where_function(lua_State* state) {
  expect_count(state, "lapwing.where", 3, 3);
  if (lua_isboolean(state, 1))
    refuse_symbolic(state,
                    "lapwing.where: expected a number, got a truth value: write x - 3 for "
                    "x > 3; lapwing.where(x, a, b) is a where x > 0");
  const SymbolicScalar choice = symbolic_argument(state, 1, "lapwing.where");
  const auto chosen = [&](const SymbolicScalar& a, const SymbolicScalar& b) {
    return symbolic_choice(symbolic_setting(state), choice, a, b);
  };
  if (is_symbolic_scalar(state, 2) && is_symbolic_scalar(state, 3)) {
    push_symbolic(state, chosen(symbolic_argument(state, 2, "lapwing.where"),
                                symbolic_argument(state, 3, "lapwing.where")));
    return 1;
  }
  SymbolicEntries a = symbolic_vector_argument(state, 2, "lapwing.where");
  const SymbolicEntries b =
      symbolic_vector_argument(state, 3, "lapwing.where", static_cast<int>(a.size()));
  for (std::size_t i = 0; i < a.size(); ++i) a[i] = chosen(a[i], b[i]);
  push_symbolic_vector(state, std::move(a));
  return 1;
}

int dot_function(lua_State* state) {
  expect_count(state, "lapwing.dot", 2, 2);
  const SymbolicEntries a = symbolic_vector_argument(state, 1, "lapwing.dot");
  const SymbolicEntries b =
      symbolic_vector_argument(state, 2, "lapwing.dot", static_cast<int>(a.size()));
  push_symbolic(state, symbolic_dot(symbolic_setting(state), a, b));
  return 1;
}

int cross_function(lua_State* state) {
  expect_count(state, "lapwing.cross", 2, 2);
  const SymbolicEntries a = symbolic_vector_argument(state, 1, "lapwing.cross", 3);
  const SymbolicEntries b = symbolic_vector_argument(state, 2, "lapwing.cross", 3);
  push_symbolic_vector(state, symbolic_cross(symbolic_setting(state), a, b));
  return 1;
}

int norm_function(lua_State* state) {
  expect_count(state, "lapwing.norm", 1, 1);
  push_symbolic(state, symbolic_length(symbolic_setting(state),
                                       symbolic_vector_argument(state, 1, "lapwing.norm")));
  return 1;
}

int normalize_function(lua_State* state) {
  expect_count(state, "lapwing.normalize", 1, 1);
  SymbolicEntries v = symbolic_vector_argument(state, 1, "lapwing.normalize");
  const SymbolicScalar length = symbolic_length(symbolic_setting(state), v);
  for (SymbolicScalar& entry : v)
    entry = symbolic_result(symbolic_setting(state), TapeOp::divide, entry, length);
  push_symbolic_vector(state, std::move(v));
  return 1;
}

// lapwing.vector(x, y, z) or lapwing.vector{x, y, z}
int make_vector(lua_State* state) {
  expect_count(state, "lapwing.vector", 1, 64);
  if ((lua_istable(state, 1) || is_symbolic_vector(state, 1))) {
    push_symbolic_vector(state, symbolic_vector_argument(state, 1, "lapwing.vector"));
    return 1;
  }
  SymbolicEntries entries;
  for (int i = 1; i <= lua_gettop(state); ++i)
    entries.push_back(symbolic_argument(state, i, "lapwing.vector"));
  push_symbolic_vector(state, std::move(entries));
  return 1;
}

}  // namespace

void open_symbolic_functions(lua_State* state) {
  static constexpr const char* kOne = "(x: lapwing.value): lapwing.value";
  static constexpr const char* kMany = "(...: lapwing.value): lapwing.value";
  static const Binding functions[] = {
      {"sin", &guarded<function_of_one<TapeOp::sin>>, kOne, "sine of an angle in rad"},
      {"cos", &guarded<function_of_one<TapeOp::cos>>, kOne, "cosine of an angle in rad"},
      {"tan", &guarded<function_of_one<TapeOp::tan>>, kOne, "tangent of an angle in rad"},
      {"exp", &guarded<function_of_one<TapeOp::exp>>, kOne, "e to the power of x"},
      {"log", &guarded<function_of_one<TapeOp::log>>, kOne, "the natural logarithm"},
      {"sqrt", &guarded<function_of_one<TapeOp::sqrt>>, kOne, "the square root"},
      {"abs", &guarded<function_of_one<TapeOp::absolute>>, kOne,
       "the absolute value, smoothed at 0"},
      {"atan2", &guarded<angle_of_two>, "(y: lapwing.value, x: lapwing.value): lapwing.value",
       "the angle of {x, y}, rad"},
      {"max", &guarded<extreme_function<true>>, kMany,
       "the largest value, smoothed where two are equal"},
      {"min", &guarded<extreme_function<false>>, kMany,
       "the smallest value, smoothed where two are equal"},
      {"where", &guarded<where_function>,
       "(x: lapwing.value, a: lapwing.value, b: lapwing.value): lapwing.value",
       "a if x > 0, otherwise b"},
      {"dot", &guarded<dot_function>, "(a: lapwing.vector, b: lapwing.vector): lapwing.value",
       "the scalar product"},
      {"cross", &guarded<cross_function>, "(a: lapwing.vector, b: lapwing.vector): lapwing.vector",
       "the vector product"},
      {"norm", &guarded<norm_function>, "(v: lapwing.vector): lapwing.value",
       "the length, smoothed at 0"},
      {"normalize", &guarded<normalize_function>, "(v: lapwing.vector): lapwing.vector",
       "the vector scaled to length 1"},
      {"vector", &guarded<make_vector>, "(...: lapwing.value): lapwing.vector",
       "a vector of these numbers"}};
  lua_getglobal(state, "lapwing");
  bind_functions(state, "lapwing", functions);
  lua_pop(state, 1);
}

}  // namespace lapwing
