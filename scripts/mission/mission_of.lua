-- SPDX-License-Identifier: Apache-2.0
-- A mission of a kind: its name, and its options as declared and given. Whatever flies has an
-- origin and a home.
local ORIGIN = {
  name = "origin", type = "table", summary = "place of the world's origin on the earth",
  table = {
    { name = "latitude_deg", type = "number", unit = "deg", minimum = -90, maximum = 90,
      summary = "degrees north" },
    { name = "longitude_deg", type = "number", unit = "deg", minimum = -180, maximum = 180,
      summary = "degrees east" },
    { name = "height", type = "number", unit = "m",
      summary = "height of the point z = 0 above the reference `height_of`" },
    { name = "height_of", type = "choice", choices = { "ellipsoid", "sea", "ground" },
      summary = "reference of `height`: the ellipsoid of WGS 84; the geoid, as on maps (AMSL); "
        .. "or the ground at the origin" },
  },
}

local PLACE = { name = "position", type = "numbers", size = 3, unit = "m", minimum = -1e6,
                maximum = 1e6 }

local function place(summary, required)
  local declared = { summary = summary, required = required }
  for key, value in pairs(PLACE) do declared[key] = value end
  return declared
end

local HOME = {
  name = "home", type = "table", summary = "take-off place, and the limits that count from it",
  table = {
    place("position on the ground: east, north, up"),
    { name = "max_height", type = "number", unit = "m", above = 0, maximum = 1e5,
      summary = "largest height of the flight above it; absent: none" },
    { name = "max_distance", type = "number", unit = "m", above = 0, maximum = 1e6,
      summary = "largest horizontal distance of the flight from it; absent: none" },
    { name = "rally_points", type = "tables",
      summary = "places to which the vehicle may go in place of home after a failure",
      table = { place("position in the air: east, north, up", true) } },
  },
}

return function(kind, declarations, given, plan)
  local name = given.name
  given.name = nil
  if kind == "map" then
    return { kind = kind, name = name, options = lapwing.options(declarations, given), plan = plan }
  end
  local declared = table.move(declarations, 1, #declarations, 1, {})
  declared[#declared + 1] = ORIGIN
  declared[#declared + 1] = HOME
  return { kind = kind, name = name, options = lapwing.options(declared, given),
           plan = function(run)
             run:take_origin("origin")
             run:take_home("home")
             return plan(run)
           end }
end
