-- SPDX-License-Identifier: Apache-2.0
-- A mesh of yours, as if nobody had seen it:
--   lapwing run examples/explore/own_mesh.lua --set input=block.obj
local explore = require "mission.explore"

return explore.of_mesh { name = "explore own mesh" }
