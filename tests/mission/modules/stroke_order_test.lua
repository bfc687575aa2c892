-- SPDX-License-Identifier: Apache-2.0
-- The order of strokes: what it must keep, against the best order of few strokes, and dashes of
-- one line, whose best order is known.
local check = require "check"
local order = require "mission.stroke_order"

local T = {}

local function way(strokes)
  local sum = 0
  for i = 2, #strokes do
    local a, b = strokes[i - 1][#strokes[i - 1]], strokes[i][1]
    sum = sum + math.sqrt((a[1] - b[1]) ^ 2 + (a[2] - b[2]) ^ 2)
  end
  return sum
end

local function turned(stroke)
  local made = {}
  for i, p in ipairs(stroke) do made[#stroke + 1 - i] = p end
  return made
end

local function key(stroke)
  local function text(s)
    local parts = {}
    for i, p in ipairs(s) do parts[i] = ("%.17g,%.17g"):format(p[1], p[2]) end
    return table.concat(parts, " ")
  end
  local one, other = text(stroke), text(turned(stroke))
  return one < other and one or other
end

local function random_strokes(count, seed)
  local random, strokes = check.random(seed), {}
  for i = 1, count do
    strokes[i] = {}
    for k = 1, 2 + math.floor(3 * random()) do strokes[i][k] = { 10 * random(), 10 * random() } end
  end
  return strokes
end

-- The shortest way through all strokes after the first, each from either end, by trying all.
local function best(strokes)
  local least = math.huge
  local function go(at, left, length)
    if length >= least then return end
    if #left == 0 then least = length return end
    for k = 1, #left do
      local rest = table.move(left, 1, #left, 1, {})
      local stroke = table.remove(rest, k)
      for _, s in ipairs { stroke, turned(stroke) } do
        local step = math.sqrt((at[1] - s[1][1]) ^ 2 + (at[2] - s[1][2]) ^ 2)
        go(s[#s], rest, length + step)
      end
    end
  end
  go(strokes[1][#strokes[1]], table.move(strokes, 2, #strokes, 1, {}), 0)
  return least
end

function T.every_stroke_is_drawn_once()
  for count = 1, 12 do
    local strokes = random_strokes(count, 100 + count)
    local result = order.short(strokes)
    local before, after = {}, {}
    for i, s in ipairs(strokes) do before[i] = key(s) end
    for i, s in ipairs(result) do after[i] = key(s) end
    table.sort(before)
    table.sort(after)
    check.equal(after, before)
    check.equal(result[1], strokes[1], "the first stays first, as it was given")
  end
  check.equal(order.short({}), {})
end

function T.what_was_given_is_not_changed()
  local strokes, copy = random_strokes(9, 7), random_strokes(9, 7)
  order.short(strokes)
  check.equal(strokes, copy)
end

-- Nearest neighbours improved by turns are no proof of the shortest way, but near to it.
function T.the_way_is_near_the_shortest()
  local sum, least = 0, 0
  for seed = 1, 12 do
    local strokes = random_strokes(5, seed)
    local found, shortest = way(order.short(strokes)), best(strokes)
    check.yes(found >= shortest - 1e-9, "no way is shorter than the shortest")
    sum, least = sum + found, least + shortest
  end
  check.yes(sum <= 1.1 * least, ("all together %g of %g"):format(sum, least))
end

-- No part of the order turned around makes the way shorter.
function T.no_turn_makes_it_shorter()
  for seed = 1, 5 do
    local result = order.short(random_strokes(14, 40 + seed))
    local length = way(result)
    for i = 2, #result do
      for j = i, #result do
        local other = table.move(result, 1, #result, 1, {})
        for k = i, j do other[k] = turned(result[i + j - k]) end
        check.yes(way(other) >= length - 1e-6, "turning " .. i .. " to " .. j)
      end
    end
  end
end

function T.dashes_of_a_line_are_drawn_along_it()
  local dashes, random = {}, check.random(11)
  for k = 0, 19 do dashes[k + 1] = { { k, 0 }, { k + 0.5, 0 } } end
  local first = table.remove(dashes, 1)
  for i = #dashes, 2, -1 do
    local j = 1 + math.floor(random() * i)
    dashes[i], dashes[j] = dashes[j], dashes[i]
  end
  for i, dash in ipairs(dashes) do
    if i % 2 == 0 then dashes[i] = turned(dash) end
  end
  table.insert(dashes, 1, first)
  check.near(way(order.short(dashes)), 19 * 0.5, 1e-9)
end

function T.the_same_comes_out_every_time()
  check.equal(order.short(random_strokes(20, 3)), order.short(random_strokes(20, 3)))
  -- Many at one place end as well.
  local same = {}
  for i = 1, 30 do same[i] = { { 1, 1 }, { 1, 1 } } end
  check.equal(#order.short(same), 30)
end

return check.all(T)
