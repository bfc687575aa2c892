-- SPDX-License-Identifier: Apache-2.0
-- City models in CityGML as the mesh of `scan.of_mesh`: their reference system, and what of them
-- becomes a surface.
local M = {}

M.DECLARATION = {
  name = "city", type = "table", summary = "city model of `scan.of_mesh` (.gml)", table = {
    { name = "system", type = "text", default = "",
      summary = "reference system of its coordinates, as EPSG:28992; empty: as the file says" },
    { name = "zero", type = "numbers", size = 3,
      summary = "the world's origin in its coordinates, for a model without reference system; "
        .. "absent: 0, 0, 0" },
    { name = "height_unit", type = "number", unit = "m", above = 0, maximum = 1e6,
      summary = "metres per unit of its heights; absent: the unit of x and y" } } }

-- Whether the input is such a model, by its name.
function M.wanted(run)
  local input = run.options.input
  local ending = input and input:lower():match("%.(%w+)$")
  return ending == "gml" or ending == "citygml"
end

-- What is wrong before anything is read.
function M.check(run)
  if M.wanted(run) then
    if run.options.up ~= "file" then
      run:fail("up", "is for a mesh file; heights of a city model point up")
    end
    return
  end
  for _, entry in ipairs(M.DECLARATION.table) do
    if run:stated("city." .. entry.name) then
      run:fail("city." .. entry.name, "is for a city model: name one with --set input=PATH (.gml)")
    end
  end
end

function M.read(run)
  local o, city = run.options, run.options.city
  return run:read_city { file = o.input, system = city.system, zero = city.zero, unit = o.unit,
                         height_unit = city.height_unit }
end

return M
