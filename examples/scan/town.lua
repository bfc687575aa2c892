-- SPDX-License-Identifier: Apache-2.0
-- A town, square by square: four drones with a battery each over four districts of 126 m. With
-- `--set scene_districts=8 --set batteries=20` it is a square kilometre, which takes an hour.
local scan = require "mission.scan"

return scan.of_scene {
  name = "town",
  scene = "town",
  tour = { budget = 600 },  -- s of flight, of each battery
  batteries = 4,
  drones = 4,
  tiles = { edge = 63, pixels = 100 },  -- m
  candidates = { most = 1500, step = 3 },  -- of a square
  resolution = 0.8,  -- m
  map = { type = "brick", miss = 0.24, hit = 0.8 },  -- air that one image sees through is free
  surface = { spacing = 1.25, cell = 2, trim = 3.2, method = "local" },
  range = 150,  -- m; the first flight is above the highest tower
  usable = { range = 60 },
  reach = 25,
  floor = 12,  -- m above the streets
  motions = { alpha = 0.3, coarse = 80 },
  effort = { pixels = 300 },
}
