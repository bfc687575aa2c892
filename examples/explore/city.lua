-- SPDX-License-Identifier: Apache-2.0
-- A drone that knows nothing of a city centre maps as much of it, from a street on, as 200 images
-- or its battery allow.
--   --set utility=frontier (average_entropy, proximity_count, learned, oracle)
local explore = require "mission.explore"

return explore.of_scene { name = "explore city", scene = "downtown", scene_seed = 301,
                          start = { 0, -30, 8 } }
