-- SPDX-License-Identifier: Apache-2.0
-- Makes the scene of the options `scene`, `scene_seed` and, if the mission kind has
-- it, `scene_districts` (scripts/scene).
local SCENES = "arcade, church, courtyard, depot, district, downtown, grasslands, mine, office, "
               .. "street, suburb, terrace, towers or town"

return function(run)
  local o = run.options
  if not o.scene then run:fail("scene", "missing; expected " .. SCENES) end
  local module = "scene." .. o.scene
  local found, near = lapwing.has_module(module)
  if not found then
    near = near and string.format("; did you mean '%s'?", near:sub(#"scene." + 1)) or ""
    run:fail("scene", string.format("there is no scene '%s'%s; expected %s", o.scene, near, SCENES))
  end
  local make = require(module)
  if type(make) ~= "function" then
    run:fail("scene", string.format("'%s' is a part of scenes, not a scene: expected %s", o.scene,
                                    SCENES))
  end
  if o.scene_districts and o.scene ~= "town" then
    run:fail("scene_districts", string.format("is for the scene 'town', not for '%s'", o.scene))
  end
  return make { seed = o.scene_seed, districts = o.scene_districts }
end
