// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/script_terms.h"

#include <algorithm>
#include <vector>

#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/run.h"
#include "framework/mission/term_recording.h"
#include "framework/problem/time_spans.h"

namespace lapwing {

namespace {

constexpr double kDefaultWidth = 1e-3;

const char* function_key(WrittenTermKind kind) {
  return kind == WrittenTermKind::cost ? "residual" : "value";
}
const char* word_of(WrittenTermKind kind) {
  return kind == WrittenTermKind::cost ? "cost" : "constraint";
}

ParameterTable script_term_table(WrittenTermKind kind) {
  ParameterTable table;
  table.required_text("name", "its name in this problem, for messages and reports")
      .integer("window", 1, "smallest number of neighbouring stages that it reads", between(1, 64))
      .number("smoothing", kDefaultWidth, "",
              "width of the rounding of max, min, abs and norm; 0: none", at_least(0))
      .numbers("times", {}, "s", "times of evaluation; none: every stage", at_least(0))
      .tables("spans", time_span_table(), "spans of evaluation; none: always")
      .tables("except", time_span_table(), "spans without evaluation");
  if (kind == WrittenTermKind::constraint)
    table
        .choice("certificate", "required", {"required", "reported"},
                "effect of a violation on the certificate")
        .boolean("held", true,
                 "whether the solver holds it; false: only the certificate checks it");
  if (kind == WrittenTermKind::cost)
    table.number("weight", 1.0, "", "weight of the squared residuals", at_least(0))
        .boolean("integral", true,
                 "integrate the squares over time; false, and at given times: sum them");
  return table;
}

// A number, or a list of them.
std::vector<double> numbers_of(const Value& value, const std::string& what) {
  std::vector<double> numbers;
  if (value.is_number()) return {value.as_number()};
  if (value.is_list())
    for (const Value& entry : value.as_list())
      if (entry.is_number()) numbers.push_back(entry.as_number());
  if (!value.is_list() || numbers.empty() || numbers.size() != value.as_list().size())
    throw InputError(value.origin(), what + ": expected a number or a list of numbers, got " +
                                         value.describe_type());
  return numbers;
}

Value field_value(lua_State* state, int index, const char* key, const Origin& origin,
                  const std::string& what) {
  lua_getfield(state, index, key);
  const Value value =
      lua_isnil(state, -1) ? Value() : value_from_lua(state, lua_gettop(state), origin, what);
  lua_pop(state, 1);
  return value;
}

void read_parameters(const Value& given, ScriptTerm& term) {
  if (given.is_null() || given == Value::list()) return;
  if (!given.is_map())
    throw InputError(
        given.origin(),
        term.name + ": parameters: expected {name = number, ...}, got " + given.describe_type());
  for (const auto& [key, value] : given.as_map()) {
    const std::vector<double> numbers = numbers_of(value, term.name + ": parameters." + key);
    std::vector<double>& all = *term.parameters.values;
    term.parameters.list.push_back(
        {key, static_cast<int>(all.size()), static_cast<int>(numbers.size()), value.is_number()});
    all.insert(all.end(), numbers.begin(), numbers.end());
  }
}

std::string one_of(const std::vector<std::string>& known) {
  std::string text;
  for (const std::string& name : known) text += (text.empty() ? "'" : ", '") + name + "'";
  return text.empty() ? "there are none" : "there is " + text;
}

}  // namespace

ParameterTable own_cost_table() {
  return script_term_table(WrittenTermKind::cost);
}

ParameterTable own_constraint_table() {
  return script_term_table(WrittenTermKind::constraint);
}

ParameterTable term_parameter_table() {
  ParameterTable table;
  table.required_text("term", "name of a term of the script")
      .required_text("name", "name of one of its parameters");
  return table;
}

namespace {

// The commonest slip: `value` for `residual`, or a slip of the pen. `index` is a table without a
// plugin's `type` and without the function's own key.
void refuse_misnamed_function(lua_State* state, int index, WrittenTermKind kind) {
  std::vector<std::string> names;
  lua_pushnil(state);
  while (lua_next(state, index)) {
    if (lua_isfunction(state, -1) && lua_type(state, -2) == LUA_TSTRING)
      names.push_back(text_argument(state, -2, word_of(kind)));
    lua_pop(state, 1);
  }
  if (names.empty()) return;
  const std::string& first = *std::min_element(names.begin(), names.end());
  push_text(state, first);
  lua_rawget(state, index);
  throw InputError(place_of_function(state, lua_gettop(state)),
                   std::string("add_") + word_of(kind) + ": '" + first +
                       "' is a function; did you mean `" + function_key(kind) +
                       "`, which is the function of a " + word_of(kind) + "'s own?");
}

// "add_cost 'keep_low'", as messages call what is wrong in its table.
std::string call_of(lua_State* state, int index, WrittenTermKind kind) {
  std::string call = std::string("add_") + word_of(kind);
  if (lua_getfield(state, index, "name") == LUA_TSTRING)
    call += std::string(" '") + lua_tostring(state, -1) + "'";
  lua_pop(state, 1);
  return call;
}

// Where the function is written, which stands in the term's own table; else the line that is run.
Origin origin_of_term(lua_State* state, int index, WrittenTermKind kind) {
  Origin place;
  if (lua_getfield(state, index, function_key(kind)) == LUA_TFUNCTION)
    place = place_of_function(state, lua_gettop(state));
  lua_pop(state, 1);
  return place.line > 0 ? place : Sandbox::of(state).script_position(state);
}

}  // namespace

bool is_script_term(lua_State* state, int index, WrittenTermKind kind) {
  if (!lua_istable(state, index)) return false;
  const bool has_type = lua_getfield(state, index, "type") != LUA_TNIL;
  const int own = lua_getfield(state, index, function_key(kind));
  lua_pop(state, 2);
  if (has_type && own == LUA_TFUNCTION)
    throw InputError(Sandbox::of(state).script_position(state),
                     std::string("add_") + word_of(kind) + ": give a plugin's `type` or a `" +
                         function_key(kind) + "`, not both");
  if (!has_type && own == LUA_TNIL) refuse_misnamed_function(state, index, kind);
  return !has_type && own != LUA_TNIL;
}

ScriptTerm read_script_term(lua_State* state, int index, WrittenTermKind kind) {
  // What belongs to the other kind is left to the check, which says that it is unknown.
  const std::span<const BoundField> apart = kind == WrittenTermKind::constraint
                                                ? std::span<const BoundField>(kOwnConstraintObjects)
                                                : std::span<const BoundField>(kOwnCostObjects);
  const std::string call = call_of(state, index, kind);
  ScriptTerm term;
  term.kind = kind;
  term.origin = origin_of_term(state, index, kind);
  std::vector<std::string_view> without;
  for (const BoundField& field : apart) {
    const std::string_view key = field.name;
    without.push_back(key.ends_with('?') ? key.substr(0, key.size() - 1) : key);
  }
  const Parameters given = check(script_term_table(kind),
                                 value_from_lua(state, index, term.origin, call, without), call);
  term.name = given.text("name");
  term.width = given.number("smoothing");
  term.shape.window = static_cast<int>(given.integer("window"));
  const auto times = given.numbers("times");
  term.shape.times.assign(times.begin(), times.end());
  term.shape.spans = time_spans(given, "spans");
  term.shape.except = time_spans(given, "except");
  const bool timed = !term.shape.times.empty();
  if (timed && !(term.shape.spans.empty() && term.shape.except.empty()))
    throw InputError(term.origin, call + ": give times or spans, not both");
  if (kind == WrittenTermKind::cost) {
    term.weight = given.number("weight");
    term.shape.integral = given.boolean("integral") && !timed;
  } else {
    term.required = given.text("certificate") == "required";
    term.held = given.boolean("held");
    const Value lower = field_value(state, index, "lower", term.origin, call + ".lower");
    const Value upper = field_value(state, index, "upper", term.origin, call + ".upper");
    if (lower.is_null() && upper.is_null())
      throw InputError(term.origin, call + ": give `lower`, `upper` or both: what '" + term.name +
                                        "' must stay between");
    if (!lower.is_null()) term.lower = numbers_of(lower, call + ".lower");
    if (!upper.is_null()) term.upper = numbers_of(upper, call + ".upper");
  }
  read_parameters(field_value(state, index, "parameters", term.origin, call + ".parameters"), term);
  if (lua_getfield(state, index, function_key(kind)) != LUA_TFUNCTION || lua_iscfunction(state, -1))
    throw InputError(term.origin,
                     call + ": " + function_key(kind) +
                         ": expected a function of a stage, function(s) return ... end, got " +
                         (lua_iscfunction(state, -1) ? "one that is not written in Lua"
                                                     : describe_symbolic(state, -1)));
  term.function = luaL_ref(state, LUA_REGISTRYINDEX);
  return term;
}

std::vector<StatedConstraint> stated_constraints(const std::vector<ScriptTerm>& terms) {
  std::vector<StatedConstraint> all;
  for (const ScriptTerm& term : terms)
    if (term.kind == WrittenTermKind::constraint) all.push_back(stated_constraint(term));
  return all;
}

void add_script_term(lua_State* state, ScriptTerm& term, TrajectoryProblem& problem) {
  TermFormula formula(term.what(), problem, term.parameters, term.width);
  lua_rawgeti(state, LUA_REGISTRYINDEX, term.function);
  const Origin place = place_of_function(state, lua_gettop(state));
  const SymbolicEntries rows = TermRecording(state, formula).record(lua_gettop(state));
  lua_pop(state, 1);
  add_written_term(term, formula, rows, place, problem);
}

void check_script_term(lua_State* state, ScriptTerm& term, const TrajectoryProblem& problem,
                       const Eigen::MatrixXd& guess) {
  TermFormula formula(term.what(), problem, term.parameters, term.width);
  lua_rawgeti(state, LUA_REGISTRYINDEX, term.function);
  TermRecording(state, formula).check(lua_gettop(state), term.shape, guess);
  lua_pop(state, 1);
  luaL_unref(state, LUA_REGISTRYINDEX, term.function);
  term.function = LUA_NOREF;
}

void expect_new_name(const ScriptTerm& term, const std::vector<ScriptTerm>& terms) {
  for (const ScriptTerm& other : terms)
    if (other.name == term.name)
      throw InputError(term.origin, std::string("add_") + word_of(term.kind) + " '" + term.name +
                                        "': there is a term of that name already (" +
                                        other.origin.to_string() + "); give it another name");
}

void set_term_parameter(lua_State* state, int index, std::vector<ScriptTerm>& terms) {
  const Parameters given =
      table_argument(state, index, term_parameter_table(), "set_parameter", kTermParameterValue);
  const Value value = field_value(state, index, "value", given.origin(), "set_parameter.value");
  const auto term = std::find_if(terms.begin(), terms.end(), [&](const ScriptTerm& entry) {
    return entry.name == given.text("term");
  });
  std::vector<std::string> known;
  if (term == terms.end()) {
    for (const ScriptTerm& entry : terms) known.push_back(entry.name);
    throw InputError(given.origin(), "set_parameter: no term '" + given.text("term") +
                                         "' of the script; " + one_of(known));
  }
  for (const TermParameter& parameter : term->parameters.list) {
    known.push_back(parameter.name);
    if (parameter.name != given.text("name")) continue;
    const std::vector<double> numbers = numbers_of(value, "set_parameter: value");
    if (static_cast<int>(numbers.size()) != parameter.size)
      throw InputError(given.origin(), "set_parameter: '" + parameter.name + "' has " +
                                           std::to_string(parameter.size) + " numbers, got " +
                                           std::to_string(numbers.size()));
    std::copy(numbers.begin(), numbers.end(), term->parameters.values->begin() + parameter.first);
    return;
  }
  throw InputError(given.origin(), "set_parameter: '" + term->name + "' has no parameter '" +
                                       given.text("name") + "'; " + one_of(known));
}

}  // namespace lapwing
