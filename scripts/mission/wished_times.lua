-- Free timing where no path is kept: the times of keyframes are found together with the flight.
-- Every leg between two keyframes has a step of its own; a keyframe's time is exact, preferred with
-- a weight, within a window or free, and each second of flight costs `weights.time`.
local film = require "mission.film_problem"
local passages = require "mission.passages"
local surroundings = require "mission.film_environment"
local times = require "mission.keyframe_times"

local M = {}

local FEWEST = 8                       -- intervals of a leg while times are looked for
local STEP = 0.15                      -- s, of the first guess
local SHARES = { 0.95, 0.85, 0.7, 0.5 }  -- of the thrust, until the film itself holds
local LONGEST = 10                     -- times the first guess, that a leg may take
local OPEN = 1e5                       -- s, later than any film
local EXACT = 1e-4                     -- s

-- Legs at the vehicle's pace, stretched between the keyframes whose times are `fixed`.
local function paced(own, fixed)
  local list, known = { 0 }, 1
  for i = 2, #own do list[i] = list[i - 1] + own[i] - own[i - 1] end
  for i = 2, #own do
    if fixed[i] then
      local scale = math.max(fixed[i] - list[known], 0.1) / (own[i] - own[known])
      for j = known + 1, i do list[j] = list[known] + scale * (own[j] - own[known]) end
      for j = i + 1, #own do list[j] = list[j - 1] + own[j] - own[j - 1] end
      known = i
    end
  end
  return list
end

-- A first guess of the times that grants what is asked for: times first, then windows.
local function guessed(shot, vehicle)
  local keyframes, own, fixed = {}, {}, {}
  for i, k in ipairs(shot.keyframes) do keyframes[i] = { position = k.position } end
  times.fill({ keyframes = keyframes }, vehicle)
  for i, k in ipairs(shot.keyframes) do own[i], fixed[i] = keyframes[i].time, k.time end
  local list = paced(own, fixed)
  for i, k in ipairs(shot.keyframes) do
    if list[i] < (k.earliest or 0) or list[i] > (k.latest or math.huge) then
      fixed[i] = math.min(math.max(list[i], k.earliest or 0), k.latest or math.huge)
      list = paced(own, fixed)
    end
  end
  return list
end

-- What a keyframe asks of the time at the end of a leg.
local function add_wishes(p, shot, list)
  for i, k in ipairs(shot.keyframes) do
    local name, at = "time of keyframe " .. i, list[i]
    if i == 1 then
      -- The film begins in it.
    elseif k.time_weight then
      p:add_cost { type = "keyframe", name = name, block = "time", weight = k.time_weight,
                   keyframes = { { time = at, value = { k.time } } } }
    elseif k.time then
      p:add_constraint { type = "hard_keyframe", name = name, block = "time", tolerance = EXACT,
                         keyframes = { { time = at, value = { k.time } } } }
    elseif k.earliest or k.latest then
      local first, last = k.earliest or 0, k.latest or OPEN
      p:add_constraint { type = "hard_keyframe", name = name, block = "time",
                         tolerance = (last - first) / 2,
                         keyframes = { { time = at, value = { (first + last) / 2 } } } }
    end
  end
end

