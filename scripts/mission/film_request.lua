-- SPDX-License-Identifier: Apache-2.0
-- Request and outcome of one attempt at a film (film_attempt.lua). Both are immutable: strategies
-- make new requests from outcomes.
local record = require "mission.record"

local M = {}

local requests = record.type("request", {
  -- The same in all requests of a film.
  vehicle = "vehicle",
  subjects = "filmed subjects, as in the script",
  cuts = "spans of discarded footage, at a stretch of 1",
  terms = "functions of the script, from own_terms.taken",
  origin = "geodetic origin of the world frame, or nil",
  -- The flight and its times.
  keyframes = "{position, time, yaw, look_at, subject}, at a stretch of 1",
  duration = "s, at a stretch of 1",
  cruise = "wanted speeds of legs, from keyframe_times.filled",
  stretch = "factor on all times",
  legs = "known paths between keyframes, from ways.planned",
  corridor = "whether the flight stays within free boxes around its path",
  track = "places and times that attract the flight: {places, weight}, or nil; legs: the path from "
    .. "keyframe to keyframe as flat lists, if times are to be variables",
  wishes = "what keyframes ask of times that are found, from timing.wishes; nil: times are given",
  free = "times are variables: {legs, as run:problem takes them; share of the inputs; second, the "
    .. "cost of one}, or nil",
  may_fail = "whether an error of its statement is an outcome, with a `fault`",
  -- The part of the film in the problem:
  --   "film"           all of it
  --   "flight"         without the camera and the terms of the script
  --   "unlimited"      without the limits of the vehicle
  --   "unconstrained"  with the constraints of the script checked, but not enforced
  scope = "part of the film in the problem",
  looks_round = "whether the cost occlusion is included",
  memory = "state of the strategy that made the request; other code does not read it",
})

local outcomes = record.type("outcome", {
  request = "request of the attempt",
  holds = "whether the film is certified, and not only because the least violation is within the "
    .. "tolerance of the verifier",
  fault = "why the problem could not be stated (in a corridor, or `may_fail`), or nil; there is "
    .. "then neither solution nor verdict",
  solution = "result of the solver",
  verdict = "result of the verifier: feasible, failures, checks",
  task = "task that the plan is checked against",
  camera = "result of subjects.plan, or nil",
  legs = "legs of the request, and the paths that were planned for this attempt",
})

-- The first request of a film. `fields` lacks what most requests have alike.
function M.first(fields)
  local all = { stretch = 1, scope = "film", legs = {}, corridor = false, cruise = {},
                looks_round = true }
  for name, value in pairs(fields) do all[name] = value end
  return requests.new(all)
end

M.with = requests.with
M.outcome = outcomes.new

return M
