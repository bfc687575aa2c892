-- SPDX-License-Identifier: Apache-2.0
-- Records: immutable tables with declared fields. Setting or reading a field that is not declared
-- is an error, so that a misspelt name is found.
--
--   local shots = record.type("shot", { length = "s", name = "for messages" })
--   local shot = shots.new { length = 2 }
--   local longer = shots.with(shot, { length = 3 })  -- all else as in `shot`
local record = {}

-- `declared`: a summary for each field. Fields that are not given are nil.
function record.type(what, declared)
  local article = what:find("^[aeiou]") and "an " or "a "
  local function check(name)
    if declared[name] ~= nil then return end
    error(article .. what .. " has no field '" .. tostring(name) .. "'", 3)
  end
  local function frozen(fields)
    return setmetatable({}, {
      __index = function(_, name)
        check(name)
        return fields[name]
      end,
      __newindex = function(_, name)
        error(article .. what .. " cannot be changed; make a copy with another '"
              .. tostring(name) .. "'", 2)
      end,
    })
  end

  local M = {}

  function M.new(given)
    local fields = {}
    for name, value in pairs(given) do
      check(name)
      fields[name] = value
    end
    return frozen(fields)
  end

  function M.with(made, changes)
    local fields = {}
    for name in pairs(declared) do fields[name] = made[name] end
    for name, value in pairs(changes) do
      check(name)
      fields[name] = value
    end
    return frozen(fields)
  end

  return M
end

return record
