// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/worker_errands.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>

#include "framework/config/read_note.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/png.h"
#include "framework/export/episode_file.h"
#include "framework/export/exporter.h"
#include "framework/export/film_strip.h"
#include "framework/export/flight_judgement.h"
#include "framework/export/light_painting.h"
#include "framework/export/run_folder.h"
#include "framework/mission/controller_source.h"
#include "framework/mission/environment_source.h"
#include "framework/studio/episode_answers.h"
#include "framework/studio/file_look.h"
#include "framework/studio/plan_message.h"
#include "framework/trajectory/fleet.h"
#include "framework/vehicle/monte_carlo.h"
#include "framework/verify/certificate.h"
#include "framework/verify/tolerances.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

const fs::path kRuns = "out";  // where runs and this studio write

Frame done() {
  Frame frame;
  frame.header.set("said", "done");
  return frame;
}

Plan plan_in(const Frame& asked) {
  if (asked.parts.empty()) throw InputError("there is no plan yet");
  return plan_from_value(from_json(asked.parts.front(), "plan"));
}

// The motion alone.
std::string trajectory_text(const Plan& plan) {
  const Value value = to_value(plan);
  return to_json(value.at("motion"), -1) + to_json(value.at("samples"), -1);
}

// Reads to the end, and waits for the process.
std::string read_to_end(int descriptor) {
  std::string text;
  char bytes[4096];
  for (;;) {
    const ssize_t count = ::read(descriptor, bytes, sizeof bytes);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return text;
    text.append(bytes, static_cast<std::size_t>(count));
  }
}

// What this program says on standard output for these words, which begin with its name.
std::string answer_of_program(const Value::List& given) {
  std::vector<std::string> words;
  for (const Value& word : given) words.push_back(word.as_text());
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) < 0) throw Error("no pipe to a run");
  const pid_t child = ::fork();
  if (child == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::dup2(ends[1], STDOUT_FILENO) < 0) ::_exit(3);
    ::execv("/proc/self/exe", arguments.data());
    ::_exit(3);
  }
  ::close(ends[1]);
  std::string text = child > 0 ? read_to_end(ends[0]) : "";
  ::close(ends[0]);
  if (child < 0) throw Error("no process for a run");
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (text.empty()) throw Error("the run ended without an answer");
  return text;
}

// Of the flight alone.
bool kept(const FlownPath& flown) {
  return !flown.lost && flown.finished && flown.position_error_worst <= tolerances::kTracking;
}

// Where each flight was, ten times a second, and how far they were from the plan.
void tell_runs(const std::vector<SeededRun>& flights, Frame& frame) {
  constexpr double kBetween = 0.1;  // s
  std::vector<double> errors;
  std::int64_t lost = 0, good = 0;
  std::string ways = "[";
  for (const SeededRun& run : flights) {
    errors.push_back(run.path.position_error_worst);
    lost += run.path.lost;
    good += kept(run.path);
    ways += ways.size() > 1 ? ",[" : "[";
    double next = 0;
    bool first = true;
    for (const FlownSample& sample : run.path.samples) {
      const Eigen::Vector3d& p = sample.state.position;
      if (sample.time < next - 1e-9 || !p.allFinite()) continue;
      next = sample.time + kBetween;
      char text[80];
      std::snprintf(text, sizeof text, "%s%.3f,%.3f,%.3f", first ? "" : ",", p.x(), p.y(), p.z());
      ways += text;
      first = false;
    }
    ways += "]";
  }
  frame.parts.push_back(ways + "]");
  Value& told = frame.header.set("runs", Value::map());
  told.set("count", static_cast<std::int64_t>(flights.size()));
  told.set("lost", lost);
  told.set("kept", good);
  told.set("median", quantile_of(errors, 0.5));
  told.set("most", quantile_of(errors, 1));
}

}  // namespace

