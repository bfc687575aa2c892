-- SPDX-License-Identifier: Apache-2.0
-- A consumer drone around a fountain. Its maker states speeds, a tilt and a yaw rate, and nothing
-- of its thrust: the model `velocity` keeps within what is stated.
local film = require "mission.film"

return film.shot {
  name = "consumer_drone",
  vehicle = "vehicles/phantom",
  model = "velocity",
  subject = { name = "fountain", position = { 12, 10, 1.5 }, height = 3, width = 3 },
  keyframes = {
    { time = 0, position = { 0, 0, 3 } },
    { time = 8, position = { 16, -2, 6 } },
    { time = 16, position = { 26, 10, 9 } },
    { time = 24, position = { 14, 22, 7 } },
  },
  obstacles = { { type = "sphere", name = "lime tree", center = { 22, 0, 4 }, radius = 3 } },
}
