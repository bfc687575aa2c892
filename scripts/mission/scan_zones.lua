-- SPDX-License-Identifier: Apache-2.0
-- What a scan keeps beside walls: zones, the sight of a pilot, and the accuracy of the position.
-- Candidates, motions, the first flight and the certificate keep all of them.
local polygons = require "mission.scan_polygons"
local regions = require "mission.scan_regions"
local site = require "mission.scan_site"

local M = {}

local REACHED = 0.1    -- share of the space between zones, less of which a start is closed in
local MUCH = 0.01      -- share of a region that zones hide, above which a note is given

local ZONE = polygons.polygon {
  { name = "floor", type = "number", unit = "m", summary = "lower end; absent: none" },
  { name = "ceiling", type = "number", unit = "m", summary = "upper end; absent: none" },
}

M.DECLARATIONS = {
  { name = "no_fly_zones", type = "tables", table = ZONE,
    summary = "zones that all flights keep out of" },
  { name = "flight_zones", type = "tables", table = ZONE,
    summary = "zones that all flights stay inside of, each of them" },
  { name = "pilot", type = "table", summary = "a pilot who must see the vehicle during the whole "
    .. "tour", table = {
    { name = "position", type = "numbers", size = 3, unit = "m", minimum = -1e6, maximum = 1e6,
      summary = "eye of the pilot, world; absent: no pilot" },
    { name = "range", type = "number", unit = "m", default = 500, above = 0, maximum = 1e5,
      summary = "largest distance of the vehicle from the pilot" } } },
  { name = "gps_accuracy", type = "number", unit = "m", default = 0, minimum = 0, maximum = 100,
    summary = "accuracy of the position in flight; the margin and the body grow by it" },
}

local rules = setmetatable({}, { __mode = "k" })  -- of runs

-- The margin that the certificate requires.
function M.margin(run) return run.options.margin + run.options.gps_accuracy end

-- Half edges of the box that must be free.
function M.body(run)
  local more, body = run.options.gps_accuracy, run.options.body
  return { body[1] + more, body[2] + more, body[3] + more }
end

local function zones_of(run, option, side)
  local zones = {}
  local prisms = regions.prisms(run, option, "floor", "ceiling", side == "keep_inside")
  for i, prism in ipairs(prisms) do
    if #prism.holes > 0 then
      run:fail(option, string.format("'%s' has a hole, and a zone has none: state the parts "
                                     .. "around it", prism.name))
    end
    zones[i] = { type = "prism", side = side, name = prism.name, corners = prism.corners,
                 floor = prism.low, ceiling = prism.high, opaque = false }
  end
  return zones
end

-- The rules of all flights.
function M.rules(run)
  if rules[run] then return rules[run] end
  local o = run.options
  local zones = zones_of(run, "no_fly_zones", "keep_out")
  local inside = zones_of(run, "flight_zones", "keep_inside")
  table.move(inside, 1, #inside, #zones + 1, zones)
  rules[run] = run:flight_rules { zones = zones, margin = M.margin(run), accuracy = o.gps_accuracy,
                                  pilot = o.pilot }
  return rules[run]
end

local function any(run) return M.rules(run).zones > 0 or M.rules(run).sees end

-- What is wrong before anything is flown.
function M.check(run)
  local o = run.options
  if run:stated("pilot.range") and not o.pilot.position then
    run:fail("pilot.range", "is the range of a pilot: state pilot.position as well")
  end
  if any(run) and o.exploration.images > 0 then
    run:fail(#o.no_fly_zones > 0 and "no_fly_zones" or #o.flight_zones > 0 and "flight_zones"
             or "pilot", "an exploration keeps no zones and no line of sight: scan with a first "
                         .. "flight (flights), or remove it")
  end
  local function check_place(option, position, which)
    local why = M.rules(run):forbids { position = position, body = M.body(run) }
    if why then run:fail(option, which .. why) end
  end
  for _, option in ipairs { "start", "finish" } do
    if o[option] then check_place(option, o[option], "") end
  end
  for drone, start in ipairs(o.fleet.starts) do
    check_place("fleet.starts", start.position, string.format("the start of drone %d: ", drone))
  end
end

local left_out = setmetatable({}, { __mode = "k" })  -- of runs: places of the first flight

-- What the places are that candidates grow from.
local function places(run)
  return site.wanted(run) and "places over the region" or "images of the first flight"
end

-- Those places of the first flight that the rules allow.
function M.allowed(run, poses)
  if not any(run) then return poses end
  local kept, why = {}, nil
  for _, pose in ipairs(poses) do
    local no = M.rules(run):forbids { position = pose.position, body = M.body(run) }
    if no then why = why or no else kept[#kept + 1] = pose end
  end
  if #poses > 0 and #kept == 0 then
    run:fail("flights", string.format("zones or the pilot's range forbid all %d %s: of the "
                                      .. "first one, %s", #poses, places(run), why))
  end
  left_out[run] = { #poses - #kept, #poses }
  return kept
end

-- Places where flights begin, with their options.
local function beginnings(run, height)
  local o, places = run.options, {}
  local home = o.home and o.home.position
  if home then
    places[1] = { "home", { home[1], home[2], math.max(home[3], height) }, "it" }
  end
  if o.start then places[#places + 1] = { "start", o.start, "it" } end
  for drone, start in ipairs(o.fleet.starts) do
    places[#places + 1] = { "fleet.starts", start.position,
                            string.format("the start of drone %d", drone) }
  end
  return places
end

-- Whether flights get anywhere from where they begin: starts, or home, at the height `height`.
function M.check_home(run, room, height)
  if M.rules(run).zones == 0 then return end
  for _, place in ipairs(beginnings(run, height)) do
    local option, from, what = table.unpack(place)
    local why = M.rules(run):forbids { position = from, body = M.body(run) }
    if why then run:fail(option, string.format("at %.4g m, the height of the flight, %s", from[3],
                                               why)) end
    local share = M.rules(run):reach { from = from, lower = room.lower, upper = room.upper,
                                       body = M.body(run) }
    if share < REACHED then
      run:fail(option, string.format("zones close %s in: from there %.2g %% of the space "
                                     .. "between zones can be flown to", what, 100 * share))
    end
  end
end

local told = setmetatable({}, { __mode = "k" })  -- runs whose user heard of it

-- Notes on what the rules do; those that the user must hear are printed once.
function M.add_notes(run, graph, notes)
  for _, note in ipairs(regions.notes(run)) do notes[#notes + 1] = note end
  if not any(run) then return end
  local left = left_out[run]
  if left and left[1] > 0 then
    notes[#notes + 1] = string.format("zones or the pilot's range forbid %d of %d %s, which "
                                      .. "are left out", left[1], left[2], places(run))
  end
  for _, part in ipairs(graph.hidden) do
    local share = part.visible > 0 and part.hidden / part.visible or 0
    local what = part.name == "" and "the region" or part.name
    local note
    if share >= 1 then
      note = string.format("%s cannot be seen: zones or the pilot's sight hide all of its %.4g m^2",
                           what, part.visible)
    elseif share > MUCH then
      note = string.format("%s: %.2g %% of its surface that could be seen (%.4g of %.4g m^2) stay "
                           .. "unseen because of zones or the pilot's sight", what, 100 * share,
                           part.hidden, part.visible)
    end
    notes[#notes + 1] = note
    if note and not told[run] then print("warning: " .. note) end
  end
  told[run] = true
end

return M
