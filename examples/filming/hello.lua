-- SPDX-License-Identifier: Apache-2.0
-- The first film: up, across, and a look back.
--   lapwing run examples/filming/hello.lua
local film = require "mission.film"

return film.shot {
  name      = "hello",
  keyframes = {
    { position = { 0, 0, 2 }, yaw_deg = 0 },
    { position = { 8, 0, 5 }, yaw_deg = 45 },
    { position = { 8, 8, 4 }, yaw_deg = 180 },
  },
}
