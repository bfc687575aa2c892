// SPDX-License-Identifier: Apache-2.0
#include "framework/app/provenance.h"

#include <algorithm>

#include "framework/app/configured_task.h"
#include "framework/app/plan_sources.h"
#include "framework/app/stated_values.h"
#include "framework/config/shipped.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/log.h"
#include "framework/core/number_text.h"
#include "framework/core/units.h"
#include "framework/export/run_folder.h"
#include "framework/geometry/mesh_file.h"
#include "framework/trajectory/fleet.h"
#include "framework/verify/provenance.h"
#include "framework/verify/verify.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kShownDigits = 12;  // of a digest, in a line
constexpr std::size_t kSectionsListed = 8;

// Equal vehicles have equal digests, whatever they are called.
std::string vehicle_digest(const Value& vehicle) {
  Value nameless = Value::map();
  for (const auto& [key, value] : vehicle.as_map())
    if (key != "name") nameless.set(key, value);
  return canonical_sha256(nameless);
}

struct Counted {
  std::string key, one, many;
  std::size_t count;
};

// By type, in the order of their first ones; what the flight stays inside of last.
std::vector<Counted> obstacles_in(const Environment& e) {
  std::vector<Counted> counts;
  for (const Side side : {Side::keep_out, Side::keep_inside})
    for (const Obstacle& obstacle : e.obstacles) {
      if (obstacle.side != side) continue;
      const std::string inside = side == Side::keep_inside ? "_kept_inside" : "";
      const std::string key = obstacle.type + inside;
      auto found = std::find_if(counts.begin(), counts.end(),
                                [&](const Counted& c) { return c.key == key; });
      if (found == counts.end()) {
        const std::string words = obstacle.type == "prism"
                                      ? inside.empty() ? "no-fly zone" : "flight zone"
                                  : inside.empty() ? obstacle.type
                                                   : "inside of a " + obstacle.type;
        const bool hisses = words.ends_with("x") || words.ends_with("sh") || words.ends_with("s");
        counts.push_back({key, words, words + (hisses ? "es" : "s"), 0});
        found = counts.end() - 1;
      }
      ++found->count;
    }
  return counts;
}

std::vector<Counted> task_in(const Plan& plan) {
  const Task& t = plan.task;
  return {{"keyframes", "keyframe", "keyframes", t.keyframes.size()},
          {"framing", "span of framing", "spans of framing", t.framing.size()},
          {"gates", "gate", "gates", t.gates.size()},
          {"strokes", "stroke", "strokes", t.strokes.size()},
          {"views", "view", "views", t.scan ? t.scan->views.size() : 0}};
}

std::string in_words(const std::vector<Counted>& counts, const char* none) {
  std::string words;
  for (const Counted& c : counts)
    if (c.count > 0)
      words += (words.empty() ? "" : ", ") + std::to_string(c.count) + " " +
               (c.count == 1 ? c.one : c.many);
  return words.empty() ? none : words;
}

Value as_value(const std::vector<Counted>& counts) {
  Value value = Value::map();
  for (const Counted& c : counts) value.set(c.key, static_cast<std::int64_t>(c.count));
  return value;
}

// The largest tolerance of each kind that the task allows itself.
Value tolerances_of(const Plan& plan) {
  const Task& task = plan.task;
  Value value = Value::map();
  KeyframeTask widest{.tolerance = 0, .time_tolerance = 0, .yaw_tolerance = 0};
  for (const KeyframeTask& k : task.keyframes) {
    widest.tolerance = std::max(widest.tolerance, k.tolerance);
    widest.time_tolerance = std::max(widest.time_tolerance, k.time_tolerance);
    widest.yaw_tolerance = std::max(widest.yaw_tolerance, k.yaw_tolerance);
  }
  if (!task.keyframes.empty()) {
    value.set("keyframe", widest.tolerance);
    value.set("keyframe_time", widest.time_tolerance);
    value.set("keyframe_yaw", widest.yaw_tolerance);
  }
  if (!task.framing.empty()) value.set("framing_share", task.framing_share);
  if (!task.strokes.empty()) value.set("drawing", task.drawing_tolerance);
  if (task.scan) {
    value.set("view", task.scan->tolerance);
    value.set("view_direction", task.scan->angle_tolerance);
    value.set("seen_share", task.scan->seen_share);
  }
  value.set("closed_loop_required", task.closed_loop_required);
  return value;
}

