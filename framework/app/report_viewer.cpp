// SPDX-License-Identifier: Apache-2.0
#include "framework/app/report_viewer.h"

#include <charconv>

#include "framework/core/json.h"
#include "framework/export/scan_report.h"
#include "framework/studio/page_assets.h"
#include "framework/studio/plan_message.h"

namespace lapwing {
namespace {

constexpr std::size_t kMostSamples = 1500;
constexpr int kDigits = 7;  // of a page's numbers

// Its first and its last one, and those between evenly.
Plan thinned(const Plan& plan) {
  const std::vector<Sample>& all = plan.trajectory.samples;
  Plan thin = plan;
  if (all.size() <= kMostSamples) return thin;
  thin.trajectory.samples.clear();
  for (std::size_t k = 0; k < kMostSamples; ++k)
    thin.trajectory.samples.push_back(all[k * (all.size() - 1) / (kMostSamples - 1)]);
  return thin;
}

// Numbers as short as a page draws them.
Value shortened(Value value) {
  if (value.type() == Value::Type::number) {
    char text[40];
    const double number = value.as_number();
    const auto end =
        std::to_chars(text, text + sizeof text, number, std::chars_format::general, kDigits);
    double read = number;
    std::from_chars(text, end.ptr, read);
    return read;
  }
  if (value.is_list())
    for (Value& one : value.as_list()) one = shortened(std::move(one));
  if (value.is_map())
    for (auto& [key, one] : value.as_map()) one = shortened(std::move(one));
  return value;
}

// The message `welcome` of PROTOCOL.md, of a mission that nobody edits.
std::string told_of(const MissionResult& result, const Certificate& certificate,
                    const std::string& world) {
  Value mission = Value::map();
  mission.set("name", as_utf8(result.plan.mission));
  mission.set("kind", result.plan.kind);
  mission.set("script", "");
  mission.set("editable", false);
  mission.set("why_not", "a report can be looked at; lapwing studio edits the mission");
  Value head = Value::map();
  head.set("type", "welcome");
  head.set("mission", std::move(mission));
  head.set("document", shortened(result.plan.configuration));
  head.set("revision", std::int64_t{0});
  for (const char* key : {"can_undo", "can_redo"}) head.set(key, false);
  for (const char* key : {"undo_label", "redo_label"}) head.set(key, "");
  for (const char* key : {"schema", "choices"}) head.set(key, Value());
  Value answer = Value::map();
  answer.set("type", "answer");
  answer.set("revision", std::int64_t{0});
  answer.set("edit", Value());
  answer.set("grade", certificate.feasible() ? "certified" : "rejected");
  answer.set("message", "");
  std::string text = to_json(head, -1), told = to_json(answer, -1);
  text.pop_back();
  told.pop_back();
  return text + ",\"world\":" + to_json(shortened(from_json(world, "world")), -1) +
         ",\"answer\":" + told +
         ",\"plan\":" + plan_message(thinned(result.plan), result.report, false) +
         ",\"certificate\":" + certificate_message(certificate) + "}}";
}

}  // namespace

std::optional<Viewer> viewer_of(const MissionResult& result, const Certificate& certificate) {
  const bool shown = result.exploration || (result.scan && result.scan->prediction);
  if (!shown || !PageAssets::has_page()) return std::nullopt;
  const PageAssets assets = PageAssets::built_in();
  const auto text = [&](const char* name) { return *assets.find(name)->bytes; };
  PlannedOn on;
  on.scan = result.scan.get();
  on.exploration = result.exploration.get();
  on.coarse = true;
  DrawnSurfaces drawn;
  WorldMessage world = world_message(result.plan, result.obstacle_folder, on, drawn);
  Viewer viewer{
      text("/"), text("/app.css"), text("/app.js"), told_of(result, certificate, world.text), {}};
  for (auto& [name, bytes] : world.blobs) viewer.blobs.emplace_back(name, std::move(bytes));
  return viewer;
}

}  // namespace lapwing
