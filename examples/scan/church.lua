-- A church on a square, from a first flight over it to a tour of views for its 3D model.
local scan = require "mission.scan"

return scan.of_scene {
  name  = "church",
  scene = "church",
  tour  = { budget = 300 },  -- s of flight
  -- Just over the tower, so that depth reaches the ground.
  flights = { { pattern = "ellipse", height = 52, views = 20, reach = 12, pitch_deg = -40 },
              { pattern = "meander", height = 52, views = 20, reach = 5 } },
}
