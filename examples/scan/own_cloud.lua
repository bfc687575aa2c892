-- SPDX-License-Identifier: Apache-2.0
-- A point cloud of yours (.las, .ply, .pcd, .xyz) in place of a first flight:
--   lapwing run examples/scan/own_cloud.lua --set input=site.las --data FOLDER
-- A .las file states its reference system. For other files state it, or which of its coordinates is
-- the world's origin: --set cloud.system=EPSG:28992, or --set cloud.zero={84900,447500,0}.
local scan = require "mission.scan"

return scan.of_cloud {
  name = "own cloud",
  tour = { budget = 300 },  -- s of flight
}
