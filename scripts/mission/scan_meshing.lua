-- SPDX-License-Identifier: Apache-2.0
-- How the prior mesh is made of what is known: the argument of prior:reconstruct.
return function(run)
  local surface = run.options.surface
  return { cell = surface.cell, trim = surface.trim, method = surface.method }
end
