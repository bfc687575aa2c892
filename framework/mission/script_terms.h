// SPDX-License-Identifier: Apache-2.0
// Cost terms and constraints written in a script:
//
//   p:add_cost { name = "keep_low", weight = 5,
//                residual = function(s) return lapwing.max(s.position.z - 10, 0) end }
//   p:add_constraint { name = "ceiling", upper = 30, value = function(s) return s.position.z end }
//   p:add_cost { name = "stay", parameters = { height = 3 },
//                residual = function(s, q) return s.position.z - q.height end }
//   p:set_parameter { term = "stay", name = "height", value = 4 }       -- between two solves
//
// They are noted when they are added and recorded when the problem is finished: only then are all
// blocks known.
#pragma once

#include <lua.hpp>

#include <string>
#include <vector>

#include "framework/mission/binding.h"
#include "framework/symbolic/written_term.h"

namespace lapwing {

struct ScriptTerm : WrittenTerm {
  int function = LUA_NOREF;  // in the registry
};

// What the plan of a solution says of these constraints: with their parameters as they are now.
std::vector<StatedConstraint> stated_constraints(const std::vector<ScriptTerm>& terms);

// What such terms are stated with, and what changes a parameter of one.
ParameterTable own_cost_table();
ParameterTable own_constraint_table();
ParameterTable term_parameter_table();
inline constexpr BoundField kOwnCostObjects[] = {
    {"residual", "fun(s: lapwing.stage, q: table): any",
     "function of a stage and the parameters: numbers and vectors whose squares are summed"},
    {"parameters?", "table<string, number|number[]>",
     "parameters, which can be changed between two solves"}};
inline constexpr BoundField kOwnConstraintObjects[] = {
    {"value", "fun(s: lapwing.stage, q: table): any",
     "function of a stage and the parameters: numbers and vectors that are bounded"},
    {"parameters?", "table<string, number|number[]>",
     "parameters, which can be changed between two solves"},
    {"lower?", "number|number[]", "bound of every result, or one for each"},
    {"upper?", "number|number[]", "bound of every result, or one for each"}};
inline constexpr BoundField kTermParameterValue[] = {{"value", "number|number[]", "new value"}};

// Whether the table at `index` states a term of the script's own. InputError where it also names a
// plugin.
bool is_script_term(lua_State* state, int index, WrittenTermKind kind);
ScriptTerm read_script_term(lua_State* state, int index, WrittenTermKind kind);
// Records the term and adds it to the problem, which keeps its parameters alive.
void add_script_term(lua_State* state, ScriptTerm& term, TrajectoryProblem& problem);
// Once the problem is finished: whether the term is what its function says, also where solvers
// begin.
void check_script_term(lua_State* state, ScriptTerm& term, const TrajectoryProblem& problem,
                       const Eigen::MatrixXd& guess);
// InputError where one of them has its name: `set_parameter` could not tell them apart.
void expect_new_name(const ScriptTerm& term, const std::vector<ScriptTerm>& terms);
// {term =, name =, value =} at `index`. InputError naming the terms or parameters there are.
void set_term_parameter(lua_State* state, int index, std::vector<ScriptTerm>& terms);

}  // namespace lapwing