std::string tolerances_in_words(const Value& tolerances) {
  std::string words;
  const auto add = [&](const char* key, const char* before, double factor, const char* unit) {
    const Value* value = tolerances.find(key);
    if (value)
      words += (words.empty() ? "" : ", ") + std::string(before) +
               plain_number(factor * value->as_number(), 3) + unit;
  };
  add("keyframe", "keyframes ", 1, " m");
  add("keyframe_time", "", 1, " s");
  add("keyframe_yaw", "", degrees(1), " deg");
  add("framing_share", "framing at least ", 100, " % of the time");
  add("drawing", "drawing ", 1, " m");
  add("view", "views ", 1, " m");
  add("view_direction", "", degrees(1), " deg");
  add("seen_share", "seen again at least ", 100, " %");
  if (!tolerances.at("closed_loop_required").as_boolean())
    words += std::string(words.empty() ? "" : ", ") + "the closed loop is reported only";
  return words.empty() ? "no requirement of the task" : words;
}

// What is known of a plan's vehicle, obstacles and document, in the order in which it is said.
class Examination {
 public:
  Examination(const Plan& plan, const DigestFindings* digest, const Judges& judges)
      : digest_(digest), judges_(judges), judged_(plan) {
    configs_ = shipped_folder("configs");
    if (judges.vehicle.empty())
      compare_vehicle(plan);
    else
      take_vehicle(plan);
    if (judges.environment.empty()) {
      ConfigurationComparison found = compare_with_configuration(plan);
      for (std::string& fault : found.faults) faults_.push_back(std::move(fault));
      not_compared_ = std::move(found.not_compared);
    } else {
      judged_ = with_environment(std::move(judged_), judges.environment, elsewhere_);
      not_compared_.push_back("obstacles and task: --environment judges");
      doubt_meshes();
    }
    if (!compared_) not_compared_.insert(not_compared_.begin(), "the vehicle: it has no file");
    if (digest) compare_digest();
  }

  const Plan& plan() const { return judged_; }
  // See VerifyRequest.
  const std::map<std::string, fs::path>& elsewhere() const { return elsewhere_; }
  Provenance provenance() const { return {summary(), faults_}; }

  Value value() const {
    Value object = Value::map();
    Value& vehicle = object.set("vehicle", Value::map());
    vehicle.set("name", name());
    vehicle.set("source", source_);
    vehicle.set("compared", compared_);
    vehicle.set("sha256", vehicle_digest(judged_.vehicle));
    Value& environment = object.set("environment", as_value(obstacles_in(judged_.environment)));
    environment.set("margin", judged_.environment.margin);
    environment.set("source",
                    judges_.environment.empty() ? "the plan" : judges_.environment.string());
    Value& task = object.set("task", as_value(task_in(judged_)));
    task.set("kind", judged_.kind);
    if (judged_.budget) task.set("budget", *judged_.budget);
    object.set("tolerances", tolerances_of(judged_));
    if (digest_) {
      Value& document = object.set("document", Value::map());
      document.set("sha256", digest_->sha256);
      document.set("stated", digest_->stated);
      document.set("changed", texts(digest_->changed));
    }
    object.set("faults", texts(faults_));
    object.set("not_compared", texts(not_compared_));
    object.set("remarks", texts(remarks_));
    return object;
  }

