-- SPDX-License-Identifier: Apache-2.0
-- What one attempt at a film is asked for (film_attempt.lua), and what came of it. Neither is ever
-- changed: strategies make new requests from outcomes.
local record = require "mission.record"

local M = {}

local requests = record.type("request", {
  -- The same in all requests of a film.
  vehicle = "that flies",
  subjects = "what is filmed, as the script gives it",
  cuts = "footage that is thrown away, at a stretch of 1",
  terms = "the script's functions, of own_terms.taken",
  origin = "where the world frame lies on the earth, or nil",
  -- What is flown, and when.
  keyframes = "{position, time, yaw, look_at, subject}, at a stretch of 1",
  duration = "s, at a stretch of 1",
  cruise = "speeds wanted on legs, of keyframe_times.filled",
  stretch = "factor on all times",
  legs = "ways between keyframes that are known, of ways.planned",
  corridor = "whether the flight stays within free boxes about its way",
  track = "places and times that the flight is drawn to: {places, weight}, or nil",
  -- What of the film is stated:
  --   "film"           all of it
  --   "flight"         without the camera, and without the script's own terms
  --   "unlimited"      as if the vehicle could do anything
  --   "unconstrained"  with the script's constraints judged and not held
  scope = "which part of the film is stated",
  looks_round = "whether it costs that obstacles hide the target",
  memory = "what the strategy that made the request remembers; other code leaves it alone",
})

local outcomes = record.type("outcome", {
  request = "what was asked for",
  holds = "whether the film is certified, and not only because the least violation hides in the "
    .. "verifier's tolerance",
  fault = "why the problem could not be stated (within a corridor alone), or nil; then there is "
    .. "neither solution nor verdict",
  solution = "of the solver",
  verdict = "of the verifier: feasible, failures, checks",
  task = "what the plan is judged by",
  camera = "of subjects.plan, or nil",
  legs = "the request's legs, and the ways that were planned for this attempt",
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
