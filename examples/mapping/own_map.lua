-- SPDX-License-Identifier: Apache-2.0
-- A map file of yours, its statistics and pictures:
--   lapwing run examples/mapping/own_map.lua --set input=corridor.bt
local map = require "mission.map"

return map.of_file { name = "own map" }
