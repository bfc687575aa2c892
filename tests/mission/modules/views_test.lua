-- SPDX-License-Identifier: Apache-2.0
-- Places to look from over a scene: free, within the region, evenly spread, under the sky.
local check = require "check"
local views = require "mission.views"

local T = {}

-- A region without anything in it, and one with a wall across x = 0 and a roof over x < -20.
local function scene(options)
  local made = { region = { lower = { -30, -20, 1 }, upper = { 30, 20, 31 } },
                 upper = { 30, 20, 31 } }
  function made:clearance(p) return options.wall and math.abs(p[1]) or math.huge end
  function made:covered(p) return options.indoors or (options.roof and p[1] < -20) or false end
  return made
end

function T.as_many_as_were_asked_for()
  for _, count in ipairs { 1, 7, 200 } do
    check.equal(#views.over(scene {}, count), count)
  end
  check.equal(views.over(scene {}, 0), {})
end

function T.three_heights_and_four_directions()
  local heights, quarters = {}, {}
  for _, pose in ipairs(views.over(scene {}, 120)) do
    local p = pose.position
    check.yes(p[1] >= -30 and p[1] <= 30 and p[2] >= -20 and p[2] <= 20, "within the region")
    local key = ("%g at %g"):format(p[3] - 1, pose.pitch)
    heights[key] = (heights[key] or 0) + 1
    local quarter = math.floor(pose.yaw / (math.pi / 2) + 1e-9)
    check.yes(pose.yaw - quarter * math.pi / 2 <= 0.3, "a little aside")
    quarters[quarter + 1] = (quarters[quarter + 1] or 0) + 1
  end
  check.equal(heights, { ["3 at 0"] = 40, ["9 at -0.35"] = 40, ["20 at -0.9"] = 40 })
  check.equal(quarters, { 30, 30, 30, 30 })
end

-- Each of 6 x 4 equal parts of the region holds its share, to within a third of it.
function T.places_fill_the_region_evenly()
  local counts = {}
  for _, pose in ipairs(views.over(scene {}, 480)) do
    local p = pose.position
    local part = math.min(5, (p[1] + 30) // 10) * 4 + math.min(3, (p[2] + 20) // 10)
    counts[part] = (counts[part] or 0) + 1
  end
  for part = 0, 23 do
    check.yes(math.abs((counts[part] or 0) - 20) <= 6, ("part %d has %d"):format(part, counts[part]
        or 0))
  end
end

function T.what_is_too_near_or_has_no_sky_is_left_out()
  for _, pose in ipairs(views.over(scene { wall = true, roof = true }, 100)) do
    check.yes(math.abs(pose.position[1]) >= 1.5, "clear of the wall")
    check.yes(pose.position[1] >= -20, "not under the roof")
  end
end

function T.indoors_it_looks_ahead_between_floor_and_ceiling()
  for _, pose in ipairs(views.over(scene { indoors = true, wall = true }, 60)) do
    check.equal(pose.pitch, 0)
    check.yes(pose.position[3] >= 1 + 0.3 * 30 - 1e-9 and pose.position[3] <= 1 + 0.7 * 30 + 1e-9)
    check.yes(math.abs(pose.position[1]) >= 0.4)
  end
end

-- Passes above everything that stands there see no more; the lowest is flown all the same.
-- Whether a scene is indoors is asked in the middle of the region, 2 m over its floor.
function T.indoors_is_what_its_middle_says()
  local asked = {}
  local hall = { region = { lower = { 2, 10, 1 }, upper = { 6, 30, 9 } }, upper = { 6, 30, 9 } }
  function hall:clearance() return 0.5 end
  function hall:covered(p) asked[#asked + 1] = p return true end
  check.equal(#views.over(hall, 6), 6, "half a metre is enough indoors")
  check.equal(asked[1], { 4, 20, 3 })
  function hall:covered() return false end
  check.fails("only 0 of 6 places", views.over, hall, 6)
end

function T.over_a_low_scene_nobody_flies_high()
  local low = scene {}
  low.upper = { 30, 20, 4 }
  for _, pose in ipairs(views.over(low, 50)) do check.near(pose.position[3], 4, 1e-12) end
end

function T.where_nothing_is_free_it_says_so()
  local full = scene {}
  function full:clearance() return 0 end
  check.fails("only 0 of 5 places in the region are free", views.over, full, 5)
end

return check.all(T)
