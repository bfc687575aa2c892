-- SPDX-License-Identifier: Apache-2.0
-- How polygons on the ground are stated: in metres, as latitude and longitude, in a reference
-- system, or by a file.
local M = {}

M.CORNERS = {
  { name = "corners", type = "numbers", also = "number[][]",
    summary = "corners of the polygon: {{x, y}, ...}, in metres or in the system `coordinates`" },
  { name = "corners_deg", type = "numbers", unit = "deg", also = "number[][]",
    summary = "corners as latitude and longitude of WGS 84: {{latitude, longitude}, ...}" },
}

-- The declarations of a polygon, with others behind them.
function M.polygon(others)
  local all = {
    { name = "name", type = "text", default = "", summary = "name in messages and reports" },
    M.CORNERS[1], M.CORNERS[2],
    { name = "file", type = "text", default = "",
      summary = "GeoJSON or KML file of polygons, in place of corners" },
    { name = "named", type = "text", default = "",
      summary = "only what has this name is taken from the file" },
  }
  return table.move(others, 1, #others, #all + 1, all)
end

-- {{x, y}, ...} as {x, y, ...}
local function flat(list)
  if type(list) ~= "table" then return list end
  local numbers = {}
  for _, entry in ipairs(list) do
    for _, number in ipairs(type(entry) == "table" and entry or { entry }) do
      numbers[#numbers + 1] = number
    end
  end
  return numbers
end

local function flat_entry(entry)
  if type(entry) ~= "table" then return entry end
  local copy = {}
  for key, value in pairs(entry) do copy[key] = value end
  copy.corners, copy.corners_deg = flat(copy.corners), flat(copy.corners_deg)
  if type(copy.holes) == "table" then
    local holes = {}
    for i, hole in ipairs(copy.holes) do holes[i] = flat_entry(hole) end
    copy.holes = holes
  end
  return copy
end

-- The options of a scan with lists of pairs as lists of numbers.
function M.written_out(given)
  local out = {}
  for key, value in pairs(given) do out[key] = value end
  for _, option in ipairs { "regions", "no_fly_zones", "flight_zones" } do
    if type(out[option]) == "table" then
      local list = {}
      for i, entry in ipairs(out[option]) do list[i] = flat_entry(entry) end
      out[option] = list
    end
  end
  return out
end

-- The option that a message is about, and the message without it: run:fail adds its place. A file
-- that is missing is told with the place of the option that names it.
local function placed(path, why)
  local found = why:find(path, 1, true)
  if not found then return path, why end
  local option, message = why:sub(found):match("^([^:]*): (.*)$")
  if option == path or option == path .. ".file" then return option, message end
  return path, why
end

-- The prisms of all entries of an option, and the numbers of these entries. `low` and `high` name
-- the keys of the lower and the upper end. `heights` says what these are above, as the option of
-- that name does; `ground_level` is the height of level ground.
function M.prisms(run, option, low, high, heights, ground_level)
  local o, all, numbers = run.options, {}, {}
  for i, entry in ipairs(o[option]) do
    local path = string.format("%s[%d]", option, i)
    local prisms, why = run:prisms {
      what = path, name = entry.name, corners = entry.corners, corners_deg = entry.corners_deg,
      file = entry.file, named = entry.named, holes = entry.holes, low = entry[low],
      high = entry[high], weight = entry.weight, coordinates = o.coordinates,
      heights = heights ~= "unstated" and heights or "", ground_level = ground_level }
    if not prisms then
      local option, message = placed(path, why)
      run:fail(option, message)
    end
    for _, prism in ipairs(prisms) do all[#all + 1], numbers[#numbers + 1] = prism, i end
  end
  return all, numbers
end

-- The lower and the upper corner of the box around the outlines of prisms: {x, y}.
function M.across(prisms)
  local lower, upper = { math.huge, math.huge }, { -math.huge, -math.huge }
  for _, prism in ipairs(prisms) do
    for i, number in ipairs(prism.corners) do
      local axis = 2 - i % 2
      lower[axis], upper[axis] = math.min(lower[axis], number), math.max(upper[axis], number)
    end
  end
  return lower, upper
end

return M
