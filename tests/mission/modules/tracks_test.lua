-- SPDX-License-Identifier: Apache-2.0
-- Subjects on their tracks, directions of looks, and paths as flat lists.
local check = require "check"
local paths = require "mission.paths"
local tracks = require "mission.tracks"

local T = {}

local function list_of(v) return { v[1] or v.x, v[2] or v.y, v[3] or v.z } end

local TRACK = { { time = 2, position = { 0, 0, 0 } }, { time = 4, position = { 4, 2, -6 } },
                { time = 5, position = { 4, 2, 0 } } }

function T.between_its_points_a_track_is_straight()
  for time, wanted in pairs { [-1] = { 0, 0, 0 }, [2] = { 0, 0, 0 }, [2.5] = { 1, 0.5, -1.5 },
                              [4] = { 4, 2, -6 }, [4.75] = { 4, 2, -1.5 }, [5] = { 4, 2, 0 },
                              [1e9] = { 4, 2, 0 } } do
    check.near(list_of(tracks.at(TRACK, time)), wanted, 1e-12, "at " .. time)
  end
  check.equal(list_of(tracks.at({ { time = 3, position = { 1, 2, 3 } } }, 99)), { 1, 2, 3 })
end

function T.directions_of_looks()
  local function angles(x, y, z, before)
    local yaw, pitch = tracks.angles({ 1, 2, 3 }, { 1 + x, 2 + y, 3 + z }, before)
    return { math.deg(yaw), math.deg(pitch) }
  end
  check.near(angles(5, 0, 0), { 0, 0 }, 1e-9)
  check.near(angles(0, 5, 5), { 90, 45 }, 1e-9)
  check.near(angles(-5, 0, -5), { 180, -45 }, 1e-9)
  check.near(angles(3, -3, 0), { -45, 0 }, 1e-9)
  -- Next to the yaw before, whatever its turn.
  check.near(angles(-5, -0.5, 0, math.rad(179))[1], 185.7106, 1e-4)
  check.near(angles(3, -3, 0, math.rad(700))[1], 675, 1e-9)
  check.near(angles(3, -3, 0, math.rad(-700))[1], -765, 1e-9)
  -- Straight up or down, or from the place itself, there is no heading: the one before is kept.
  check.near(angles(0, 0, 5, 1.5), { math.deg(1.5), 90 }, 1e-6)
  check.near(angles(0.1, 0, -5), { 0, -90 + math.deg(math.atan(0.1 / 5)) }, 1e-9)
  check.near(angles(0, -0.2, -3, 0)[1], -90, 1e-9, "less steep")
  -- 0.05 of the distance is the share below which a look is steep, however far away.
  for _, far in ipairs { 0.1, 100 } do
    check.near(angles(0, 0.049 * far, far, 0)[1], 0, 1e-9)
    check.near(angles(0, 0.051 * far, far, 0)[1], 90, 1e-9)
  end
  check.near(angles(0, 0, 0, 0.5)[1], math.deg(0.5), 1e-9)
end

local function checked(list, stretch, ...)
  return tracks.checked(check.run(), list, stretch or 1, ...)
end

function T.subjects_have_names_and_tracks()
  local list, by_name = checked { { position = { 1, 2, 3 }, height = 2 } }
  check.equal(list[1].name, "subject")
  check.equal(list[1].track, { { time = 0, position = { 1, 2, 3 } } })
  check.equal({ list[1].still, list[1].height, list[1].width }, { true, 2, 0 })
  check.yes(by_name.subject == list[1])
  list = checked({ { position = { 0, 0, 0 } }, { track = TRACK, name = "a" } }, 3)
  check.equal({ list[1].name, list[2].name, list[2].still }, { "subject 1", "a", false })
  check.equal({ list[1].height, list[1].width }, { 0, 0 })
  check.equal({ list[2].track[1].time, list[2].track[3].time }, { 6, 15 }, "times are stretched")
  check.equal(TRACK[1].time, 2, "a copy")
  list = checked({ { position = { 0, 0, 0 } }, { position = { 1, 0, 0 } } }, 1, "bystanders",
                 "person")
  check.equal({ list[1].name, list[2].name, list[2].option },
              { "person 1", "person 2", "bystanders[2]" })
end

function T.wrong_subjects_are_named()
  local place = { position = { 0, 0, 0 } }
  check.fails("subjects[1]: expected a position, or a track", checked, { {} })
  check.fails("subjects[2]: expected a position, or a track", checked, { place, { track = {} } })
  check.fails("subjects[1]: expected a position, or a track", checked,
              { { position = { 0, 0, 0 }, track = TRACK } })
  check.fails("subjects[2].name: 'a' is taken", checked,
              { { name = "a", position = { 0, 0, 0 } }, { name = "a", position = { 1, 0, 0 } } })
  for _, time in ipairs { 1, 2 } do
    check.fails("subjects[1].track[2].time: times must rise", checked,
                { { track = { { time = 2, position = { 0, 0, 0 } },
                              { time = time, position = { 0, 0, 0 } } } } })
  end
  check.fails("bystanders[1]: expected", checked, { {} }, 1, "bystanders", "person")
end

function T.flat_paths()
  local flat = paths.flat { { 1, 2, 3 }, lapwing.vector { 4, 5, 6 } }
  check.equal(flat, { 1, 2, 3, 4, 5, 6 })
  check.equal(paths.point(flat, 1), { 1, 2, 3 })
  check.equal(paths.point(flat, 2), { 4, 5, 6 })
  check.equal(paths.flat {}, {})
  check.near(paths.distance({ 1, 2, 3 }, { 3, 5, 9 }), 7, 1e-12)
  check.near(paths.length { { 0, 0, 0 }, { 2, 3, 6 }, { 2, 3, 7 }, { 2, 3, 7 } }, 8, 1e-12)
  check.equal(paths.length { { 0, 0, 0 } }, 0)
  check.equal(paths.length {}, 0)
end

return check.all(T)
