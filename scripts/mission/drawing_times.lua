-- SPDX-License-Identifier: Apache-2.0
-- Strokes of light in time: how the flight passes them, and when the light is on.
local drawings = require "mission.drawings"
local paths = require "mission.paths"

local M = {}

local SPACING = 0.01     -- m, between points of the timed path

local function at_share(times, share)
  local place = 1 + share * (#times - 1)
  local k = math.min(math.floor(place), #times - 1)
  return times[k] + (place - k) * (times[k + 1] - times[k])
end

-- The timed path and when the light is on: from rest to rest, stroke by stroke, with a rest in the
-- dark before each further one.
function M.with_gaps(run, strokes, limits, gap)
  local made, lights, now = { points = {}, times = {} }, {}, 0
  local function fly(points)
    limits.points, limits.spacing = paths.flat(points), SPACING
    local timed = run:time_path(limits)
    table.move(timed.points, 1, #timed.points, #made.points + 1, made.points)
    for _, time in ipairs(timed.times) do made.times[#made.times + 1] = now + time end
    now = made.times[#made.times]
  end
  for i, stroke in ipairs(strokes) do
    local before = strokes[i - 1]
    if before then
      if paths.distance(before[#before], stroke[1]) > 1e-6 then
        fly { before[#before], stroke[1] }
      end
      now = now + gap
    end
    local start = now
    fly(stroke)
    lights[i] = { start = start, finish = now }
  end
  return made, lights
end

-- Likewise, without a stop.
function M.at_once(run, strokes, limits)
  local path, lit = drawings.joined(strokes)
  limits.points, limits.spacing = paths.flat(path), SPACING
  local timed = run:time_path(limits)
  local lights = {}
  for _, span in ipairs(lit) do
    local light = { start = at_share(timed.times, span[1]),
                    finish = at_share(timed.times, span[2]) }
    local before = lights[#lights]
    if before and light.start <= before.finish then before.finish = light.finish
    else lights[#lights + 1] = light end
  end
  return timed, lights
end

return M
