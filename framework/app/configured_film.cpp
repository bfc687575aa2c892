// SPDX-License-Identifier: Apache-2.0
// A film against its configuration: what it passes, keeps away from and has in its image.
#include <optional>

#include <Eigen/Core>

#include "framework/app/configured_task.h"
#include "framework/app/stated_values.h"
#include "framework/core/number_text.h"
#include "framework/core/units.h"

namespace lapwing {
namespace {

constexpr double kSameTime = 1e-6;   // s
constexpr double kSameAngle = 1e-9;  // rad
constexpr double kTransition = 3;    // s, most that films take from one subject to the next
const double kTurn = radians(360);

class ConfiguredFilm {
 public:
  ConfiguredFilm(const Plan& plan, ConfigurationComparison& found)
      : plan_(plan), asked_(plan.configuration), found_(found) {
    shipped_ = asked_.find("passages") && asked_.find("stretch");
    timing_ = stated_text(asked_, "timing");
    find_stretch();
  }

  void compare() {
    compare_surroundings(plan_, found_);
    keyframes();
    tolerances();
    people("subjects", "subject", true);
    people("keep_away", "bystander", false);
    if (shipped_) {
      framing();
      cuts();
      constraints();
    } else {
      left_out("framing, cuts and constraints: its options are not those of films as shipped");
    }
    const auto battery = stated_number(asked_, "battery");
    if (battery && !plan_.budget)
      fault(otherwise("the budget", "not stated", plain_number(*battery) + " s"));
    else if (plan_.budget)
      compare_number("the budget", *plan_.budget, battery, " s", Than::above, found_);
    if (stated_text(asked_, "input") != "") {
      const bool keyframes = stated_tables(asked_, "keyframes").empty(),
                 subjects = stated_tables(asked_, "subjects").empty();
      const std::string what = keyframes && subjects ? "keyframes and subjects"
                               : keyframes           ? "keyframes"
                                                     : "subjects";
      if (keyframes || subjects)
        left_out(what + " of the file '" + stated_text(asked_, "input") + "'");
    }
    left_out("how the flight begins and ends");
  }

 private:
  void fault(const std::string& sentence) { found_.faults.push_back(sentence); }
  void left_out(const std::string& phrase) { found_.not_compared.push_back(phrase); }

  bool own_times() const { return timing_ == "free" || timing_ == "path_first"; }

  // The factor on all times: stated, or `auto`, when a keyframe with a time tells it.
  void find_stretch() {
    if (own_times()) {
      stretch_ = 1;
    } else if (stated_text(asked_, "stretch") != "auto") {
      stretch_ = stated_number(asked_, "stretch").value_or(1);
    } else {
      const Value::List& asked = stated_tables(asked_, "keyframes");
      for (std::size_t i = 0; i < std::min(asked.size(), plan_.task.keyframes.size()); ++i) {
        const auto time = stated_number(asked[i], "time");
        if (time && *time > 0) stretch_ = plan_.task.keyframes[i].time / *time;
      }
    }
  }

  // The subject of that name, as missions name subjects without one.
  const Value* subject(const std::string& name) const {
    const Value::List& all = stated_tables(asked_, "subjects");
    for (std::size_t i = 0; i < all.size(); ++i) {
      std::string own = stated_text(all[i], "name");
      if (own.empty()) own = all.size() == 1 ? "subject" : "subject " + std::to_string(i + 1);
      if (own == name) return &all[i];
    }
    return nullptr;
  }

  // Where a subject is at a time in the film, before it is stretched.
  static std::optional<Eigen::Vector3d> place(const Value& subject, double time) {
    const auto vector = [](const std::vector<double>& p) -> Eigen::Vector3d {
      return {p[0], p[1], p[2]};
    };
    if (const auto still = stated_numbers(subject, "position")) return vector(*still);
    std::optional<Eigen::Vector3d> last;
    double before = 0;
    for (const Value& point : stated_tables(subject, "track")) {
      const auto at = stated_number(point, "time");
      const auto position = stated_numbers(point, "position");
      if (!at || !position || position->size() != 3) return std::nullopt;
      if (time <= *at && last)
        return *last + (time - before) / (*at - before) * (vector(*position) - *last);
      last = vector(*position);
      if (time <= *at) return last;
      before = *at;
    }
    return last;
  }

  // Keyframes beside a live subject are wishes, which a plan does not promise.
  Value::List promised_keyframes() const {
    Value::List promised;
    for (const Value& keyframe : stated_tables(asked_, "keyframes")) {
      const std::string name = stated_text(keyframe, "beside");
      const Value* beside = name.empty() ? nullptr : subject(name);
      const Value* live = beside ? beside->find("live") : nullptr;
      if (!live || live->type() != Value::Type::boolean || !live->as_boolean())
        promised.push_back(keyframe);
    }
    return promised;
  }

