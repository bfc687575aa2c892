// SPDX-License-Identifier: Apache-2.0
#include "framework/conformance/sample_parameters.h"

#include <cmath>

namespace lapwing {
namespace {

class Sampler {
 public:
  Sampler(const ParameterTable& table, const StandardSetting& standard)
      : duration_(standard.horizon.duration()),
        subject_(standard.environment.subjects.front().name) {
    const StageLayout& layout = standard.layout;
    const ParameterSpec* block = table.find("block");
    if (!block || !block->default_value.is_text()) return;
    const int index = layout.find(block->default_value.as_text());
    if (index >= 0) numbers_ = layout.block(index).size;
  }

  // Required values alone; defaults fill the rest. `turn` varies the entries of a list.
  Value required(const ParameterTable& table, int turn) const {
    Value result = Value::map();
    for (const ParameterSpec& spec : table.specs())
      if (spec.required) result.set(spec.name, made_up(spec, turn));
    return result;
  }

  std::vector<ParameterCase> cases(const ParameterTable& table, int turn) const {
    const Value base = required(table, turn);
    std::vector<ParameterCase> result{{"defaults", base, true}};
    for (const ParameterSpec& spec : table.specs()) add_cases(spec, base, turn, result);
    if (!table.find("subject")) return result;
    const std::size_t count = result.size();
    for (std::size_t k = 0; k < count; ++k) {
      ParameterCase with = result[k];
      with.description += ", subject = " + subject_;
      with.parameters.set("subject", subject_);
      result.push_back(std::move(with));
    }
    return result;
  }

 private:
  static double inside(const Range& range) {
    const double low = std::isfinite(range.minimum) ? range.minimum : -1.0;
    const double high = std::isfinite(range.maximum) ? range.maximum : low + 2.0;
    return 0.5 * (low + high);
  }
  // The lowest allowed value: a little more where the minimum itself is excluded.
  static double lowest(const Range& range) {
    if (!range.minimum_excluded) return range.minimum;
    return range.minimum +
           1e-3 * (std::isfinite(range.maximum) ? range.maximum - range.minimum : 1.0);
  }

  Value list_of(double value, int count) const {
    Value list = Value::list();
    for (int i = 0; i < count; ++i) list.push_back(value + 0.1 * i);
    return list;
  }

  // x, y, z of three points, of a size that is like that of the random positions.
  static Value corner_of_a_path() {
    Value list = Value::list();
    for (const double number : {-15.0, -10.0, 2.0, 0.0, 5.0, -3.0, 12.0, -8.0, 6.0})
      list.push_back(number);
    return list;
  }

  Value made_up(const ParameterSpec& spec, int turn) const {
    static constexpr double kMoments[] = {0.31, 0.77, 1.0};  // between two stages, and on the last
    const bool time = spec.unit == "s" && !std::isfinite(spec.range.maximum);
    switch (spec.type) {
      case ParameterType::boolean:
        return true;
      case ParameterType::integer:
        return static_cast<std::int64_t>(std::ceil(inside(spec.range)));
      case ParameterType::number:
        return time ? kMoments[std::min(turn % 3 + (spec.name == "finish"), 2)] * duration_
                    : inside(spec.range);
      case ParameterType::numbers:
        if (spec.name == "points") return corner_of_a_path();
        return list_of(inside(spec.range), spec.size > 0 ? spec.size : numbers_);
      case ParameterType::choice:
        return spec.choices.front();
      case ParameterType::text:
        return spec.name == "subject" ? Value(subject_) : Value("position");
      case ParameterType::table:
        return required(*spec.table, turn);
      case ParameterType::tables:
        return entries(required(*spec.table, 0), *spec.table);
    }
    return {};
  }

  Value entries(Value first, const ParameterTable& table) const {
    Value list = Value::list();
    list.push_back(std::move(first));
    list.push_back(required(table, 1));
    list.push_back(required(table, 2));
    return list;
  }

  void add_cases(const ParameterSpec& spec, const Value& base, int turn,
                 std::vector<ParameterCase>& result) const {
    const auto add = [&](const std::string& text, Value value, bool must_work) {
      ParameterCase added{spec.name + " = " + text, base, must_work};
      added.parameters.set(spec.name, std::move(value));
      result.push_back(std::move(added));
    };
    const bool optional = !spec.required && spec.default_value.is_null();
    switch (spec.type) {
      case ParameterType::boolean:
        for (const bool value : {false, true}) add(value ? "true" : "false", value, false);
        break;
      case ParameterType::choice:
        for (const std::string& choice : spec.choices) add(choice, choice, false);
        break;
      case ParameterType::integer:
      case ParameterType::number:
        for (const double end : {lowest(spec.range), spec.range.maximum})
          if (std::isfinite(end)) add_number(spec, end, !optional, add);
        if (optional) add("a value", made_up(spec, turn), false);
        break;
      case ParameterType::numbers:
        if (optional) add("values", made_up(spec, turn), false);
        break;
      case ParameterType::table:
        for (const ParameterCase& inner : cases(*spec.table, turn))
          add(inner.description, inner.parameters, inner.must_work);
        break;
      case ParameterType::tables:
        for (const ParameterCase& inner : cases(*spec.table, 0))
          add("entries with " + inner.description, entries(inner.parameters, *spec.table),
              inner.must_work && !spec.table->find("finish"));
        break;
      case ParameterType::text:
        break;
    }
  }

  template <class Add>
  static void add_number(const ParameterSpec& spec, double value, bool must_work, Add add) {
    if (spec.type == ParameterType::integer)
      add(std::to_string(std::llround(value)), static_cast<std::int64_t>(std::llround(value)),
          must_work);
    else
      add(std::to_string(value), value, must_work);
  }

  double duration_;
  std::string subject_;
  int numbers_ = 3;
};

}  // namespace

std::vector<ParameterCase> parameter_cases(const ParameterTable& table,
                                           const StandardSetting& standard) {
  return Sampler(table, standard).cases(table, 0);
}

}  // namespace lapwing
