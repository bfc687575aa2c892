-- SPDX-License-Identifier: Apache-2.0
-- The camera of a film in its problem (thesis 3.5.3).
local point_mass = require "mission.point_mass"
local surroundings = require "mission.film_environment"
local tracks = require "mission.tracks"

local M = {}

-- The gimbal's yaw from the course to what is looked at, within half a turn.
local function gimbal_yaws(looks, path)
  local places, list = {}, {}
  for i, time in ipairs(looks.times) do places[i] = tracks.at(path, time) end
  for i, course in ipairs(point_mass.courses(places)) do
    local turn = looks.yaws[i] - course
    list[i] = { turn - 2 * math.pi * math.floor(turn / (2 * math.pi) + 0.5) }
  end
  return list
end

-- What draws the target to what is looked at: to places at given times. Where times are variables
-- (`free`): to subjects, wherever they then are, and to points when their keyframe is passed.
local function add_pulls(p, weight, camera, free)
  if not free then
    p:add_cost { type = "target_keyframe", weight = weight, keyframes = camera.pulls }
    return
  end
  for i, span in ipairs(camera.spans) do
    p:add_cost { type = "subject_target", name = "target on look " .. i, weight = weight,
                 subject = span.subject.name, except = camera.cuts,
                 spans = { { start = span.start, finish = span.finish } } }
  end
  if #camera.points > 0 then
    p:add_cost { type = "target_keyframe", weight = weight, keyframes = camera.points }
  end
end

-- The camera's part of thesis 3.5.3: a gimbal, a target that follows what is looked at, and the
-- angle between the two. `environment`: what may hide the target, or false. `free`: whether times
-- are variables.
function M.add(p, weights, camera, path, environment, free)
  p:add_model { type = "gimbal" }
  p:add_block { name = "target", size = 3, unit = "m" }
  add_pulls(p, weights.target, camera, free)
  p:add_cost { type = "target_derivative", weight = weights.target_smoothness,
               except = camera.cuts }
  p:add_cost { type = "gimbal_derivative", weight = weights.gimbal, except = camera.cuts }
  local elsewhere = table.move(camera.cuts, 1, #camera.cuts, 1, {})
  for _, span in ipairs(camera.spans) do  -- a place in the image is another than its middle
    if span.subject.place then
      elsewhere[#elsewhere + 1] = { start = span.start, finish = span.finish }
    end
  end
  p:add_cost { type = "camera_angle", weight = weights.camera, except = elsewhere }
  for _, span in ipairs(camera.spans) do
    local subject = span.subject
    local within = { { start = span.start, finish = span.finish } }
    if subject.height > 0 and weights.skewness > 0 then
      p:add_cost { type = "skewness", name = "skewness of " .. subject.name,
                   height = subject.height, weight = weights.skewness, spans = within,
                   except = camera.cuts }
    end
    if subject.place or subject.size then
      p:add_cost { type = "framing", name = "framing of " .. subject.name, subject = subject.name,
                   weight = weights.framing, horizontal = subject.place and subject.place[1],
                   vertical = subject.place and subject.place[2], size = subject.size,
                   spans = within, except = camera.cuts }
    end
  end
  if weights.occlusion > 0 and environment and surroundings.hides(environment) then
    p:add_cost { type = "occlusion", weight = weights.occlusion, except = camera.cuts }
  end
  local values = { gimbal_pitch = {}, target = camera.guess.targets }
  for i, pitch in ipairs(camera.guess.pitches) do values.gimbal_pitch[i] = { pitch } end
  if not p:rests() then values.gimbal_yaw = gimbal_yaws(camera.guess, path) end
  for block, list in pairs(values) do
    p:guess_block { block = block, times = camera.guess.times, values = list }
  end
end

return M
