// SPDX-License-Identifier: Apache-2.0
// Examples and exit statuses of every command, as its help and the manual show them.
#include <CLI/CLI.hpp>
#include <stdexcept>
#include <vector>

#include "framework/app/command_reference.h"

namespace lapwing {

namespace {

constexpr const char* kOfPlans =
    "0 done and certified; 1 finished, but infeasible or not certified; 2 bad input; 3 internal "
    "error; 130 interrupted";
constexpr const char* kOfFiles = "0 done; 2 bad input; 3 internal error";
constexpr const char* kOfStudies =
    "0 done; 2 bad input; 3 internal error; 130 interrupted: --resume continues";

struct CommandExamples {
  const char* path;
  std::vector<const char*> lines;
  const char* statuses;
  const char* more = "";  // a paragraph of its own
};

const std::vector<CommandExamples>& command_examples() {
  static const std::vector<CommandExamples> all{
      {"lapwing",
       {"lapwing new mission film shot.lua", "lapwing run shot.lua", "lapwing help sweep"},
       kOfPlans},
      {"lapwing run",
       {"lapwing run shot.lua",
        "lapwing run shot.lua --config solvers/ipopt --set weights.smoothness=0.01 -o out/smooth",
        "lapwing run shot.lua --from out/shot/plan.json --set keyframes[2].time=6"},
       kOfPlans},
      {"lapwing config", {"lapwing config shot.lua --set vehicle=vehicles/solo"}, kOfFiles},
      {"lapwing sweep",
       {"lapwing sweep shot.lua --vary weights.smoothness=0.1,1,10 --vary step=0.1,0.2 --jobs 4",
        "lapwing sweep shot.lua --vary \"start_velocity=[0, 0, 0],[1, 0, 0]\" -o out/starts",
        "lapwing sweep shot.lua --vary weights.smoothness=0.1,1,10 --resume",
        "mpirun -n 4 lapwing sweep shot.lua --vary weights.smoothness=0.1,1,10"},
       "the worst of the runs: 0 all certified; 1 one is infeasible or not certified; 2 bad input; "
       "3 internal error; 130 interrupted: --resume continues"},
      {"lapwing studio",
       {"lapwing studio examples/filming/castle_flyover.lua",
        "lapwing studio shot.lua --port 8123 --no-open"},
       "0 done; 2 bad input; 3 internal error; 130 ended twice by Ctrl-C"},
      {"lapwing diff",
       {"lapwing diff out/a out/b", "lapwing diff out/a/plan.json out/b/plan.json -o diff.html"},
       "0 the plans are the same; 1 they differ; 2 bad input; 3 internal error"},
      {"lapwing verify",
       {"lapwing verify out/shot/plan.json", "lapwing verify out/two_drones"},
       "0 certified; 1 not certified; 2 bad input; 3 internal error"},
      {"lapwing simulate",
       {"lapwing simulate out/shot/plan.json --wind 5,1 --mass-error 10 -o flight.html",
        "lapwing simulate out/race/plan.json --controller tvlqr --runs 100 --mass-error 5"},
       "0 done; 1 the vehicle, or one of the runs, is lost, fails the task of the plan, or is "
       "farther from the plan than the tolerance; 2 bad input; 3 internal error"},
      {"lapwing export",
       {"lapwing export out/shot/plan.json --format csv -o shot.csv"},
       "0 done; 1 not certified, and nothing written; 2 bad input; 3 internal error"},
      {"lapwing compare",
       {"lapwing compare out/shot/plan.json flight.ulg -o flight.html",
        "lapwing compare out/shot/plan.json record.csv --origin 46.5191,6.5668,0,ground"},
       "0 flown as planned; 1 the flight broke a limit that the plan keeps, or is another flight; "
       "2 "
       "bad input; 3 internal error"},
      {"lapwing log", {"lapwing log info flight.ulg"}, kOfFiles},
      {"lapwing log info", {"lapwing log info flight.ulg --json"}, kOfFiles},
      {"lapwing vehicle", {"lapwing vehicle from flight.ulg -o mine.yaml"}, kOfFiles},
      {"lapwing vehicle from",
       {"lapwing vehicle from flight.ulg --base vehicles/phantom -o mine.yaml"},
       kOfFiles},
      {"lapwing fly",
       {"lapwing fly out/shot/plan.json --to udp:127.0.0.1:14540",
        "lapwing fly out/shot/plan.json --to serial:/dev/ttyACM0:115200 --mode -o flights/take_1",
        "lapwing fly out/shot/plan.json --to udpin:0.0.0.0:14550 --yes-a-real-vehicle"},
       "0 flown within the tolerance; 1 not certified and not flown, strayed, aborted, taken over "
       "by the pilot, or link lost; 2 bad input, or the vehicle is not ready; 3 internal error; "
       "130 aborted by Ctrl-C",
       "Keys during the flight: space pauses, r resumes, a or q aborts (brakes along the path and "
       "holds). Without a terminal, --press presses them."},
      {"lapwing autopilot",
       {"lapwing autopilot out/shot/plan.json --pilot fly",
        "lapwing autopilot out/shot/plan.json --pilot fly --fault lost=0.2 --fault gap=5@4 --once"},
       "0 no setpoint was beyond the limits; 1 one was; 2 bad input; 3 internal error"},
      {"lapwing race",
       {"lapwing race out/race/plan.json --pilot ann.csv:name=Ann,strength=0.5 -o race.html"},
       kOfFiles},
      {"lapwing tour",
       {"lapwing tour kroA150-gen1-50.oplib",
        "lapwing tour *.oplib --solver local_search --solver milp --guard 60 --json",
        "lapwing tour set_64_1_60.txt --team 3 --solver greedy --solver local_search"},
       "0 every solver found a tour; 1 one found none; 2 bad input; 3 internal error; 130 "
       "interrupted"},
      {"lapwing map", {"lapwing map info out/street/map.ot"}, kOfFiles},
      {"lapwing map info", {"lapwing map info out/street/map.ot"}, kOfFiles},
      {"lapwing map convert", {"lapwing map convert out/street/map.ot -o street.bt"}, kOfFiles},
      {"lapwing map view", {"lapwing map view out/street/map.ot -o street.html"}, kOfFiles},
      {"lapwing scene", {"lapwing scene view street -o street.html"}, kOfFiles},
      {"lapwing scene view",
       {"lapwing scene view street --seed 3 -o street.html",
        "lapwing scene view church.obj --unit 0.01 --up y -o church.html"},
       kOfFiles},
      {"lapwing plugins", {"lapwing plugins list", "lapwing plugins show iqp"}, kOfFiles},
      {"lapwing plugins list", {"lapwing plugins list"}, kOfFiles},
      {"lapwing plugins show", {"lapwing plugins show cost_term/keyframe"}, kOfFiles},
      {"lapwing plugins path", {"lapwing --plugin-path build/lib plugins path"}, kOfFiles},
      {"lapwing plugins check",
       {"lapwing plugins check cost_term/keyframe",
        "lapwing plugins check build/lib/plugins/cost_terms/keep_low.so --only derivatives"},
       "0 no test failed; 1 a test failed or crashed; 2 bad input; 3 internal error"},
      {"lapwing annotations", {"lapwing annotations -o lapwing_annotations.lua"}, kOfFiles},
      {"lapwing schema", {"lapwing schema film -o film.schema.json"}, kOfFiles},
      {"lapwing new", {"lapwing new mission film shot.lua"}, kOfFiles},
      {"lapwing new plugin", {"lapwing new plugin cost_term keep_low --in plugins"}, kOfFiles},
      {"lapwing new mission", {"lapwing new mission film shot.lua"}, kOfFiles},
      {"lapwing train", {"lapwing help train dataset"}, kOfStudies},
      {"lapwing train dataset",
       {"lapwing train dataset --world suburb:1-4 --episodes 2 -o samples"},
       kOfStudies},
      {"lapwing train all", {"lapwing train all -o my.model --hours 1"}, kOfStudies},
      {"lapwing train fit",
       {"lapwing train fit samples --validation samples_of_others -o my.model"},
       kOfStudies},
      {"lapwing train score", {"lapwing train score samples --model my.model"}, kOfStudies},
      {"lapwing scan", {"lapwing help scan check"}, kOfFiles},
      {"lapwing scan check",
       {"lapwing scan check photos --plan out/church/plan.json -o rest.lua",
        "lapwing scan check sparse/0 --plan out/church/plan.json --photos photos --json"},
       "0 every view is photographed; 1 some are missing; 2 bad input; 3 internal error"},
      {"lapwing evaluate", {"lapwing help evaluate scan"}, kOfStudies},
      {"lapwing evaluate scan",
       {"lapwing evaluate scan church.lua --method milp --method greedy --seeds 1,2"},
       kOfStudies},
      {"lapwing evaluate explore",
       {"lapwing evaluate explore --world suburb --utility proximity_count --episodes 3"},
       kOfStudies},
      {"lapwing reproduce",
       {"lapwing reproduce list", "lapwing reproduce 4.3 --quick"},
       kOfStudies},
      {"lapwing version", {"lapwing version"}, "0 done"},
      {"lapwing help", {"lapwing help run", "lapwing help map convert"}, kOfFiles},
      {"lapwing completion",
       {"source <(lapwing completion bash)",
        "lapwing completion fish > ~/.config/fish/completions/lapwing.fish"},
       kOfFiles},
      {"lapwing man", {"lapwing man > lapwing.1"}, kOfFiles},
  };
  return all;
}

std::string footer_of(const std::string& path) {
  for (const CommandExamples& one : command_examples()) {
    if (one.path != path) continue;
    std::string text = one.lines.size() == 1 ? "Example:" : "Examples:";
    for (const char* line : one.lines) text += std::string("\n  ") + line;
    if (*one.more) text += std::string("\n\n") + one.more;
    return text + "\n\nExit status: " + one.statuses + ".";
  }
  throw std::logic_error("no example for '" + path + "'");
}

void add_footers_below(CLI::App& app, const std::string& path) {
  app.footer(footer_of(path));
  for (CLI::App* command :
       app.get_subcommands([](const CLI::App* below) { return !below->get_group().empty(); }))
    add_footers_below(*command, path + " " + command->get_name());
}

}  // namespace

void add_footers(CLI::App& app) {
  add_footers_below(app, "lapwing");
}

}  // namespace lapwing
