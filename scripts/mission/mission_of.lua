-- SPDX-License-Identifier: Apache-2.0
-- A mission of a kind: its name, and its options as declared and given.
return function(kind, declarations, given, plan)
  local name = given.name
  given.name = nil
  return { kind = kind, name = name, options = lapwing.options(declarations, given), plan = plan }
end
