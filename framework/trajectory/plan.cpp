// SPDX-License-Identifier: Apache-2.0
#include "framework/trajectory/plan.h"

#include "framework/core/fields.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/trajectory/plan_digest.h"
#include "framework/trajectory/plan_sections.h"

namespace lapwing {
namespace {

const std::vector<std::string> kAxes{"east north up"};

// The altitude is that above the ellipsoid, of which a height above the ground tells nothing.
Value frame_to_value(const std::optional<GeodeticOrigin>& origin) {
  Value value = Value::map();
  value.set("axes", kAxes[0]);
  if (!origin) return value;
  Value point = Value::map();
  point.set("latitude_deg", origin->latitude_deg);
  point.set("longitude_deg", origin->longitude_deg);
  if (const auto altitude = origin->altitude()) point.set("altitude", *altitude);
  if (origin->height_of != HeightOf::ellipsoid) {
    point.set("height", origin->height);
    point.set("height_of", std::string(to_string(origin->height_of)));
  }
  value.set("geodetic_origin", std::move(point));
  return value;
}

GeodeticOrigin origin_from(Fields& point) {
  GeodeticOrigin origin{point.number("latitude_deg"), point.number("longitude_deg")};
  if (point.has("height_of") || point.has("height")) {
    const bool ground = point.choice("height_of", {"sea", "ground"}) == 1;
    origin.height_of = ground ? HeightOf::ground : HeightOf::sea;
    origin.height = point.number("height");
    if (!ground) origin.geoid_height = point.number("altitude") - origin.height;
  } else {
    origin.height = point.number("altitude");
  }
  return origin;
}

std::optional<GeodeticOrigin> frame_from(Fields fields) {
  fields.choice("axes", kAxes);
  std::optional<GeodeticOrigin> origin;
  if (fields.has("geodetic_origin")) {
    Fields point = fields.table("geodetic_origin");
    origin = origin_from(point);
    try {
      check_geodetic(origin->point(), "geodetic origin");
    } catch (const InputError& error) {
      point.add_error("", error.what());
    }
    point.finish();
  }
  fields.finish();
  return origin;
}

// The format of the document: 1 or the present one.
int format_of(Fields& fields) {
  const std::int64_t format = fields.integer("format");
  if (fields.has("format") && format != 1 && format != Plan::kFormat) {
    fields.add_error("format", "this version reads formats 1 and " + std::to_string(Plan::kFormat));
  }
  return format == 1 ? 1 : Plan::kFormat;
}

// What format 1 said elsewhere: to which of the obstacles of one kind a distance is, and in the
// options of a film whether subjects must not be hidden.
void convert(Plan& plan, Fields& fields) {
  const auto& obstacles = plan.environment.obstacles;
  for (StatedConstraint& constraint : plan.constraints)
    for (ConstraintStep& step : constraint.operations) {
      if (step.op != ConstraintOp::distance) continue;
      const std::string type = step.name == "no_fly_zone" ? "prism" : step.name;
      int number = step.component;
      std::size_t place = 0;
      for (; place < obstacles.size(); ++place)
        if (obstacles[place].type == type && obstacles[place].side == Side::keep_out &&
            number-- == 0)
          break;
      if (place == obstacles.size())
        fields.add_error("constraints", "a distance is to " + step.name + " " +
                                            std::to_string(step.component) +
                                            ", which the environment lacks");
      step.name.clear();
      step.component = static_cast<int>(place);
    }
  const Value* sight = plan.configuration.find("line_of_sight");
  if (sight && sight->is_text() && sight->as_text() == "reported")
    plan.task.line_of_sight_required = false;
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
  if (plan.home) value.set("home", home_to_value(*plan.home));
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
  const int format = format_of(fields);
  plan.mission = fields.text("mission");
  plan.kind = fields.text("kind");
  plan.geodetic_origin = frame_from(fields.table("frame"));
  if (fields.has("home")) plan.home = home_from(fields.table("home"));
  fields.table("vehicle");  // opaque here, but it must be there and be a map
  plan.vehicle = fields.opaque("vehicle");
  plan.trajectory = motion_from(fields.table("motion"));
  for (const Fields& sample : fields.tables("samples")) {
    plan.trajectory.samples.push_back(sample_from(plan.trajectory, sample));
  }
  if (fields.has("samples") && plan.trajectory.samples.empty()) {
    fields.add_error("samples", "expected at least one sample");
  }
  plan.environment = environment_from(fields.table("environment"), format);
  plan.cuts = spans_from(fields.optional_tables("cuts"));
  plan.lights = spans_from(fields.optional_tables("lights"));
  plan.budget = fields.optional_number("budget");
  plan.task = task_from(fields.table("task"));
  plan.constraints = constraints_from(fields.optional_tables("constraints"), format);
  plan.configuration = fields.opaque("configuration");
  plan.solver = fields.opaque("solver");
  plan.certificate = fields.opaque("certificate");
  if (format == 1) convert(plan, fields);
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