  // Where a keyframe is, which may be beside a subject.
  std::optional<std::vector<double>> position(const Value& keyframe) const {
    std::optional<std::vector<double>> stated = stated_numbers(keyframe, "position");
    const std::string name = stated_text(keyframe, "beside");
    if (!stated || name.empty()) return stated;
    const Value* beside = subject(name);
    const auto time = stated_number(keyframe, "time");
    const auto at = beside && time ? place(*beside, *time) : std::nullopt;
    if (!at) return std::nullopt;
    for (int axis = 0; axis < 3; ++axis) (*stated)[axis] += (*at)(axis);
    return stated;
  }

  void keyframes() {
    const Value::List asked = promised_keyframes();
    const auto& here = plan_.task.keyframes;
    if (asked.empty()) return;
    if (here.size() != asked.size())
      return fault("there are " + std::to_string(here.size()) + " keyframes in the plan and " +
                   std::to_string(asked.size()) + " in its configuration");
    bool timed = false;
    for (std::size_t i = 0; i < here.size(); ++i) {
      const std::string name = "keyframe " + std::to_string(i + 1);
      const auto wanted = position(asked[i]);
      if (wanted && !same_vector(*wanted, here[i].position))
        fault(name + " has another position in the plan than in its configuration");
      timed = keyframe_time(name, asked[i], here[i]) || timed;
      yaw(name, asked[i], here[i]);
    }
    if (!timed) left_out("times of keyframes: none is stated");
  }

  // Whether the configuration settles it.
  bool keyframe_time(const std::string& name, const Value& asked, const KeyframeTask& here) {
    const auto time = stated_number(asked, "time");
    if (time && !stated_number(asked, "time_weight") && stretch_) {
      const double wanted = *time * *stretch_;
      if (std::abs(here.time - wanted) > kSameTime * std::max(1.0, std::abs(wanted)))
        fault(otherwise("the time of " + name, plain_number(here.time) + " s",
                        plain_number(wanted) + " s"));
      return true;
    }
    const auto earliest = stated_number(asked, "earliest"), latest = stated_number(asked, "latest");
    if (!own_times() || !(earliest || latest)) return false;
    const double slack = shipped_tolerance(&KeyframeTask::time_tolerance) + kSameTime;
    if (here.time < earliest.value_or(here.time) - slack ||
        here.time > latest.value_or(here.time) + slack)
      fault("the time of " + name + " is " + plain_number(here.time) +
            " s in the plan, outside the times that its configuration allows");
    return true;
  }

  void yaw(const std::string& name, const Value& asked, const KeyframeTask& here) {
    const auto wanted = stated_number(asked, "yaw_deg");
    if (!wanted) return;
    if (!here.yaw)
      return fault(otherwise("the yaw of " + name, "not stated", plain_number(*wanted) + " deg"));
    const double off = std::remainder(*here.yaw - radians(*wanted), kTurn);
    if (std::abs(off) > kSameAngle)
      fault(otherwise("the yaw of " + name, plain_number(degrees(*here.yaw)) + " deg",
                      plain_number(*wanted) + " deg"));
  }

  static double shipped_tolerance(double KeyframeTask::*which) { return KeyframeTask{}.*which; }

  // Films allow what tasks allow by themselves; with `hard`, that much and no time.
  void tolerances() {
    const auto hard = stated_number(asked_, "hard");
    if (!shipped_ && !hard) return left_out("tolerances of keyframes: none is stated");
    const KeyframeTask usual;
    for (std::size_t i = 0; i < plan_.task.keyframes.size(); ++i) {
      const KeyframeTask& k = plan_.task.keyframes[i];
      const std::string name = "tolerance of keyframe " + std::to_string(i + 1);
      compare_number("the " + name, k.tolerance, hard.value_or(usual.tolerance), " m", Than::above,
                     found_);
      compare_number("the time " + name, k.time_tolerance, hard ? 0 : usual.time_tolerance, " s",
                     Than::above, found_);
      compare_number("the yaw " + name, degrees(k.yaw_tolerance), degrees(usual.yaw_tolerance),
                     " deg", Than::above, found_);
    }
    if (!plan_.task.closed_loop_required)
      fault("the closed loop is reported only in the plan, and required of films");
  }

  static std::string name_of(const Value& asked, std::size_t index, std::size_t count,
                             const std::string& word) {
    const std::string name = stated_text(asked, "name");
    if (!name.empty()) return name;
    return count == 1 ? word : word + " " + std::to_string(index + 1);
  }