int line_in(const std::string& message, const fs::path& script) {
  const std::string start = script.string() + ":";
  if (!message.starts_with(start)) return 0;
  int line = 0;
  std::from_chars(message.data() + start.size(), message.data() + message.size(), line);
  return line;
}

bool is_own_module(const fs::path& file, const fs::path& scripts) {
  const fs::path shipped = fs::weakly_canonical(scripts), whole = fs::weakly_canonical(file);
  return std::mismatch(shipped.begin(), shipped.end(), whole.begin(), whole.end()).first !=
         shipped.end();
}

Value layer_of_page(Value layer, const fs::path& script) {
  if (Value* input = layer.find("input")) input->with_origin({script.string(), 0});
  if (layer.is_map())  // nor does it change the limits of scripts
    std::erase_if(layer.as_map(), [](const auto& entry) { return entry.first == "sandbox"; });
  return layer;
}

std::unique_ptr<Mission> configured_mission(const fs::path& script, MissionSettings settings,
                                            const Value& layer) {
  const std::vector<Value> layers{layer_of_page(layer, script)};
  settings.limits = sandbox_limits(layers, {});
  auto mission = std::make_unique<Mission>(script, std::move(settings));
  mission->configure(layers, {});
  return mission;
}

Frame WorkerErrands::answer(const Frame& asked) {
  const std::string& what = asked.header.at("do").as_text();
  if (what == "check") return check(asked);
  if (what == "describe") return describe();
  if (what == "fly") return fly(asked);
  if (what == "picture") return picture(asked);
  if (what == "export") return export_plan(asked);
  if (what == "export_lua") return export_lua(asked);
  if (what == "save_report") return save_report(asked);
  if (what == "list_runs") return list_runs();
  if (what == "open_run") return open_run(asked);
  if (what == "backdrop") return backdrop(asked);
  if (asked.header.find("run")) return look_into_run(asked);
  if (what == "race") return games_.begin(asked, plan_in(asked));
  if (what == "stick") return games_.stick(asked);
  throw Error("a working process does not know '" + what + "'");
}

Value WorkerErrands::script_files() const {
  return Value(Value::List(files_.begin(), files_.end()));
}

Frame WorkerErrands::check(const Frame& asked) {
  files_.clear();
  MissionSettings settings = settings_;
  settings.observe_script = [&](const fs::path& file) {
    if (file != script_ && is_own_module(file, settings_.scripts))
      files_.insert(fs::weakly_canonical(file).string());
  };
  const std::unique_ptr<Mission> mission =
      configured_mission(script_, settings, asked.header.at("layer"));
  if (asked.header.at("judge").as_boolean()) mission->judge();
  Frame frame;
  frame.header.set("said", "checked");
  frame.header.set("document", options_with_file(*mission));
  frame.header.set("files", script_files());
  Value& about = frame.header.set("mission", Value::map());
  about.set("name", mission->name());
  about.set("kind", mission->kind());
  return frame;
}

Frame WorkerErrands::describe() const {
  Frame frame;
  frame.header.set("said", "described");
  describe_mission(*configured_mission(script_, settings_, Value::map()), settings_, frame.header);
  return frame;
}

