-- SPDX-License-Identifier: Apache-2.0
-- A film with three terms beside its own: written in Lua, and the same three as plugins.
local film = require "mission.film"

local terms = {}

local function in_camera(yaw, pitch, d)
  local cy, sy = lapwing.cos(yaw), lapwing.sin(yaw)
  local cp, sp = lapwing.cos(pitch), lapwing.sin(pitch)
  return lapwing.vector(lapwing.dot({ sy, -cy, 0 }, d), lapwing.dot({ sp * cy, sp * sy, -cp }, d),
                        lapwing.dot({ cp * cy, cp * sy, sp }, d))
end
local function near_fade(squared)
  local share = squared / 0.01
  return lapwing.where(share - 1, 1, share * share * share * (10 + share * (6 * share - 15)))
end
local function angles(d)
  local squared = lapwing.dot(d, d)
  local c = d / lapwing.sqrt(squared)
  local across = c.x * c.x + c.y * c.y
  local sine = lapwing.sqrt(across)
  local series = 1 + across * (1 / 6 + across * (3 / 40 + across * (15 / 336)))
  local close = lapwing.where(c.z, lapwing.where(1e-4 - across, 1, -1), -1)
  local ratio = lapwing.where(close, series, lapwing.atan2(sine, c.z) / sine)
  return near_fade(squared) * ratio * lapwing.vector(c.x, c.y)
end
terms.written = {
  { name = "angle", weight = 10, residual = function(s)
      return angles(in_camera(s.yaw + s.gimbal_yaw, s.gimbal_pitch, s.target - s.position)) end },
  { name = "skew", weight = 1, residual = function(s)
      local d = s.target - s.position
      local squared = lapwing.dot(d, d)
      return near_fade(squared) * 4 * d.z / (squared + 2 * lapwing.abs(d.z)) end },
  { name = "jerk", weight = 1e-3, residual = function(s)
      return (s[3].position - 3 * s[2].position + 3 * s[1].position - s.position)
             / s.step ^ 3 end },
}
terms.shipped = {
  { type = "camera_angle", name = "angle", weight = 10 },
  { type = "skewness", name = "skew", weight = 1, height = 4 },
  { type = "derivative", name = "jerk", weight = 1e-3, order = 3 },
}

function terms.film(costs)
  return film.shot {
    name      = "castle flyover", step = 0.1,
    duration  = 20,
    vehicle   = "vehicles/solo",
    subject   = { position = {0, 0, 2}, height = 4, width = 5 },
    keyframes = {
      { time =  0, position = {-18, -6,  3} },
      { time = 10, position = {  0, -2, 14} },
      { time = 20, position = { 18,  4,  5} },
    },
    obstacles = { { type = "sphere", name = "castle", center = {0, 0, 2}, radius = 5 } },
    costs = costs,
  }
end

return terms
