-- SPDX-License-Identifier: Apache-2.0
-- A mesh of yours (.obj, .ply, .stl, .gltf, .dae; metres, z up), flown over and scanned:
--   lapwing run examples/scan/own_mesh.lua --set input=house.obj --data FOLDER
-- `--set ground=true` puts a plane under it.
local scan = require "mission.scan"

return scan.of_mesh {
  name = "own mesh",
  tour = { budget = 300 },  -- s of flight
}
