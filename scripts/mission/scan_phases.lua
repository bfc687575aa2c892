-- SPDX-License-Identifier: Apache-2.0
-- The phases of a scan, for the progress line. Each has a duration in s, measured on one machine.
-- Only the ratios matter, and the measurements of the run correct them.
local exploration = require "mission.scan_exploration"
local images = require "mission.scan_images"
local site = require "mission.scan_site"
local space = require "mission.scan_space"

local M = {}

local LOOK, MESH, WEIGH, TELL = 1.6e-6, 1.9e-6, 1.4e-7, 4e-7  -- s a pixel
local EXPLORE, JOIN, LEG = 0.5, 0.008, 0.3                    -- s an image, a candidate, a leg
local PASS = 0.02          -- s for a second of flight in passing
local TOUR = 4e-6          -- s a pair of candidates
local VIEW = 8             -- s of flight that a view takes
local CERTIFICATE = 0.01   -- s for a second of flight, in a map with voxels of 1 m
local FILES = 2            -- s
local SURVEYED = 1.5e-4    -- s a point of a surface
local BEGIN = 1            -- s of anything, however small

local function pixels_of(camera, across)
  local share = across > 0 and math.min(1, across / camera.width) or 1
  return share * share * camera.width * camera.height
end

-- Tells what is to come, before the first phase begins; the tour has `seconds`, and a trajectory
-- of its own where images are taken in passing.
function M.expect(run, seconds, in_passing)
  local o = run.options
  local few, all = pixels_of(o.camera, o.effort.pixels), pixels_of(o.camera, 0)
  local phases = {}
  local function add(name, weight)
    phases[#phases + 1] = { name = name, weight = weight + BEGIN }
  end
  if exploration.wanted(run) then
    add("exploration", EXPLORE * o.exploration.images)
  elseif site.wanted(run) then
    add("prior mesh", SURVEYED * site.points(run))
  elseif images.wanted(run) then
    add("images", LOOK * all * images.of(run).images)
    add("prior mesh", MESH * all * images.of(run).images)
  elseif space.surface_of(run) and not (space.prior_files(run) and #o.flights == 0) then
    local images = 0
    for _, flight in ipairs(space.flights_of(run)) do
      images = images + #space.poses_of(run, flight)
    end
    add("first flight", LOOK * few * images)
    add("prior mesh", MESH * few * images)
  end
  for round = 1, o.rounds do
    local of = o.rounds > 1 and " of round " .. round or ""
    add("views" .. of, (WEIGH * few + JOIN) * o.candidates.most)
    add("tour" .. of, TOUR * o.candidates.most ^ 2)
    if in_passing then add("trajectory" .. of, PASS * seconds) end
    if o.flight.smooth then add("smooth legs" .. of, LEG * seconds / VIEW) end
    add("flight" .. of, TELL * all * seconds / VIEW)
    if round < o.rounds then
      add("look" .. of, LOOK * few * seconds / VIEW)
      add("mesh" .. of, MESH * few * seconds / VIEW)
    end
  end
  add("certificate", CERTIFICATE / space.resolution(run) * seconds)
  add("files", FILES)
  run:phases(phases)
end

-- What phases are called in a round of several.
function M.named(run, name, round)
  return run.options.rounds > 1 and name .. " of round " .. round or name
end

return M
