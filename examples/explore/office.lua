-- The rooms of an office: smaller steps, a smaller body, less room at the start.
local explore = require "mission.explore"

return explore.of_scene {
  name = "explore office", scene = "office",
  moves = { step = 0.7, body = 0.6, clear = 2, speed = 0.7 },
  margin = 0.2,
}