Frame WorkerErrands::fly(const Frame& asked) const {
  const Plan plan = plan_in(asked);
  const Vehicle vehicle = vehicle_from_value(plan.vehicle);
  if (!plan.trajectory.motion.moves)
    throw InputError("the plan is a path without forces: lapwing simulate flies it");
  FlightConditions conditions;
  conditions.disturbances = vehicle.disturbances;
  conditions.wind_mean = asked.header.at("wind_mean").as_number();
  conditions.wind_yaw = asked.header.at("wind_yaw").as_number();
  conditions.wind_gust = asked.header.at("wind_gust").as_number();
  conditions.seed = static_cast<std::uint64_t>(asked.header.at("seed").as_integer());
  conditions.mass_error = asked.header.at("mass").as_number();
  const auto runs = static_cast<int>(asked.header.at("runs").as_integer());
  const auto controlled = plan_as_named(plan.trajectory, vehicle, *settings_.registry);
  std::vector<SeededRun> flights;
  if (runs > 1) flights = fly_runs(*controlled, conditions, runs, settings_.threads);
  conditions.mass_error = 0;
  const FlownPath flown = runs > 1 ? flights.front().path : controlled->fly(conditions);
  Frame frame = done();
  frame.header.set("lost", flown.lost);
  frame.header.set("finished", flown.finished);
  frame.header.set("kept", kept(flown));
  Value& worst = frame.header.set("worst", Value::map());
  worst.set("position_error", flown.position_error_worst);
  worst.set("time", flown.position_error_at);
  worst.set("limit", tolerances::kTracking);
  worst.set("mean", flown.position_error_mean);
  worst.set("rotor_speed", flown.rotor_speed_worst);
  frame.parts.push_back(flown_message(flown, plan.trajectory));
  if (runs > 1) tell_runs(flights, frame);
  return frame;
}

Plan WorkerErrands::with_shapes(const Frame& asked) {
  Plan plan = plan_in(asked);
  const Value& layer = asked.header.at("layer");
  const std::string& folder = asked.header.at("folder").as_text();
  const std::string stated = to_json(layer, -1) + folder + read_file(script_);
  if (stated != stated_layer_ || looks_of(stated_reads_) != stated_looks_) {
    stated_layer_.clear();
    stated_mission_.reset();
    stated_reads_.clear();
    const ReadListener listener([this](const fs::path& file) { stated_reads_.insert(file); });
    state_environment(plan, layer, folder);
    stated_layer_ = stated;
    stated_looks_ = looks_of(stated_reads_);
  }
  plan.environment = stated_environment_;
  return plan;
}

// As the script states it; of a mission of several problems what the plan records, with the files
// of the folder that planning left, or those that the script named before planning began.
void WorkerErrands::state_environment(const Plan& plan, const Value& layer,
                                      const fs::path& planned) {
  if (!planned.empty()) {
    stated_environment_ = plan.environment;
    open_recorded_shapes(stated_environment_, *settings_.registry, planned);
    stated_folder_ = planned;
    return;
  }
  auto mission = configured_mission(script_, settings_, layer);
  try {
    MissionStatement statement = mission->state();
    stated_environment_ = std::move(statement.plan.environment);
  } catch (const InputError&) {
    mission = configured_mission(script_, settings_, layer);
    mission->judge();
    stated_environment_ = plan.environment;
    const fs::path& folder = mission->obstacle_folder();
    open_recorded_shapes(stated_environment_, *settings_.registry,
                         folder.empty() ? fs::path(".") : folder);
  }
  stated_folder_ = mission->obstacle_folder();
  stated_mission_ = std::move(mission);
}

// As the drawing comes out, its shutter open up to a time: at the beginning, for all of it.
std::string WorkerErrands::exposure(const Plan& plan, double time, int width, int height) {
  const std::string stated = trajectory_text(plan);
  if (stated != drawn_trajectory_) {
    const Vehicle vehicle = vehicle_from_value(plan.vehicle);
    drawn_ = plan_as_named(plan.trajectory, vehicle, *settings_.registry)->fly({});
    drawn_trajectory_ = stated;
  }
  FlownPath until = drawn_;
  if (time > plan.trajectory.samples.front().time)
    std::erase_if(until.samples, [&](const FlownSample& s) { return s.time > time; });
  Picture picture = long_exposure(plan, until, width);
  if (picture.height > height)
    picture = long_exposure(plan, until, std::max(1, width * height / picture.height));
  return encode_png(picture);
}

