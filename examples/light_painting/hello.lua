-- SPDX-License-Identifier: Apache-2.0
-- A word in the air, two metres tall.
local light_painting = require "mission.light_painting"

return light_painting.text {
  name   = "hello light",
  text   = "HELLO",
  height = 2,            -- m
  base = { 0, 0, 2 },  -- m, world: the middle of the word's lower edge
}