  std::string lines() const {
    const Environment& e = judged_.environment;
    std::string text =
        "  vehicle     " + vehicle_in_words() + "\n  obstacles   " + obstacles() +
        (judges_.environment.empty() ? "" : ", of " + judges_.environment.string()) +
        (e.subjects.empty() ? ""
                            : "; " + std::to_string(e.subjects.size()) +
                                  (e.subjects.size() == 1 ? " subject" : " subjects")) +
        "\n  task        " + task() + "\n  tolerances  " +
        tolerances_in_words(tolerances_of(judged_)) + "\n";
    if (digest_)
      text += "  document    sha256 " + digest_->sha256.substr(0, kShownDigits) +
              (!digest_->stated           ? ", states no digest"
               : digest_->changed.empty() ? ", as it was written"
                                          : ", changed since it was written") +
              "\n";
    for (const std::string& left : not_compared_) text += "  not compared  " + left + "\n";
    for (const std::string& remark : remarks_) text += "  note        " + remark + "\n";
    return text;
  }

 private:
  static Value texts(const std::vector<std::string>& all) {
    return Value(Value::List(all.begin(), all.end()));
  }
  std::string name() const {
    const Value* name = judged_.vehicle.find("name");
    return name && name->is_text() ? name->as_text() : "";
  }

  void compare_vehicle(const Plan& plan) {
    VehicleSource source = vehicle_source_of(plan, configs_);
    source_ = source.name;
    if (!source.vehicle) {
      if (!source.problem.empty()) faults_.push_back(source.problem);
      return;
    }
    compared_ = true;
    if (!source.problem.empty()) faults_.push_back(source.problem);
    source.vehicle->name = name();
    // An option of the mission stands above the vehicle's file.
    if (const std::string named = stated_text(plan.configuration, "controller"); !named.empty())
      source.vehicle->controller = Value(named);
    for (std::string& one : differences(plan.vehicle, to_value(*source.vehicle), source.name))
      faults_.push_back("vehicle." + one);
  }

  void take_vehicle(const Plan& plan) {
    VehicleSource source = read_vehicle_file(judges_.vehicle, configs_);
    source_ = source.name;
    compared_ = true;
    const std::string own = name();
    source.vehicle->name = own;
    judged_.vehicle = to_value(*source.vehicle);
    for (std::string& one : differences(plan.vehicle, judged_.vehicle, source.name))
      remarks_.push_back("vehicle." + one);
  }

  // Whoever states meshes of their own is told where one seems to be in other units or elsewhere.
  // One that cannot be read fails the check `document`.
  void doubt_meshes() {
    for (const Obstacle& obstacle : judged_.environment.obstacles) {
      const Value* stated = obstacle.type == "mesh" ? obstacle.parameters.find("file") : nullptr;
      const auto found = stated ? elsewhere_.find(stated->as_text()) : elsewhere_.end();
      if (found == elsewhere_.end()) continue;
      const fs::path& file = found->second;
      try {
        const std::string doubt = read_mesh(file).doubt;
        if (!doubt.empty()) remarks_.push_back(file.string() + ": " + doubt);
      } catch (const InputError&) {
      }
    }
  }

  void compare_digest() {
    if (!digest_->stated) {
      faults_.push_back("the document states no digest: changes cannot be detected");
      return;
    }
    if (digest_->changed.empty()) return;
    std::string changed;
    const std::size_t count = digest_->changed.size();
    for (std::size_t i = 0; i < std::min(count, kSectionsListed); ++i)
      changed += (i ? ", " : "") + digest_->changed[i];
    if (count > kSectionsListed)
      changed += " and " + std::to_string(count - kSectionsListed) + " more";
    faults_.push_back("the document was changed after writing: " + changed);
  }

  std::string vehicle_in_words() const {
    const std::string digest = vehicle_digest(judged_.vehicle).substr(0, kShownDigits);
    const std::string how = !judges_.vehicle.empty() ? "judged as " + source_
                            : compared_              ? "compared with " + source_
                                        : "stated by " + source_ + ", compared with no file";
    return (name().empty() ? "" : name() + ", ") + how + ", limits " + digest;
  }
  std::string obstacles() const {
    return in_words(obstacles_in(judged_.environment), "none") + ", margin " +
           plain_number(judged_.environment.margin, 4) + " m";
  }
  std::string task() const {
    return judged_.kind + ": " + in_words(task_in(judged_), "no requirement") +
           (judged_.budget ? ", budget " + plain_number(*judged_.budget, 4) + " s" : "");
  }
  std::string summary() const {
    return vehicle_in_words() + "; " + obstacles() + "; " + task() + "; " +
           tolerances_in_words(tolerances_of(judged_));
  }

