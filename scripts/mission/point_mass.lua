-- The vehicle as a point mass with a heading, moved by a force and a yaw torque (thesis 3.1 and
-- 3.2): what films, races, light paintings and scans have in common in how it flies.
local M = {}

M.GRAVITY = 9.80665  -- m/s^2

-- Adds the model, what its motion costs, and its limits to a problem:
--   smoothness  {order, weight, name}  the derivative of the position that is kept small, per
--               (m/s^order)^2 s. From the third on it is taken from the force over the mass, which
--               is the acceleration: the same figure, while the fourth difference of positions has
--               rounding errors 1 / step^2 larger
--   force       {order, weight}        in place of it: a derivative of the force itself
--   yaw         {weight, order}        the derivative of the heading; the second unless said
--   effort      weight                 of forces beyond hovering; absent: none
--   inputs      {across, norm, share}  of the constraint `input_limits`; absent: no limits at all
--   lower       {x, y, z}              of the constraint `state_limits`
-- Terms are added in this order, behind those that the problem has.
function M.add(p, vehicle, motion)
  p:add_model { type = "quadrotor" }
  local smooth, force = motion.smoothness, motion.force
  if smooth and smooth.order > 2 then
    force = { name = smooth.name, order = smooth.order - 2,
              weight = smooth.weight / vehicle.mass ^ 2 }
  elseif smooth then
    p:add_cost { type = "derivative", name = smooth.name or "smoothness", order = smooth.order,
                 weight = smooth.weight }
  end
  if force then
    p:add_cost { type = "derivative", name = force.name or "smoothness", block = "force",
                 order = force.order, weight = force.weight }
  end
  p:add_cost { type = "yaw_derivative", name = "yaw", weight = motion.yaw.weight,
               order = motion.yaw.order }
  if motion.effort then
    p:add_cost { type = "input_effort", name = "effort", weight = motion.effort }
  end
  if not motion.inputs then return end
  p:add_constraint { type = "input_limits", across = motion.inputs.across,
                     norm = motion.inputs.norm, share = motion.inputs.share }
  p:add_constraint { type = "state_limits", lower = motion.lower }
end

-- The share of its thrust, at most `thrust` N, that carries the vehicle.
function M.hovering_share(vehicle, thrust)
  return M.GRAVITY * vehicle.mass / thrust
end

return M
