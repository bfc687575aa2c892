-- SPDX-License-Identifier: Apache-2.0
-- Times of keyframes as variables: what they cost, and what is read off a solution.
local check = require "check"
local film_times = require "mission.film_times"
local requests = require "mission.film_request"

local wishes = { {}, { time = 4, time_weight = 2 }, {}, { time = 10 } }
local solution = { legs = { 3, 2, 5.00004 },
                   path = { 0, 0, 0,  1, 0, 0,  2, 0, 0,  3, 0, 0,  5, 0, 0,  7, 0, 0,  9, 0, 0 } }

return check.all {
  ["times are the ends of legs, and exact ones exact"] = function()
    check.near(film_times.of(solution, wishes), { 0, 3, 5, 10 }, 0)
  end,

  ["a second costs its weight, and a preferred time its squared error"] = function()
    check.near(film_times.cost(0.5, wishes, { 0, 3, 5, 10 }), 0.5 * 10 + 2 * 1, 1e-12)
  end,

  ["times are open unless all are exact"] = function()
    check.near(film_times.open(wishes), true, 0)
    check.near(film_times.open { {}, { time = 3 }, { time = 5 } }, false, 0)
    check.near(film_times.open { {}, { time = 3 }, { latest = 5 } }, true, 0)
  end,

  ["places lie at their times, the ends of legs among them"] = function()
    local legs = { { intervals = 3 }, { intervals = 1 }, { intervals = 2 } }
    local places = film_times.places(solution, legs, 2)
    check.near(places, { { time = 0, value = { 0, 0, 0 } }, { time = 3, value = { 3, 0, 0 } },
                         { time = 5, value = { 5, 0, 0 } }, { time = 7.50002, value = { 7, 0, 0 } },
                         { time = 10.00004, value = { 9, 0, 0 } } }, 1e-12)
  end,

  ["a request at other times keeps the rest"] = function()
    local request = requests.first { keyframes = { { position = { 0, 0, 1 }, time = 0 },
                                                   { position = { 4, 0, 1 }, time = 2, yaw = 1 } },
                                     duration = 2, wishes = {} }
    local later = film_times.set(request, { 0, 3 }, { may_fail = true })
    check.near(later.keyframes[2], { position = { 4, 0, 1 }, time = 3, yaw = 1 }, 0)
    check.near({ later.duration, later.may_fail, request.duration }, { 3, true, 2 }, 0)
  end,
}
