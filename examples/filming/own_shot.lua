-- SPDX-License-Identifier: Apache-2.0
-- A designer's shot from a file of yours:
--   lapwing run examples/filming/own_shot.lua --set input=shot_01.json --data FOLDER
-- Keyframes are met within half a metre; all times are stretched as little as that takes.
local film = require "mission.film"

return film.from_file {
  name    = "own shot",
  hard    = 0.5,      -- m
  stretch = "auto",
}
