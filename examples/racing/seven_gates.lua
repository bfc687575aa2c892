-- SPDX-License-Identifier: Apache-2.0
-- Seven gates of five shapes, one of them the middle of a tunnel, once from hover to hover at the
-- limit of the rotors: lapwing run examples/racing/seven_gates.lua
--
-- The certificate flies the plan with the controller of the vehicle file. The largest thrust with
-- which a hundred flights with a mass error of 5 % pass every gate:
--   --set flown.runs=100 --set flown.mass_error=0.05
-- Another course of the same kind: --set input=PATH (YAML or JSON)
local race = require "mission.race"

return race.course {
  name = "seven gates",
  vehicle = "vehicles/racer_flown",  -- with lag, delay, and a controller that knows of both
  model = "quadrotor_full",
  thrust = 1,
  floor = 0.3,
  step = 0.05,
  start = { -6, 4, 1.5 },
  finish = { 5, 0, 1.5 },
  gates = {
    { name = "arrow", shape = "triangle", position = { -1, -2, 3.5 }, normal_yaw_deg = 0,
      width = 2.4, height = 2.4 },
    { name = "window", shape = "rectangle", position = { 9, 6, 1.6 }, normal_yaw_deg = -30,
      width = 2.2, height = 2 },
    { name = "pipe", shape = "pentagon", position = { 9, -4, 2 }, normal_yaw_deg = -120,
      radius = 1.6, tunnel_length = 6 },
    { name = "upper deck", shape = "rectangle", position = { -4, -7, 4 }, normal_yaw_deg = 180,
      width = 2.4, height = 2 },
    { name = "lower deck", shape = "rectangle", position = { -4, -7, 1.5 }, normal_yaw_deg = 0,
      width = 2.4, height = 2 },
    { name = "comb", shape = "hexagon", position = { 5, 0, 1.8 }, normal_yaw_deg = 75, side = 1.2 },
    { name = "buoy", shape = "ball", position = { -3, 7, 1.5 }, radius = 0.4 },
  },
}