-- The flight alone, without the camera, with legs of free time.
local function problem_of(run, shot, list, share)
  local o = run.options
  local legs, keyframes = {}, { places = {}, yaws = {}, times = {}, positions = {}, headings = {} }
  local heading = 0
  for i, k in ipairs(shot.keyframes) do
    heading = k.yaw or heading
    local time = list[i]
    keyframes.times[i], keyframes.positions[i] = time, k.position
    keyframes.places[i], keyframes.headings[i] = { time = time, value = k.position }, heading
    if k.yaw then keyframes.yaws[#keyframes.yaws + 1] = { time = time, value = { k.yaw } } end
    if i > 1 then
      local span = time - list[i - 1]
      legs[i - 1] = { duration = span, mode = "free", longest = LONGEST * span,
                      intervals = math.max(FEWEST, math.ceil(span / STEP)) }
    end
  end
  local environment = surroundings.state(run, shot, o)
  local p = run:problem { vehicle = shot.vehicle, legs = legs, environment = environment }
  local path, corridor = passages.path(p, shot, keyframes, environment, o.planner)
  p:add_model { type = "quadrotor" }
  p:add_cost { type = "keyframe", weight = o.weights.keyframe, keyframes = keyframes.places }
  p:add_cost(film.parts.smoothness(o, shot.vehicle))
  p:add_cost { type = "yaw_derivative", name = "yaw", weight = o.weights.yaw }
  p:add_cost { type = "input_effort", name = "effort", weight = o.weights.effort }
  p:add_cost { type = "flight_time", weight = o.weights.time }
  p:add_constraint { type = "input_limits", across = "extent", share = share }
  p:add_constraint { type = "state_limits" }
  p:add_constraint { type = "hard_keyframe", tolerance = o.hard or film.MISS,
                     keyframes = keyframes.places }
  if #keyframes.yaws > 0 then
    p:add_cost { type = "keyframe", name = "keyframe_yaw", block = "yaw",
                 weight = o.weights.keyframe, keyframes = keyframes.yaws }
  end
  p:add_constraint(film.parts.boundary(o, 1, #keyframes.yaws == 0 and 0 or nil))
  surroundings.add(p, environment, nil, corridor)
  surroundings.add_speed_limit(p, o, true)
  add_wishes(p, shot, list)
  p:guess_path(film.parts.guess(keyframes, nil, path))
  p:finish()
  return p
end

-- The times of all keyframes, or nil and what the solver says.
local function found(run, shot, list, share)
  local o = run.options
  local solution = run:solve(problem_of(run, shot, list, share), o.solver)
  if solution.status == "unsupported" then run:fail("solver", solution.message) end
  if solution.status ~= "optimal" and solution.status ~= "feasible" then
    return nil, solution.status .. ": " .. solution.message
  end
  local chosen, clock = { 0 }, 0
  for i, leg in ipairs(solution.legs) do
    clock = clock + leg
    chosen[i + 1] = shot.keyframes[i + 1].time and not shot.keyframes[i + 1].time_weight
                    and shot.keyframes[i + 1].time or clock
  end
  return chosen
end

-- The film at the times found; where it does not hold, with more thrust to spare. Gives what came
-- of it, sentences, and figures.
function M.fly(run, shot, attempt, holds)
  local o = run.options
  local wanted = shot.keyframes
  if o.stretch ~= 1 then run:fail("stretch", "timing = \"free\" finds the times itself") end
  if #wanted < 2 then run:fail("keyframes", "timing = \"free\" needs two at least") end
  if (wanted[1].time or wanted[1].earliest or 0) > 0 then
    run:fail("keyframes[1]", "timing = \"free\" starts in the first keyframe, at 0 s")
  end
  local last = wanted[#wanted]
  if shot.duration and not (last.time or last.earliest or last.latest) then
    last.time = shot.duration
  end
  times.unwrap_yaw(wanted)
  local list, tried = guessed(shot, shot.vehicle), nil
  for _, share in ipairs(SHARES) do
    local chosen, why = found(run, shot, list, share)
    if not chosen then
      if tried then break end
      run:fail("keyframes", "no times grant every wish within the vehicle's limits: " .. why)
    end
    local own = {}
    for i, k in ipairs(wanted) do
      own[i] = { position = k.position, yaw_deg = k.yaw_deg, yaw = k.yaw, look_at = k.look_at,
                 subject = k.subject, time = chosen[i] }
    end
    shot.keyframes, shot.duration = own, chosen[#chosen]
    times.check_battery(run, shot, 1)
    tried = attempt(run, shot, 1)
    tried.figures = { duration = shot.duration, share = share }
    shot.keyframes = wanted
    if holds(tried) or run:cancelled() then return tried, {}, tried.figures end
  end
  return tried, { string.format("at the times found with %.2g of the thrust: %s",
                                tried.figures.share,
                                tried.verdict.failures[1] or tried.solution.message) },
         tried.figures
end

return M
