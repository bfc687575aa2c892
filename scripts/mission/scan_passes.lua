-- SPDX-License-Identifier: Apache-2.0
-- The passes of a vehicle that cannot stand still: straight, level, along the axes of the region,
-- with images at even distances; and the free space that passes and turns need.
local point_mass = require "mission.point_mass"
local space = require "mission.scan_space"

local M = {}

local ABOVE = 5            -- m of the safe height, unless said otherwise, as a crosshatch
local CRUISE = 1.2         -- times the stall speed, likewise
local APART, SPACING = 0.25, 0.5  -- heights over the region's floor, between images and passes
M.BANK_SHARE = 0.85        -- of the largest bank, in turns
M.LEAD = 1.5               -- s, straight before and behind the images of a pass
local ROOM = 3             -- turn radii beside the passes
local OVERHEAD = 2         -- m of free air above the passes
local FARTHER = 1.25       -- than to the floor in the middle of an image: so far images tell
local FEWEST = 10          -- passes: one of each look along both axes
local COARSER = 1.05       -- times, where views are too many

M.DECLARATION = { name = "passing", type = "table",
  summary = "images in passing, by a model that cannot stand still", table = {
    { name = "height", type = "number", unit = "m", minimum = -1e5, maximum = 1e5,
      summary = "height of all passes, world; absent: 5 m above safe_height" },
    { name = "speed", type = "number", unit = "m/s", above = 0, maximum = 1e3,
      summary = "speed of the flight; absent: 1.2 times the stall speed" },
    { name = "apart", type = "number", unit = "m", above = 0, maximum = 1e5,
      summary = "distance between images of a pass; absent: a quarter of the height above the "
      .. "floor of the region" },
    { name = "spacing", type = "number", unit = "m", above = 0, maximum = 1e5,
      summary = "distance between neighbouring passes; absent: half of that height" },
    { name = "interval", type = "number", unit = "s", default = 1, minimum = 0, maximum = 60,
      summary = "shortest time between two images" },
    { name = "down_deg", type = "number", unit = "deg", default = -80, minimum = -90, maximum = -20,
      summary = "pitch of passes that look down" },
    { name = "oblique_deg", type = "number", unit = "deg", default = -45, minimum = -90,
      maximum = -20, summary = "pitch of passes that look ahead, back, left and right" },
    { name = "miss", type = "number", unit = "m", default = 1, above = 0, maximum = 100,
      summary = "largest distance of an image from its place on the pass" },
    { name = "bank_deg", type = "number", unit = "deg", default = 5, above = 0, maximum = 90,
      summary = "largest bank at an image" },
    { name = "iterations", type = "integer", default = 200, minimum = 0, maximum = 1000000,
      summary = "iterations of the search for passes and their order" } } }

function M.height(run)
  return run.options.passing.height or space.safe_height(run) + ABOVE
end

local function over_floor(run) return M.height(run) - space.region_of(run).lower[3] end

function M.speed(run, vehicle)
  return run.options.passing.speed or CRUISE * vehicle.wing.stall_speed
end

function M.radius(run, vehicle)
  local lateral = point_mass.GRAVITY * math.tan(M.BANK_SHARE * vehicle.wing.bank)
  return M.speed(run, vehicle) ^ 2 / lateral
end

-- How far ahead a camera that looks down at `deg` sees the region's floor.
local function ahead(run, deg) return over_floor(run) / math.tan(math.rad(-deg)) end

-- Images look as far as the flattest of them needs.
function M.want_range(run)
  local o = run.options.passing
  local flattest = math.rad(-math.max(o.down_deg, o.oblique_deg))
  space.want_range(run, FARTHER * over_floor(run) / math.sin(flattest))
end

-- Where the vehicle's middle may be: above the safe height, with room for turns.
function M.air(run, vehicle)
  local o, region, lower, upper = run.options, space.region_of(run), {}, {}
  local beyond = math.max(ahead(run, o.passing.down_deg), ahead(run, o.passing.oblique_deg))
  local room = beyond + M.LEAD * M.speed(run, vehicle) + ROOM * M.radius(run, vehicle)
  for axis = 1, 2 do
    lower[axis], upper[axis] = region.lower[axis] - room, region.upper[axis] + room
  end
  lower[3] = space.safe_height(run) + o.body[3]
  upper[3] = o.ceiling or math.max(space.ceiling_of(run), M.height(run) + OVERHEAD)
  return { lower = lower, upper = upper }
end

-- Passes along one axis of the region, for every look: lines side by side, so that the middles of
-- their images lie on the region's floor. How many images they have comes back.
local function add_passes(run, along, apart, spacing, list)
  local region, o, across = space.region_of(run), run.options.passing, 3 - along
  local length = region.upper[along] - region.lower[along]
  local width = region.upper[across] - region.lower[across]
  local images = math.max(2, math.ceil(length / apart) + 1)
  local lines = math.max(1, math.ceil(width / spacing))
  local looks = { { yaw = 0, deg = o.down_deg } }
  for quarter = 0, 3 do
    looks[#looks + 1] = { yaw = quarter * math.pi / 2, deg = o.oblique_deg }
  end
  local left = along == 1 and 1 or -1  -- of the course, in the coordinate across
  for _, look in ipairs(looks) do
    local shift = ahead(run, look.deg)
    local begin = region.lower[along] + (length - (images - 1) * apart) / 2
                  - shift * math.cos(look.yaw)
    for line = 1, lines do
      local a, b = { [3] = M.height(run) }, { [3] = M.height(run) }
      a[along], b[along] = begin, begin + (images - 1) * apart
      a[across] = region.lower[across] + (line - 0.5) / lines * width
                  - left * shift * math.sin(look.yaw)
      b[across] = a[across]
      list[#list + 1] = { from = a, to = b, images = images, yaw = look.yaw,
                          pitch = math.rad(look.deg) }
    end
  end
  return images * lines * #looks
end

-- Passes along both axes, as far apart as said, or farther where they have too many images.
function M.of(run, vehicle)
  local o = run.options
  local least = o.passing.interval * M.speed(run, vehicle)
  local apart = o.passing.apart or APART * over_floor(run)
  local spacing = o.passing.spacing or SPACING * over_floor(run)
  if o.passing.apart and apart < least then
    run:fail("passing.apart", string.format(
      "%.4g m: images follow each other after passing.interval, %.4g s, which is %.4g m at "
      .. "%.4g m/s", apart, o.passing.interval, least, M.speed(run, vehicle)))
  end
  apart = math.max(apart, least)
  while true do
    local list = {}
    local views = 0
    for axis = 1, 2 do views = views + add_passes(run, axis, apart, spacing, list) end
    if views <= o.candidates.most or #list <= FEWEST then return list, spacing end
    spacing = COARSER * spacing
  end
end

return M
