-- SPDX-License-Identifier: Apache-2.0
-- The rooms of an office: smaller steps, a smaller body, less room at the start, as the scene
-- recommends them (scripts/scene/office.lua). Others: --set moves.step=1
local explore = require "mission.explore"

return explore.of_scene { name = "explore office", scene = "office", margin = 0.2 }