  // Without a camera that turns, a film has bystanders and no subjects.
  void people(const char* list, const std::string& word, bool filmed) {
    const Value::List& asked = stated_tables(asked_, list);
    for (std::size_t i = 0; i < asked.size(); ++i) {
      const std::string name = name_of(asked[i], i, asked.size(), word);
      const auto& all = plan_.environment.subjects;
      const auto here = std::find_if(all.begin(), all.end(),
                                     [&](const Subject& subject) { return subject.name == name; });
      if (here == all.end()) {
        fault(word + " '" + name + "' of its configuration is not in the plan");
        continue;
      }
      const std::string who = word + " '" + name + "'";
      if (here->filmed != filmed)
        fault(who + " is " + (here->filmed ? "a subject" : "a bystander") + " in the plan");
      compare_number("the distance from " + who, here->distance,
                     stated_number(asked[i], "distance"), " m", Than::below, found_);
      if (filmed) {
        compare_number("the height of " + who, here->height, stated_number(asked[i], "height"),
                       " m", Than::other, found_);
        compare_number("the width of " + who, here->width, stated_number(asked[i], "width"), " m",
                       Than::other, found_);
      }
      track(who, asked[i], *here);
    }
  }

  void track(const std::string& who, const Value& asked, const Subject& here) {
    const std::string wrong = who + " has another position in the plan than in its configuration";
    if (const auto position = stated_numbers(asked, "position")) {
      if (here.positions.size() != 1 || !same_vector(*position, here.positions[0])) fault(wrong);
      return;
    }
    const Value::List& points = stated_tables(asked, "track");
    if (points.empty()) return;
    if (points.size() != here.positions.size() || points.size() != here.times.size())
      return fault(wrong);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto position = stated_numbers(points[i], "position");
      const auto time = stated_number(points[i], "time");
      if (!position || !time) continue;
      const bool late = stretch_ && std::abs(here.times[i] - *time * *stretch_) >
                                        kSameTime * std::max(1.0, std::abs(*time * *stretch_));
      if (late || !same_vector(*position, here.positions[i])) return fault(wrong);
    }
    if (!stretch_) left_out("times of the track of " + who + ": the stretch is not known");
  }

  // Of each keyframe the subject that it looks at; empty for a point, or where nothing is said.
  std::vector<std::string> looks() const {
    const Value::List& asked = stated_tables(asked_, "keyframes");
    const Value::List& subjects = stated_tables(asked_, "subjects");
    std::vector<std::string> all(asked.size());
    std::vector<bool> said(asked.size());
    bool any = false;
    for (std::size_t i = 0; i < asked.size(); ++i) {
      all[i] = stated_text(asked[i], "subject");
      said[i] = !all[i].empty() || stated_numbers(asked[i], "look_at");
      any = any || said[i];
    }
    if (!any && subjects.size() == 1)
      return std::vector<std::string>(asked.size(), name_of(subjects[0], 0, 1, "subject"));
    for (std::size_t i = 1; i < all.size(); ++i)  // as the keyframe before
      if (!said[i] && said[i - 1]) all[i] = all[i - 1], said[i] = true;
    for (std::size_t i = all.size(); i-- > 1;)  // before the first look, as that
      if (said[i] && !said[i - 1]) all[i - 1] = all[i], said[i - 1] = true;
    return all;
  }

  bool framed(const std::string& subject, double from, double to) const {
    const auto& spans = plan_.task.framing;
    return std::any_of(spans.begin(), spans.end(), [&](const FramingTask& f) {
      return f.subject == subject && f.span.start <= from + kSameTime &&
             f.span.finish >= to - kSameTime;
    });
  }

  // A span that two keyframes settle: from one to the next of the same subject, and up to where the
  // camera leaves for another one.
  void framing() {
    const auto& here = plan_.task.keyframes;
    const std::vector<std::string> subject = looks();
    const auto wanted = [&](std::size_t i, double from, double to) {
      if (!subject[i].empty() && !framed(subject[i], from, to))
        fault("subject '" + subject[i] + "' need not be in the image from " +
              plain_number(from, 4) + " to " + plain_number(to, 4) +
              " s in the plan, and its configuration looks at it");
    };
    const bool cut = !stated_tables(asked_, "cuts").empty();
    if (!here.empty() && here.size() == subject.size()) {
      const double end = plan_.trajectory.duration();
      for (std::size_t i = 0; i < here.size(); ++i) {
        const double from = i == 0 ? 0 : here[i].time;
        double to = end;
        if (i + 1 < here.size()) {
          const double leg = here[i + 1].time - here[i].time;
          const bool same = subject[i] == subject[i + 1];
          const double still = (leg - std::min(kTransition, leg / 2)) / 2;
          to = same ? here[i + 1].time : cut ? here[i].time : here[i].time + still;
        }
        if (i == 0 || to > from) wanted(i, from, to);
      }
    }
    if (!plan_.task.framing.empty())
      compare_number("the share of framing", plan_.task.framing_share,
                     stated_number(asked_, "framing"), "", Than::below, found_);
    if (stated_text(asked_, "line_of_sight") == "required" && !plan_.task.line_of_sight_required)
      fault("the line of sight is reported only in the plan and required in its configuration");
  }

