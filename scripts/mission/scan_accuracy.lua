-- SPDX-License-Identifier: Apache-2.0
-- As many batteries as a predicted accuracy takes, in place of a given number of them.
local M = {}

M.DECLARATIONS = {
  { name = "accuracy", type = "number", unit = "m", above = 0, maximum = 100,
    summary = "standard deviation, by the prediction of triangulation, with which images locate "
      .. "the surface: as many batteries as that takes, `batteries` at most" },
  { name = "accuracy_share", type = "number", default = 0.9, above = 0, maximum = 1,
    summary = "share of the surface for which `accuracy` holds, of what all views within reach "
      .. "can locate so" },
}

local MOST = 100  -- batteries, where no number is stated

function M.wanted(run) return run.options.accuracy ~= nil end

-- The largest number of batteries.
function M.most(run)
  if M.wanted(run) and not run:stated("batteries") then return MOST end
  return run.options.batteries
end

function M.check(run)
  if not M.wanted(run) and run:stated("accuracy_share") then
    run:fail("accuracy_share", "is the share for which an accuracy holds: set accuracy")
  end
end

-- More batteries would take no further image: every view is taken, or a tour has nothing to see.
local function exhausted(team)
  if team.images >= team.reachable then return true end
  for _, tour in ipairs(team.tours) do
    if tour.images <= 1 then return true end
  end
  return false
end

local function percent(part, whole) return 100 * part / whole end

local function refuse(run, last, target, possible)
  local o = run.options
  local why = last.exhausted and "further batteries would see nothing new"
    or string.format("at most %d are allowed", M.most(run))
  local share = math.floor(1000 * last.area / possible) / 1000
  run:fail("accuracy", string.format(
    "the images of %d %s locate %.4g m^2 to %.4g m; %.4g m^2 are wanted, %.4g %% of what all views "
    .. "within reach can locate so, and %s. Expected accuracy_share at most %.4g, a larger "
    .. "accuracy%s", last.batteries, last.batteries == 1 and "battery" or "batteries", last.area,
    o.accuracy, target, 100 * o.accuracy_share, why, share,
    last.exhausted and ", a longer tour.budget, or more candidates" or ", or more batteries"))
end

-- The team with the fewest batteries that is found to reach the accuracy, the evaluations of all
-- that were tried, and what was found of it. Without an accuracy the team of `batteries`.
-- `solve(batteries)` gives a team and its evaluations; `first` is the number that is tried first,
-- or nil.
--
-- How: numbers are tried from `first` on, each the number that the area of the last one lets expect
-- but at most twice it, until one reaches the accuracy; then between it and the largest that did
-- not, until those are neighbours. Every drone has a battery.
function M.search(run, solve, first)
  local o = run.options
  if not M.wanted(run) then return solve(o.batteries) end
  local possible, known, target
  local spent, tried = 0, 0
  local function try(batteries)
    local team, evaluations = solve(batteries)
    local function area(reachable)
      return run:accurate_area { team = team, accuracy = o.accuracy, pixel_error = o.pixel_error,
                                 reachable = reachable }
    end
    spent, tried = spent + evaluations, tried + 1
    if not possible then
      possible, known = area(true)
      target = o.accuracy_share * possible
      if possible <= 0 then
        run:fail("accuracy", string.format(
          "no two views within reach of a tour locate any of the %.4g m^2 of known surface to "
          .. "%.4g m: expected a larger accuracy, a camera with more pixels, or a longer "
          .. "tour.budget", known, o.accuracy))
      end
    end
    local found = { team = team, batteries = batteries, area = (area(false)),
                    exhausted = exhausted(team) }
    found.enough = found.area >= target
    return found
  end
  local short, enough = { batteries = o.drones - 1, area = 0 }, nil
  local batteries = first or o.drones
  repeat
    local found = try(batteries)
    if found.enough then enough = found else short = found end
    local over = run:cancelled()
    if not enough and not over then
      if found.exhausted or batteries >= M.most(run) then refuse(run, found, target, possible) end
      local expected = math.ceil(batteries * target / math.max(found.area, 1e-9 * target))
      batteries = math.min(M.most(run), 2 * batteries, math.max(batteries + 1, expected))
    elseif enough then
      local part = (target - short.area) / (enough.area - short.area)
      local between = short.batteries + part * (enough.batteries - short.batteries)
      batteries = math.max(short.batteries + 1,
                           math.min(enough.batteries - 1, math.ceil(between)))
    end
  until over or enough and enough.batteries - short.batteries <= 1
  local best = enough or short
  return best.team, spent, { batteries = best.batteries, area = best.area, possible = possible,
                             known = known, tried = tried, reached = enough ~= nil }
end

-- A sentence for the user, and the figures for --json.
function M.told(run, found)
  local o = run.options
  local note = string.format(
    "%d %s %s an accuracy of %.4g m for %.4g m^2 of surface, %.3g %% of what all views within "
    .. "reach can locate so, which is %.3g %% of the known surface", found.batteries,
    found.batteries == 1 and "battery" or "batteries",
    found.reached and "reach" or "(cancelled before more were tried) reach", o.accuracy,
    found.area, percent(found.area, found.possible), percent(found.possible, found.known))
  return note, { wanted = o.accuracy, share = o.accuracy_share, area = found.area,
                 possible = found.possible, known = found.known, batteries = found.batteries,
                 tried = found.tried }
end

return M
