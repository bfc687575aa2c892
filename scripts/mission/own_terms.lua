-- Cost terms and constraints that a script brings along, beside those of its kind of mission: a
-- function of a stage, or a plugin by name.
--
--   costs = { { name = "keep_low", weight = 5,
--               residual = function(s) return lapwing.max(s.position.z - 10, 0) end },
--             { type = "input_effort", weight = 0.1 } },
--   constraints = { { name = "west", upper = 4, value = function(s) return s.position.x end } },
--
-- Name, type and weight are options as any other (`--set costs[1].weight=2`); the rest is handed on
-- to the problem, which checks it.
local own = {}

local name = { name = "name", type = "text", summary = "for messages and reports" }
local plugin = { name = "type", type = "text", summary = "a plugin; absent: a function is given" }

own.declared = {
  { name = "costs", type = "tables", summary = "cost terms beside those of the mission",
    also = "(lapwing.cost_term|lapwing.own_cost)[]", table = {
    name, plugin, { name = "weight", type = "number", default = 1, minimum = 0, maximum = 1e9,
                    summary = "of its squares" } } },
  { name = "constraints", type = "tables", summary = "constraints beside those of the mission",
    also = "(lapwing.constraint|lapwing.own_constraint)[]", table = { name, plugin } },
}
local settled = { name = true, type = true, weight = true }

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
      for key, value in pairs(entry) do (settled[key] and kept or other)[key] = value end
      if kept.weight and list == "constraints" then
        lapwing.fail(string.format("constraints[%d]: a constraint has no weight", i))
      end
      options[list][i], rest[list][i] = kept, other
    end
  end
  return rest
end

-- Adds them to a problem; `rest` is what own.taken returned.
function own.add(p, options, rest)
  for list, add in pairs { costs = "add_cost", constraints = "add_constraint" } do
    for i, entry in ipairs(options[list] or {}) do
      local term = {}
      for key, value in pairs(rest[list][i] or {}) do term[key] = value end
      for key, value in pairs(entry) do term[key] = value end
      p[add](p, term)
    end
  end
end

return own
