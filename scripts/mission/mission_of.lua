-- SPDX-License-Identifier: Apache-2.0
-- A mission of a kind: its name, and its options as declared and given. Whatever flies has an
-- origin.
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

return function(kind, declarations, given, plan)
  local name = given.name
  given.name = nil
  if kind == "map" then
    return { kind = kind, name = name, options = lapwing.options(declarations, given), plan = plan }
  end
  local declared = table.move(declarations, 1, #declarations, 1, {})
  declared[#declared + 1] = ORIGIN
  return { kind = kind, name = name, options = lapwing.options(declared, given),
           plan = function(run)
             run:take_origin("origin")
             return plan(run)
           end }
end