  void cuts() {
    const Value::List& asked = stated_tables(asked_, "cuts");
    if (plan_.cuts.size() > asked.size())
      return fault("there are " + std::to_string(plan_.cuts.size()) +
                   " cuts in the plan, whose footage need not be good, and " +
                   std::to_string(asked.size()) + " in its configuration");
    for (std::size_t i = 0; i < plan_.cuts.size(); ++i) {
      const std::string name = "cut " + std::to_string(i + 1);
      const auto start = stated_number(asked[i], "start"),
                 finish = stated_number(asked[i], "finish");
      if (!stretch_) {
        left_out("times of " + name + ": the stretch is not known");
        continue;
      }
      if (start && plan_.cuts[i].start < *start * *stretch_ - kSameTime)
        fault(name + " begins earlier in the plan than in its configuration");
      if (!finish)
        left_out("the end of " + name + ", which the configuration leaves open");
      else if (plan_.cuts[i].finish > *finish * *stretch_ + kSameTime)
        fault(name + " ends later in the plan than in its configuration");
    }
  }

  const StatedConstraint* constraint(const std::string& name) const {
    for (const StatedConstraint& c : plan_.constraints)
      if (c.name == name) return &c;
    return nullptr;
  }

  // What the kernel says of a function that plans cannot hold.
  static bool cannot_be_held(const std::string& unjudged) {
    for (const char* reason : {"it takes more than ", "it reads '", "it computes with a number"})
      if (unjudged.starts_with(reason)) return true;
    return false;
  }

  void judged_constraint(const std::string& what, const StatedConstraint& c) {
    if (!c.unjudged.empty() && cannot_be_held(c.unjudged))
      left_out(what + ": " + c.unjudged);
    else if (!c.unjudged.empty())
      fault(what + " is a function in its configuration, and in the plan it is not judged (\"" +
            c.unjudged + "\")");
    else if (c.results.empty())
      fault(what + " is a function in its configuration, and computes nothing in the plan");
  }

  void constraints() {
    const Value::List& asked = stated_tables(asked_, "constraints");
    std::size_t functions = 0, stated = 0;
    for (const StatedConstraint& c : plan_.constraints)
      stated += c.unjudged.empty() || cannot_be_held(c.unjudged);
    for (const Value& entry : asked) {
      const std::string type = stated_text(entry, "type"), name = stated_text(entry, "name");
      functions += type.empty();
      const std::string called = name.empty() ? type : name;
      if (called.empty()) continue;
      const StatedConstraint* here = constraint(called);
      const std::string what = "constraint '" + called + "'";
      if (!here)
        fault(what + " of its configuration is not in the plan");
      else if (type.empty())
        judged_constraint(what, *here);
    }
    const auto limit = stated_number(asked_, "speed_limit");
    functions += limit.has_value();
    if (limit) speed_limit(*limit);
    if (stated < functions)
      fault("there are " + std::to_string(stated) +
            " constraints that are functions in the plan and " + std::to_string(functions) +
            " in its configuration");
    if (!plan_.constraints.empty())
      left_out(
          "formulas, bounds and times of the script's constraints, and whether they are "
          "required: the configuration holds their names alone");
  }

  void speed_limit(double limit) {
    const StatedConstraint* here = constraint("speed_limit");
    if (!here) return fault("the speed limit of its configuration is not in the plan");
    judged_constraint("constraint 'speed_limit'", *here);
    if (!here->required) fault("the speed limit of its configuration is reported only in the plan");
    for (const ConstraintResult& result : here->results)
      if (!result.upper)
        fault("the speed limit has no upper bound in the plan");
      else
        compare_number("the speed limit", *result.upper, limit, " m/s", Than::above, found_);
  }

  const Plan& plan_;
  const Value& asked_;
  ConfigurationComparison& found_;
  bool shipped_ = false;  // has all options of the films that are shipped
  std::string timing_;
  std::optional<double> stretch_;  // on all times
};

}  // namespace

void compare_film(const Plan& plan, ConfigurationComparison& found) {
  ConfiguredFilm(plan, found).compare();
}

}  // namespace lapwing