Frame WorkerErrands::picture(const Frame& asked) {
  if (const Plan drawing = plan_in(asked); !drawing.task.strokes.empty()) {
    Frame frame = done();
    frame.parts.push_back(exposure(drawing, asked.header.at("time").as_number(),
                                   static_cast<int>(asked.header.at("width").as_integer()),
                                   static_cast<int>(asked.header.at("height").as_integer())));
    return frame;
  }
  const Plan plan = with_shapes(asked);
  Frame frame = done();
  frame.parts.push_back(film_frame(plan, vehicle_from_value(plan.vehicle),
                                   asked.header.at("time").as_number(),
                                   static_cast<int>(asked.header.at("width").as_integer()),
                                   static_cast<int>(asked.header.at("height").as_integer())));
  return frame;
}

Frame WorkerErrands::export_plan(const Frame& asked) {
  const std::string& format = asked.header.at("format").as_text();
  const auto exporter =
      settings_.registry->create<Exporter>(format, asked.header.at("parameters"), "parameters");
  Plan plan = plan_in(asked);
  if (!asked.header.at("uncertified").as_boolean()) {
    std::string failures;
    if (plan.certificate.is_null())
      failures = "it has not been judged yet";
    else
      for (const Check& check : Certificate::from_value(plan.certificate).failures())
        failures += (failures.empty() ? "" : "; ") + to_line(check);
    if (!failures.empty()) throw InputError("the plan is not certified: " + failures);
  }
  const Value certificate = plan.certificate;
  const bool surroundings = exporter->shows_surroundings();
  if (surroundings) plan = with_shapes(asked);
  plan.certificate = certificate;
  const std::string extension = exporter->file_extension();
  std::string name = run_folder_name(plan.mission);
  if (const Value* number = asked.header.find("number"))  // of a tour, as plan_2.json
    name += "_" + std::to_string(number->as_integer());
  // Whole: whoever reads the answer is in no folder.
  const fs::path target =
      fs::absolute(run_folder(plan.mission) /
                   (name + (extension == "." + format ? "" : "." + format) + extension));
  Frame frame = done();
  Value files = Value::list(), losses = Value::list();
  if (extension.empty()) {
    const NamedContents contents = exporter->write_folder(plan);
    write_folder_atomically(target, contents);
    for (const auto& [file, bytes] : contents) files.push_back((target / file).string());
  } else {
    const std::string bytes = exporter->write(plan);
    for (const std::string& loss : exporter->losses(plan, bytes)) losses.push_back(as_utf8(loss));
    const fs::path folder =
        surroundings && !stated_folder_.empty() ? stated_folder_ : fs::path(".");
    for (const std::string& sentence :
         judge_written_flight(*exporter, plan, bytes, folder, "export " + format))
      losses.push_back(as_utf8(sentence));
    write_file_atomically(target, bytes);
    files.push_back(target.string());
  }
  for (const std::string& remark : exporter->remarks(plan)) losses.push_back(as_utf8(remark));
  frame.header.set("files", std::move(files));
  frame.header.set("loss", std::move(losses));
  return frame;
}

Frame WorkerErrands::export_lua(const Frame& asked) const {
  const std::unique_ptr<Mission> mission =
      configured_mission(script_, settings_, asked.header.at("layer"));
  const fs::path target = fs::absolute(asked.header.at("target").as_text());
  write_flat_script(script_, settings_, *mission, target);
  Frame frame = done();
  frame.header.set("files", Value(Value::List{target.string()}));
  frame.header.set("loss", Value::list());
  return frame;
}

