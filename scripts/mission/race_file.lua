-- SPDX-License-Identifier: Apache-2.0
-- Course files, and the declaration of gates in scripts and files.
local M = {}

local function number(name, unit, summary)
  return { name = name, type = "number", unit = unit, summary = summary }
end

-- A gate, in a script or in a file.
M.GATE = {
  { name = "name", type = "text", summary = "name in messages and reports" },
  { name = "shape", type = "choice", required = true, summary = "shape of the opening",
    choices = { "ball", "rectangle", "triangle", "pentagon", "hexagon" } },
  { name = "position", type = "numbers", size = 3, unit = "m", required = true,
    summary = "centre in the world" },
  number("normal_yaw_deg", "deg",
         "direction of flight: 0 is east, counter-clockwise; not for a ball"),
  number("normal_pitch_deg", "deg", "direction of flight, upwards; absent: 0"),
  number("width", "m", "width of a rectangle or triangle"),
  number("height", "m", "height of a rectangle or triangle"),
  number("radius", "m", "radius of a ball, or to the corners of a pentagon or hexagon"),
  number("side", "m", "side of a pentagon or hexagon"),
  number("tunnel_length", "m", "length of a tunnel, half of it before the gate; absent: 0"),
}

-- Courses that others publish name these angles without their unit, which is degrees.
local PUBLISHED = { normal_yaw = "normal_yaw_deg", normal_pitch = "normal_pitch_deg" }
local FILE_GATE = table.move(M.GATE, 1, #M.GATE, 1, {})
for _, name in ipairs { "normal_yaw", "normal_pitch" } do
  FILE_GATE[#FILE_GATE + 1] = number(name, "deg", PUBLISHED[name] .. " in published courses")
end

-- A gate of a file, by the names that gates have here.
local function gate_of_file(file, path)
  local gate = file:check(path, FILE_GATE)
  for published, name in pairs(PUBLISHED) do
    if gate[published] and gate[name] then
      file:fail(path .. "." .. published, "has the meaning of " .. name .. ": give one of them")
    end
    gate[published], gate[name] = nil, gate[name] or gate[published]
  end
  return gate
end

-- One error names every unknown key of the file.
local function check_keys(given, file)
  local keys, of_gate = { [""] = { "start", "end", "gates", "waypoints" } }, {}
  for i, declared in ipairs(FILE_GATE) do of_gate[i] = declared.name end
  for _, key in ipairs { "start", "end" } do
    if type(given) == "table" and type(given[key]) == "table" and #given[key] == 0 then
      keys[key] = { "position", "velocity" }
    end
  end
  local gates = type(given) == "table" and type(given.gates) == "table" and given.gates or {}
  for i, gate in ipairs(gates) do
    if type(gate) == "table" and next(gate) and #gate == 0 then
      keys[string.format("gates[%d]", i)] = of_gate
    end
  end
  file:expect_keys(keys)
end

-- The course of a file: {start =, finish =, gates =, keyframes =}, and what fails on its lines.
function M.read(name)
  local given, file
  if name:match("%.json$") then given, file = lapwing.read_json(name, "tracks")
  else given, file = lapwing.read_yaml(name, "tracks") end
  check_keys(given, file)
  for _, key in ipairs { "gates", "waypoints" } do
    if given[key] ~= nil and (type(given[key]) ~= "table" or #given[key] == 0) then
      file:fail(key, "expected a list")
    end
  end
  local gates = given.gates and {}
  for i in ipairs(given.gates or {}) do
    gates[i] = gate_of_file(file, string.format("gates[%d]", i))
  end
  local names = { keyframes = "waypoints", finish = "end" }  -- as the file has them
  local function fail(path, text) file:fail(path:gsub("^%a+", names), text) end
  return { start = given.start, finish = given["end"], gates = gates,
           keyframes = given.waypoints }, fail
end

return M
