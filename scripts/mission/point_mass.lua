-- SPDX-License-Identifier: Apache-2.0
-- The motion of the vehicle in films, races, light paintings and scans: the vehicle model, the
-- costs of its motion, and its limits. They depend on the blocks of the model: the point mass
-- (`quadrotor`, thesis 3.1 and 3.2) has a force, others have an acceleration, or a wing.
local M = {}

M.GRAVITY = 9.80665  -- m/s^2

-- The model that an option names, as a problem takes it.
local function chosen(model)
  if type(model) == "string" then return { type = model } end
  return model or { type = "quadrotor" }
end

-- Blocks that films, light paintings and scans read, in addition to those that terms read.
function M.check(p, model)
  for _, block in ipairs { "position", "velocity", "yaw" } do
    if not p:has_block(block) then
      lapwing.fail(string.format(
        "model: '%s' has no block '%s', which this mission reads: choose a vehicle model "
        .. "with a yaw, such as quadrotor, velocity or fixed_wing", model.type, block))
    end
  end
end

-- The penalised derivative of the position. From the third order on it is a derivative of force
-- over mass, or of the acceleration. The value is the same, but the fourth difference of positions
-- has rounding errors that are larger by 1 / step^2. The model of a wing has accelerations along,
-- across and up; differences of positions do not see accelerations that alternate.
local function smoothness_of(p, vehicle, smooth)
  if smooth.order > 2 and p:has_block("force") then
    return { block = "force", order = smooth.order - 2, weight = smooth.weight / vehicle.mass ^ 2 }
  elseif smooth.order > 2 and p:has_block("acceleration") then
    return { block = "acceleration", order = smooth.order - 2, weight = smooth.weight }
  elseif smooth.order > 2 and p:has_block("lateral_acceleration") then
    return { block = "lateral_acceleration forward_acceleration climb_acceleration",
             order = smooth.order - 2, weight = smooth.weight }
  end
  return { order = smooth.order, weight = smooth.weight }
end

-- Adds the model, the costs of its motion, and its limits to a problem:
--   model       name or table of a vehicle model; absent: quadrotor
--   smoothness  {order, weight, name}  the penalised derivative of the position, per
--               (m/s^order)^2 s
--   force       {order, weight}        in place of it: a derivative of the force itself
--   yaw         {weight, order}        the derivative of the heading; the second unless said
--   effort      weight                 of forces beyond hovering; absent: none. A model without
--               forces has none either
--   inputs      {across, norm, share}  of the constraint `input_limits`; absent: no limits at all
--   lower       {x, y, z}              of the constraint `state_limits`
-- Terms are added in this order, behind those that the problem has.
function M.add(p, vehicle, motion)
  local model = chosen(motion.model)
  p:add_model(model)
  M.check(p, model)
  local force = motion.force
  if motion.smoothness then
    force = smoothness_of(p, vehicle, motion.smoothness)
    force.name = motion.smoothness.name
  elseif force then
    force = { block = "force", order = force.order, weight = force.weight }
  end
  if force then
    p:add_cost { type = "derivative", name = force.name or "smoothness", block = force.block,
                 order = force.order, weight = force.weight }
  end
  p:add_cost { type = "yaw_derivative", name = "yaw", weight = motion.yaw.weight,
               order = motion.yaw.order }
  local forces = p:has_block("force") and p:has_block("yaw_torque")
  if motion.effort and forces then
    p:add_cost { type = "input_effort", name = "effort", weight = motion.effort }
  end
  if not motion.inputs then return end
  if forces then
    p:add_constraint { type = "input_limits", across = motion.inputs.across,
                       norm = motion.inputs.norm, share = motion.inputs.share }
  end
  p:add_constraint { type = "state_limits", lower = motion.lower }
end

-- Refuses what a vehicle that cannot stand still cannot do: `what` is the option, `why` the
-- sentence behind this reason.
function M.must_rest(run, p, what, why)
  if p:rests() then return end
  run:fail(what, "the model of this vehicle cannot stand still; " .. why)
end

-- The headings along a list of places, each on the turn nearest to the one before.
function M.courses(positions)
  local yaws, before = {}, 0
  for i = 1, #positions do
    local from, to = positions[math.max(1, i - 1)], positions[math.min(#positions, i + 1)]
    local d = lapwing.vector(to) - from
    local yaw = before
    if lapwing.norm { d.x, d.y } > 1e-6 then
      yaw = math.atan(d.y, d.x)
      yaw = yaw - 2 * math.pi * math.floor((yaw - before) / (2 * math.pi) + 0.5)
    end
    yaws[i], before = yaw, yaw
  end
  return yaws
end

-- The share of its thrust, at most `thrust` N, that carries the vehicle.
function M.hovering_share(vehicle, thrust)
  return M.GRAVITY * vehicle.mass / thrust
end

return M