Frame WorkerErrands::save_report(const Frame& asked) const {
  const Value answer =
      from_json(answer_of_program(asked.header.at("words").as_list()), "the run's answer");
  if (const Value* error = answer.find("error")) throw InputError(error->as_text());
  Frame frame = done();
  const Value* fleet = answer.find("fleet");
  const fs::path folder =
      fs::absolute((fleet ? *fleet : answer.at("plan")).as_text()).parent_path();
  Value files = Value::list(), loss = Value::list();
  bool another = false;
  for (std::size_t t = 0; t < asked.parts.size(); ++t) {
    const fs::path saved = folder / (fleet ? fleet_plan_name(t) : "plan.json");
    another = another || !fs::exists(saved) ||
              trajectory_text(plan_from_value(from_json(asked.parts[t], "plan"))) !=
                  trajectory_text(read_plan(saved));
  }
  // Both were planned by the same script from the beginning.
  if (another)
    loss.push_back(
        "the flight that was saved is another than the one on display: the script or a file that "
        "it reads has changed; reload the studio");
  std::vector<std::string> names{"report.html", "plan.json",    "trajectory.csv",
                                 "fleet.json",  "episode.json", "run.log"};
  for (std::size_t t = 0; fleet && t < answer.at("tours").as_list().size(); ++t) {
    const std::string number = std::to_string(t + 1);
    names.push_back(fleet_plan_name(t));
    names.push_back("report_" + number + ".html");
    names.push_back("trajectory_" + number + ".csv");
  }
  for (const std::string& name : names)
    if (fs::exists(folder / name)) files.push_back((folder / name).string());
  frame.header.set("files", std::move(files));
  frame.header.set("loss", std::move(loss));
  frame.header.set("status", answer.at("status"));
  return frame;
}

// Folders of explorations, by name.
Frame WorkerErrands::list_runs() const {
  std::vector<std::string> names;
  std::error_code code;
  for (fs::directory_iterator item(kRuns, code); !code && item != fs::directory_iterator();
       item.increment(code)) {
    std::error_code ignored;
    if (fs::is_regular_file(item->path() / "episode.json", ignored))
      names.push_back(as_utf8(item->path().filename().string()));
  }
  std::sort(names.begin(), names.end());
  Frame frame = done();
  frame.header.set("folders", Value(Value::List(names.begin(), names.end())));
  return frame;
}

// As the run judged it.
Frame WorkerErrands::open_run(const Frame& asked) const {
  const fs::path folder = kRuns / fs::path(asked.header.at("run").as_text());
  if (const std::string why = complete_run_folder(folder); !why.empty()) throw InputError(why);
  ShownEpisode shown = read_episode(folder, program_);
  Frame frame = done();
  frame.header.set("folder", folder.string());
  frame.header.set("exploration", std::move(shown.exploration));
  frame.parts = {plan_message(shown.plan, SolveReport{}, false),
                 shown.plan.certificate.is_null()
                     ? "null"
                     : certificate_message(Certificate::from_value(shown.plan.certificate)),
                 std::move(shown.growth), std::move(shown.sights)};
  return frame;
}

// As long as the run is the same its images are taken again once.
Frame WorkerErrands::look_into_run(const Frame& asked) {
  const fs::path folder = kRuns / fs::path(asked.header.at("run").as_text());
  std::string looks = folder.string() + "\n" + look_of(folder / "episode.json") + "\n" +
                      look_of(folder / "plan.json") + "\n" + look_of(script_);
  if (looks != looked_into_looks_) {
    looked_into_.reset();
    looked_into_looks_.clear();
    looked_into_error_ = complete_run_folder(folder);
    if (!looked_into_error_.empty()) throw InputError(looked_into_error_);
    try {
      looked_into_ = replay_of_run(folder, script_, settings_, program_);
    } catch (const InputError& error) {
      looked_into_error_ = error.what();
    }
    looked_into_looks_ = std::move(looks);
  }
  if (!looked_into_) throw InputError(looked_into_error_);
  return episode_answer(asked, *looked_into_);
}

// Without parts where what was shown last still holds.
Frame WorkerErrands::backdrop(const Frame& asked) {
  Frame frame = done();
  if (const auto shown = backdrop_.shown_for(asked.header.at("file").as_text(), plan_in(asked)))
    frame.parts = {shown->members, shown->picture};
  return frame;
}

}  // namespace lapwing
