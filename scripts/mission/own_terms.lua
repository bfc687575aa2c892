-- SPDX-License-Identifier: Apache-2.0
-- Cost terms and constraints that a script adds to those of its mission kind: functions of a stage,
-- or plugins by name.
--
--   costs = { { name = "keep_low", weight = 5,
--               residual = function(s) return lapwing.max(s.position.z - 10, 0) end },
--             { type = "input_effort", weight = 0.1 } },
--   constraints = { { name = "west", upper = 4, value = function(s) return s.position.x end } },
--
-- All parameters of a plugin are options, and so are the name and the weight of a function, and the
-- bounds and the certificate of a constraint (`--set costs[1].weight=2`, `--set costs[2].height=6`,
-- `--set constraints[1].upper=5`). The problem receives and checks the other fields of a function.
local own = {}

local name = { name = "name", type = "text", summary = "name in messages and reports" }
own.declared = {
  { name = "costs", type = "plugins", kind = "cost_term", also = "lapwing.own_cost[]",
    summary = "additional cost terms",
    table = { name, { name = "weight", type = "number", default = 1, minimum = 0, maximum = 1e9,
                      summary = "factor on the squared residuals" } } },
  { name = "constraints", type = "plugins", kind = "constraint", also = "lapwing.own_constraint[]",
    summary = "additional constraints", table = { name },
    functions = {
      { name = "lower", type = "number",
        summary = "lower bound of a function; a script may list one for each value" },
      { name = "upper", type = "number",
        summary = "upper bound of a function; a script may list one for each value" },
      { name = "certificate", type = "choice", choices = { "required", "reported" },
        default = "required",
          summary = "effect on the certificate if a function violates its bounds" } } },
}

-- Whether a field of a function is an option. Lists of bounds can only be stated in the script.
local function settled(list, key, value)
  if key == "lower" or key == "upper" then
    return list == "constraints" and type(value) == "number" and math.abs(value) < math.huge
  end
  return key == "name" or key == "weight" or list == "constraints" and key == "certificate"
end

-- Takes out of `options`, which is changed, what is no plain data, and returns it.
function own.taken(options)
  local rest = {}
  for _, list in ipairs { "costs", "constraints" } do
    rest[list] = {}
    local given = options[list]
    if given ~= nil and type(given) ~= "table" then
      lapwing.fail(list .. ": expected a list of tables, got " .. type(given))
    end
    if given then options[list] = {} end
    for i, entry in ipairs(given or {}) do
      if type(entry) ~= "table" then
        lapwing.fail(string.format("%s[%d]: expected a table, got %s", list, i, type(entry)))
      end
      local kept, other = {}, {}
      for key, value in pairs(entry) do
        local plain = entry.type ~= nil and type(value) ~= "function"
                      or settled(list, key, value)
        if plain then kept[key] = value else other[key] = value end
      end
      if kept.weight and list == "constraints" then
        lapwing.fail(string.format("constraints[%d]: a constraint has no weight", i))
      end
      options[list][i], rest[list][i] = kept, other
    end
  end
  return rest
end

-- The names of the certificate's checks of the constraints that are functions, as a set.
function own.checks(options)
  local names = {}
  for _, entry in ipairs(options.constraints) do
    if not entry.type then names[own.check(entry.name)] = true end
  end
  return names
end

-- The name of the certificate's check of one constraint.
function own.check(constraint) return string.format('constraint "%s"', constraint) end

-- Adds them to a problem; `rest` is what own.taken returned. Where they are not `held`, constraints
-- are left to the certificate alone, and those of plugins out.
function own.add(p, options, rest, held)
  for list, add in pairs { costs = "add_cost", constraints = "add_constraint" } do
    for i, entry in ipairs(options[list] or {}) do
      local term = {}
      for key, value in pairs(rest[list][i] or {}) do term[key] = value end
      for key, value in pairs(entry) do term[key] = value end
      if list == "constraints" and entry.type then term.certificate = "listed" end
      if list == "constraints" and not held and not entry.type then term.held = false end
      if list == "costs" or held or not entry.type then p[add](p, term) end
    end
  end
end

return own