  const DigestFindings* digest_;
  const Judges& judges_;
  Plan judged_;
  std::map<std::string, fs::path> elsewhere_;
  fs::path configs_;
  std::string source_;
  bool compared_ = false;  // its numbers were compared with a source's
  std::vector<std::string> faults_, remarks_, not_compared_;
};

[[noreturn]] void refuse_file(const fs::path& file, const std::string& what,
                              const std::string& wanted) {
  throw InputError("'" + file.string() + "' is " + what + "; " + wanted);
}

constexpr const char* kWantedTour = "expected the plan of one tour, such as plan_1.json beside it";
constexpr const char* kWantedPlan = "expected a document such as plan.json in the folder of a run";

// Of what is given in place of a plan, as far as its name tells.
void refuse_other_kinds(const fs::path& file) {
  const std::string ending = file.extension().string();
  std::error_code code;
  if (fs::is_directory(file, code)) {
    const fs::path plan = file / "plan.json";
    if (fs::exists(file / "fleet.json", code))
      refuse_file(file, "the folder of a fleet",
                  "expected the plan of one tour, such as plan_1.json "
                  "in it");
    refuse_file(file, "a folder",
                fs::exists(plan, code) ? "its plan is '" + plan.string() + "'"
                                       : "expected a plan, such as plan.json in the folder of a "
                                         "run");
  }
  if (ending == ".lua")
    refuse_file(
        file, "a script, not a plan",
        "`lapwing run " + file.string() + "` makes one, plan.json in the folder that it names");
  if (ending == ".yaml" || ending == ".yml")
    refuse_file(file, "a configuration, not a plan", kWantedPlan);
}

Value plan_document(const std::string& text, const fs::path& file) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == text.npos) refuse_file(file, "empty", kWantedPlan);
  if (text[begin] != '{') refuse_file(file, "not a plan", kWantedPlan);
  Value document = from_json(text, file.string());
  if (is_fleet(document)) refuse_file(file, "a fleet document", kWantedTour);
  if (!document.find("format") && !document.find("samples"))
    refuse_file(file, "not a plan: JSON without `format` and `samples`", kWantedPlan);
  return document;
}

// Of the plan as it was planned, not of what a judge put into it.
bool judged_by_others(const Judges& judges) {
  return !judges.vehicle.empty() || !judges.environment.empty();
}

}  // namespace

JudgedPlan judge(Plan plan, const fs::path& folder, const DigestFindings* digest,
                 const Judges& judges) {
  const Examination examination(plan, digest, judges);
  JudgedPlan judged;
  judged.plan = examination.plan();
  judged.certificate = verify(judged.plan, {.folder = folder,
                                            .elsewhere = examination.elsewhere(),
                                            .cancellation = judges.cancellation,
                                            .controllers = judges.controllers,
                                            .progress = judges.progress});
  state_provenance(examination.provenance(), judged.certificate);
  judged.provenance = examination.value();
  judged.lines = examination.lines();
  judged.elsewhere = examination.elsewhere();
  if (!judged_by_others(judges))
    judged.changes = changes_since(plan.certificate, judged.certificate);
  judged.provenance.set("changes",
                        Value(Value::List(judged.changes.begin(), judged.changes.end())));
  return judged;
}

Plan read_plan_file(const fs::path& file, DigestFindings* digest) {
  refuse_other_kinds(file);
  const std::string left =
      complete_run_folder(file.has_parent_path() ? file.parent_path() : fs::path("."));
  if (!left.empty()) logging::warning(left);
  const Value document = plan_document(read_file(file), file);
  Plan plan = plan_from_value(document);
  if (digest) *digest = check_digest(document);
  return plan;
}

JudgedPlan judge_file(const fs::path& file, const Judges& judges) {
  DigestFindings digest;
  Plan plan = read_plan_file(file, &digest);
  return judge(std::move(plan), file.parent_path(), &digest, judges);
}

}  // namespace lapwing
