// SPDX-License-Identifier: Apache-2.0
// A review as data.
#include <cmath>

#include "framework/flight_review/flight_review.h"

namespace lapwing {
namespace {

Value three(const Eigen::Vector3d& v) {
  return Value(Value::List{v.x(), v.y(), v.z()});
}

Value made(const FlightAlignment& a) {
  Value value = Value::map();
  value.set("clock", a.clock);
  value.set("clock_sigma", a.clock_sigma);
  value.set("offset", three(a.offset));
  value.set("offset_sigma", three(a.offset_sigma));
  value.set("turn", a.turn);
  value.set("turn_sigma", a.turn_sigma);
  value.set("residual", a.residual);
  value.set("stretched", a.stretched);
  value.set("confounded", a.confounded);
  return value;
}

Value made(const ErrorSeries& series) {
  Value value = Value::map();
  value.set("unit", series.unit);
  value.set("samples", static_cast<std::int64_t>(series.values.size()));
  value.set("median", series.median());
  value.set("percentile_95", series.quantile(0.95));
  const std::size_t worst = series.worst();
  value.set("worst", series.values[worst]);
  value.set("worst_at", series.times[worst]);
  if (series.is_signed) value.set("mean", series.mean());
  return value;
}

Value made(const FlownCheck& check) {
  Value value = Value::map();
  value.set("check", check.flown.name);
  value.set("unit", check.flown.unit);
  value.set("required", check.flown.required);
  if (check.flown.worst && std::isfinite(*check.flown.worst))
    value.set("worst", *check.flown.worst);
  value.set("limit", check.flown.limit);
  value.set("at", check.flown.at);
  value.set("kept", check.flown.pass);
  if (check.planned && std::isfinite(*check.planned)) value.set("planned", *check.planned);
  value.set("planned_kept", check.planned_pass);
  value.set("detail", check.flown.detail);
  return value;
}

Value made(const FlownView& view) {
  Value value = Value::map();
  value.set("view", static_cast<std::int64_t>(view.number));
  value.set("time", view.time);
  value.set("distance", view.distance);
  value.set("angle", view.angle);
  value.set("taken", view.taken);
  return value;
}

Value texts(const std::vector<std::string>& all) {
  Value list = Value::list();
  for (const std::string& one : all) list.push_back(one);
  return list;
}

Value made(const FlightLog& log) {
  Value value = Value::map();
  value.set("format", log.format);
  value.set("recorder", log.recorder);
  value.set("clock", log.clock);
  if (log.utc) value.set("utc", *log.utc);
  value.set("bytes", static_cast<std::int64_t>(log.bytes));
  value.set("bytes_read", static_cast<std::int64_t>(log.bytes_read));
  value.set("damage", log.damage);
  return value;
}

}  // namespace

Value to_value(const Plan& plan, const FlightReview& review) {
  Value value = Value::map();
  value.set("mission", plan.mission);
  value.set("kept", review.kept());
  value.set("verdict", verdict_of(review));
  value.set("beside", review.beside);
  value.set("beside_limit", review.beside_limit);
  value.set("share", review.share());
  value.set("log", made(review.log));
  value.set("positions", review.source);
  value.set("alignment", made(review.alignment));
  value.set("compared_from", review.flown.start);
  value.set("compared_to", review.flown.finish);
  value.set("missing_before", review.missing_before);
  value.set("missing_after", review.missing_after);
  Value& errors = value.set("errors", Value::map());
  for (const ErrorSeries& series : review.errors) errors.set(series.name, made(series));
  Value& checks = value.set("checks", Value::list());
  for (const FlownCheck& check : review.certificate.checks) checks.push_back(made(check));
  Value& views = value.set("views", Value::list());
  for (const FlownView& view : review.certificate.views) views.push_back(made(view));
  value.set("said", texts(alignment_sentences(review)));
  value.set("advice", texts(advice_of(plan, review)));
  return value;
}

}  // namespace lapwing
