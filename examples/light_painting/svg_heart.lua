-- SPDX-License-Identifier: Apache-2.0
-- A picture from an SVG file.
local light_painting = require "mission.light_painting"

return light_painting.picture {
  name   = "svg heart",
  svg    = "heart.svg",
  height = 2.5,  -- m
}
