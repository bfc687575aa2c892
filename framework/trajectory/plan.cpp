#include "framework/trajectory/plan.h"

#include "framework/core/fields.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/trajectory/plan_digest.h"
#include "framework/trajectory/plan_sections.h"

namespace lapwing {
namespace {

const std::vector<std::string> kModels{"force", "rotors", "path"};
const std::vector<std::string> kInputs{"held", "linear"};
const std::vector<std::string> kAxes{"east north up"};

Value sample_to_value(const Trajectory& trajectory, const Sample& s) {
  Value value = Value::map();
  value.set("time", s.time);
  value.set("position", list_of(s.position));
  if (trajectory.model != MotionModel::path) {
    value.set("velocity", list_of(s.velocity));
    value.set("acceleration", list_of(s.acceleration));
  }
  value.set("yaw", s.yaw);
  if (trajectory.model != MotionModel::path) value.set("yaw_rate", s.yaw_rate);
  if (trajectory.model == MotionModel::force) {
    value.set("force", list_of(s.force));
    value.set("yaw_torque", s.yaw_torque);
  }
  if (trajectory.model == MotionModel::rotors) {
    const Eigen::Quaterniond& q = s.orientation;
    const Eigen::Vector4d& f = s.rotor_thrusts;
    value.set("orientation", list_of({q.w(), q.x(), q.y(), q.z()}));
    value.set("body_rates", list_of(s.body_rates));
    value.set("rotor_thrusts", list_of({f[0], f[1], f[2], f[3]}));
  }
  if (trajectory.has_gimbal) {
    value.set("gimbal_yaw", s.gimbal_yaw);
    value.set("gimbal_pitch", s.gimbal_pitch);
    value.set("gimbal_yaw_rate", s.gimbal_yaw_rate);
    value.set("gimbal_pitch_rate", s.gimbal_pitch_rate);
  }
  if (trajectory.has_target) value.set("target", list_of(s.target));
  return value;
}

Sample sample_from(const Trajectory& trajectory, Fields fields) {
  Sample s;
  s.time = fields.number("time");
  s.position = fields.vector3("position");
  s.yaw = fields.number("yaw");
  if (trajectory.model != MotionModel::path) {
    s.velocity = fields.vector3("velocity");
    s.acceleration = fields.vector3("acceleration");
    s.yaw_rate = fields.number("yaw_rate");
  }
  if (trajectory.model == MotionModel::force) {
    s.force = fields.vector3("force");
    s.yaw_torque = fields.number("yaw_torque");
  }
  if (trajectory.model == MotionModel::rotors) {
    const std::vector<double> q = fields.numbers("orientation", 4);
    const std::vector<double> f = fields.numbers("rotor_thrusts", 4);
    s.orientation = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
    s.body_rates = fields.vector3("body_rates");
    s.rotor_thrusts = {f[0], f[1], f[2], f[3]};
  }
  if (trajectory.has_gimbal) {
    s.gimbal_yaw = fields.number("gimbal_yaw");
    s.gimbal_pitch = fields.number("gimbal_pitch");
    s.gimbal_yaw_rate = fields.number("gimbal_yaw_rate");
    s.gimbal_pitch_rate = fields.number("gimbal_pitch_rate");
  }
  if (trajectory.has_target) s.target = fields.vector3("target");
  fields.finish();
  return s;
}

Value motion_to_value(const Trajectory& trajectory) {
  Value value = Value::map();
  value.set("model", kModels[static_cast<std::size_t>(trajectory.model)]);
  value.set("inputs", kInputs[trajectory.inputs_held ? 0 : 1]);
  value.set("gimbal", trajectory.has_gimbal);
  value.set("target", trajectory.has_target);
  return value;
}

Trajectory motion_from(Fields fields) {
  Trajectory trajectory;
  trajectory.model = static_cast<MotionModel>(fields.choice("model", kModels));
  trajectory.inputs_held = fields.choice("inputs", kInputs) == 0;
  trajectory.has_gimbal = fields.boolean("gimbal");
  trajectory.has_target = fields.boolean("target");
  fields.finish();
  return trajectory;
}

Value frame_to_value(const std::optional<GeodeticPoint>& origin) {
  Value value = Value::map();
  value.set("axes", kAxes[0]);
  if (!origin) return value;
  Value point = Value::map();
  point.set("latitude_deg", origin->latitude_deg);
  point.set("longitude_deg", origin->longitude_deg);
  point.set("altitude", origin->altitude);
  value.set("geodetic_origin", std::move(point));
  return value;
}

std::optional<GeodeticPoint> frame_from(Fields fields) {
  fields.choice("axes", kAxes);
  std::optional<GeodeticPoint> origin;
  if (fields.has("geodetic_origin")) {
    Fields point = fields.table("geodetic_origin");
    origin = GeodeticPoint{point.number("latitude_deg"), point.number("longitude_deg"),
                           point.number("altitude")};
    try {
      check_geodetic(*origin, "geodetic origin");
    } catch (const InputError& error) {
      point.add_error("", error.what());
    }
    point.finish();
  }
  fields.finish();
  return origin;
}

void read_format(Fields& fields) {
  const std::int64_t format = fields.integer("format");
  if (fields.has("format") && format != Plan::kFormat) {
    fields.add_error("format", "this version reads format " + std::to_string(Plan::kFormat));
  }
}

}  // namespace

Value to_value(const Plan& plan) {
  Value samples = Value::list(), value = Value::map();
  for (const Sample& sample : plan.trajectory.samples) {
    samples.push_back(sample_to_value(plan.trajectory, sample));
  }
  value.set("format", Plan::kFormat);
  value.set("mission", plan.mission);
  value.set("kind", plan.kind);
  value.set("frame", frame_to_value(plan.geodetic_origin));
  value.set("vehicle", plan.vehicle);
  value.set("motion", motion_to_value(plan.trajectory));
  value.set("samples", std::move(samples));
  value.set("environment", environment_to_value(plan.environment));
  if (!plan.cuts.empty()) value.set("cuts", spans_to_value(plan.cuts));
  if (!plan.lights.empty()) value.set("lights", spans_to_value(plan.lights));
  if (plan.budget) value.set("budget", *plan.budget);
  value.set("task", task_to_value(plan.task));
  if (!plan.constraints.empty()) value.set("constraints", constraints_to_value(plan.constraints));
  if (!plan.configuration.is_null()) value.set("configuration", plan.configuration);
  if (!plan.solver.is_null()) value.set("solver", plan.solver);
  if (!plan.certificate.is_null()) value.set("certificate", plan.certificate);
  return value;
}

Plan plan_from_value(const Value& value) {
  Diagnostics errors;
  Fields fields(value, "", errors);
  Plan plan;
  read_format(fields);
  plan.mission = fields.text("mission");
  plan.kind = fields.text("kind");
  plan.geodetic_origin = frame_from(fields.table("frame"));
  fields.table("vehicle");  // opaque here, but it must be there and be a map
  plan.vehicle = fields.opaque("vehicle");
  plan.trajectory = motion_from(fields.table("motion"));
  for (const Fields& sample : fields.tables("samples")) {
    plan.trajectory.samples.push_back(sample_from(plan.trajectory, sample));
  }
  if (fields.has("samples") && plan.trajectory.samples.empty()) {
    fields.add_error("samples", "expected at least one sample");
  }
  plan.environment = environment_from(fields.table("environment"));
  plan.cuts = spans_from(fields.optional_tables("cuts"));
  plan.lights = spans_from(fields.optional_tables("lights"));
  plan.budget = fields.optional_number("budget");
  plan.task = task_from(fields.table("task"));
  plan.constraints = constraints_from(fields.optional_tables("constraints"));
  plan.configuration = fields.opaque("configuration");
  plan.solver = fields.opaque("solver");
  plan.certificate = fields.opaque("certificate");
  fields.opaque("digest");  // of what was written; see plan_digest.h
  fields.finish();
  errors.throw_if_any();
  return plan;
}

std::string plan_text(const Plan& plan) {
  Value document = to_value(plan);
  document.set("digest", digest_of(document));
  return to_json(document) + "\n";
}

void write_plan(const Plan& plan, const std::filesystem::path& path) {
  write_file_atomically(path, plan_text(plan));
}

Plan read_plan(const std::filesystem::path& path) {
  return plan_from_value(from_json(read_file(path), path.string()));
}

}  // namespace lapwing
