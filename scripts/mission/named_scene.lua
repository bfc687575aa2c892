-- The scene that a mission's options `scene` and `scene_seed` name, made (scripts/scene).
local SCENES = "arcade, church, courtyard, district, downtown, office, street, suburb or towers"

return function(run)
  local o = run.options
  if not o.scene then run:fail("scene", "say which: " .. SCENES) end
  local found, make = pcall(require, "scene." .. o.scene)
  if not found and string.find(make, "module 'scene.", 1, true) then
    local near = string.match(make, "did you mean 'scene%.([%w_]+)'")
    run:fail("scene", string.format("there is no scene '%s'%s; expected %s", o.scene,
                                    near and "; did you mean '" .. near .. "'?" or "", SCENES))
  elseif not found then
    error(make, 0)
  end
  if type(make) ~= "function" then
    run:fail("scene", string.format("'%s' is a part of scenes, no scene: expected %s", o.scene,
                                    SCENES))
  end
  return make { seed = o.scene_seed }
end
