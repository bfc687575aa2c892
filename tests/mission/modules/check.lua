-- SPDX-License-Identifier: Apache-2.0
-- Tests of the modules of scripts/mission. A file of them ends with `return check.all { name =
-- function, ... }`: all functions run, and the script fails with what each that failed says.
local film = require "mission.film"

local check = {}

local function shown(value)
  if type(value) ~= "table" then
    return type(value) == "string" and ("%q"):format(value) or tostring(value)
  end
  local parts = {}
  for key, item in pairs(value) do
    parts[#parts + 1] = (math.type(key) == "integer" and "" or tostring(key) .. " = ")
                        .. shown(item)
  end
  return "{" .. table.concat(parts, ", ") .. "}"
end

local function alike(got, wanted, tolerance)
  if type(got) == "number" and type(wanted) == "number" then
    return got == wanted or math.abs(got - wanted) <= tolerance
  end
  if type(got) ~= "table" or type(wanted) ~= "table" then return got == wanted end
  for key, item in pairs(wanted) do
    if not alike(got[key], item, tolerance) then return false end
  end
  for key in pairs(got) do
    if wanted[key] == nil then return false end
  end
  return true
end

-- Numbers, texts and tables of them, numbers to within `tolerance`.
function check.near(got, wanted, tolerance, what)
  if not alike(got, wanted, tolerance) then
    error((what and what .. ": " or "") .. "got " .. shown(got) .. ", wanted " .. shown(wanted), 2)
  end
end

function check.equal(got, wanted, what)
  if not alike(got, wanted, 0) then
    error((what and what .. ": " or "") .. "got " .. shown(got) .. ", wanted " .. shown(wanted), 2)
  end
end

function check.yes(condition, what)
  if not condition then error(what or "it is not so", 2) end
end

-- That `f(...)` fails with a message that has `fragment` in it.
function check.fails(fragment, f, ...)
  local good, message = pcall(f, ...)
  if good then error("no error, wanted '" .. fragment .. "'", 2) end
  if not tostring(message):find(fragment, 1, true) then
    error("the error is '" .. tostring(message) .. "', wanted '" .. fragment .. "'", 2)
  end
end

-- What a module sees of a run: options, and a failure that names an option.
function check.run(options)
  local run = { options = options or {} }
  function run:fail(option, text) error(option .. ": " .. text, 0) end
  return run
end

-- Numbers from 0 up to 1, the same in every run (Park and Miller, 1988).
function check.random(seed)
  local state = seed
  return function()
    state = state * 16807 % 2147483647
    return state / 2147483647
  end
end

function check.all(tests)
  local wrong, count = {}, 0
  for name, test in pairs(tests) do
    count = count + 1
    local good, message = pcall(test)
    if not good then wrong[#wrong + 1] = name .. ": " .. tostring(message) end
  end
  if count == 0 then error("there are no tests", 0) end
  if #wrong > 0 then
    error(#wrong .. " of " .. count .. " fail\n" .. table.concat(wrong, "\n"), 0)
  end
  return film.shot { name = "checked", keyframes = { { position = { 0, 0, 2 } } } }
end

return check
