-- SPDX-License-Identifier: Apache-2.0
-- Subjects on their tracks, and the directions from which they are seen.
local tracks = {}

local STEEP = 0.05  -- share of the distance, below which a look has no heading

-- Subjects with names and tracks; a subject without a track stands still. `option` and `word`: of
-- bystanders, where they are not subjects.
function tracks.checked(run, list, stretch, option, word)
  local result, by_name = {}, {}
  for i, given in ipairs(list) do
    local what = (option or "subjects") .. "[" .. i .. "]"
    word = word or "subject"
    local name = given.name or (#list == 1 and word or word .. " " .. i)
    local track = given.track
    if not given.position == (not track or #track == 0) then
      run:fail(what, "expected a position, or a track of times and positions")
    end
    if by_name[name] then run:fail(what .. ".name", "'" .. name .. "' is taken") end
    local points = {}
    for j, point in ipairs(given.position and { { time = 0, position = given.position } } or track)
    do
      local last = points[j - 1]
      if last and point.time * stretch <= last.time then
        run:fail(string.format("%s.track[%d].time", what, j), "times must rise")
      end
      points[j] = { time = point.time * stretch, position = point.position }
    end
    result[i] = { name = name, track = points, still = given.position ~= nil,
                  height = given.height or 0, width = given.width or 0, distance = given.distance,
                  live = given.live,
                  place = given.place, size = given.size, option = what }
    by_name[name] = result[i]
  end
  return result, by_name
end

-- Position in a list of {time, position}: straight in between, at rest outside. A
-- list of numbers or a vector.
function tracks.at(track, time)
  local low, high = 1, #track
  if time <= track[low].time then return track[low].position end
  if time > track[high].time then return track[high].position end
  while high - low > 1 do  -- after `low`, not after `high`
    local middle = (low + high) // 2
    if time <= track[middle].time then high = middle else low = middle end
  end
  local a, b = track[low], track[high]
  local way = lapwing.vector(b.position) - a.position
  return (time - a.time) / (b.time - a.time) * way + a.position
end

-- Yaw in the world, and pitch, of a look; the yaw next to `before`, which it keeps when the look is
-- steep.
function tracks.angles(from, to, before)
  local d = lapwing.vector(to) - from
  local across = lapwing.norm { d.x, d.y }
  local pitch = math.atan(d.z, math.max(across, 1e-9))
  if across <= STEEP * lapwing.norm { across, d.z } then return before or 0, pitch end
  local yaw = math.atan(d.y, d.x)
  if before then yaw = yaw - 2 * math.pi * math.floor((yaw - before) / (2 * math.pi) + 0.5) end
  return yaw, pitch
end

return tracks
