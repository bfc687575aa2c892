// SPDX-License-Identifier: Apache-2.0
// Keyframes of every designer's shot are moved in place and time, and weights are changed, in an
// editing session: how long until there is a curve to draw, a converged one, and one that the
// verifier certified.
#include <sys/resource.h>

#include <fstream>
#include <random>

#include "framework/config/shipped.h"
#include "framework/mission/mission_editor.h"
#include "framework/plugin/registry.h"
#include "tests/missions/flown_film.h"

namespace lapwing {
namespace {

constexpr int kEdits = 9;  // of each shot

double user_seconds() {
  rusage usage{};
  ::getrusage(RUSAGE_THREAD, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec) + 1e-6 * usage.ru_utime.tv_usec;
}

const Registry& plugins() {
  static const Registry registry({fs::path(LAPWING_BUILD_DIR) / "lib/plugins"});
  return registry;
}

// A designer's shot that is edited: its file is written anew.
class EditedShot {
 public:
  // Without `camera`, nothing is looked at.
  EditedShot(int number, bool camera, fs::path folder) : file_(std::move(folder) / "edited.json") {
    char name[32];
    std::snprintf(name, sizeof name, "shot_%02d.json", number);
    shot_ = from_json(read_file(fs::path(data_folder()) / "shots" / name), name);
    if (!camera) {
      Value list = Value::list();
      for (const Value& keyframe : shot_.at("keyFrameList").as_list()) {
        Value blind = Value::map();
        for (const auto& [key, value] : keyframe.as_map())
          if (key != "lookAt" && key != "lookAtNED") blind.set(key, value);
        list.push_back(std::move(blind));
      }
      shot_.set("keyFrameList", std::move(list));
    }
    write(shot_);
  }

  bool local() const { return shot_.at("keyFrameList").as_list()[0].find("lookFromNED"); }
  int keyframes() const { return static_cast<int>(shot_.at("keyFrameList").as_list().size()); }
  std::string input() const { return "input=" + file_.string(); }

  // Keyframe k is moved from where it is in the designer's file, m (north, east, down) and s.
  void move(int k, const Eigen::Vector3d& by, double later) const {
    Value shot = shot_, list = Value::list(), times = Value::list();
    for (int i = 0; i < keyframes(); ++i) {
      Value keyframe = shot_.at("keyFrameList").as_list()[i];
      if (i == k) {
        Value place = keyframe.at("lookFromNED");
        const char* axes[] = {"n", "e", "d"};
        for (int a = 0; a < 3; ++a) place.set(axes[a], place.at(axes[a]).as_number() + by(a));
        keyframe.set("lookFromNED", std::move(place));
      }
      list.push_back(std::move(keyframe));
      times.push_back(shot_.at("keyframeTimes").as_list()[i].as_number() + (i == k ? later : 0.0));
    }
    shot.set("keyFrameList", std::move(list));
    shot.set("keyframeTimes", std::move(times));
    write(shot);
  }

 private:
  void write(const Value& shot) const { std::ofstream(file_) << to_json(shot); }
  fs::path file_;
  Value shot_;
};

double quantile(std::vector<double> list, double share) {
  if (list.empty()) return 0;
  std::sort(list.begin(), list.end());
  return list[std::min(list.size() - 1, static_cast<std::size_t>(share * list.size()))];
}

class EditedShots : public DesignersShots {
 protected:
  struct Times {
    std::vector<double> stated, drawn, converged, certified;
    int edits = 0, rejected = 0;
    void append(const Times& other) {
      const auto add = [](std::vector<double>& to, const std::vector<double>& from) {
        to.insert(to.end(), from.begin(), from.end());
      };
      add(stated, other.stated);
      add(drawn, other.drawn);
      add(converged, other.converged);
      add(certified, other.certified);
      edits += other.edits;
      rejected += other.rejected;
    }
  };

  void edit_all(bool camera, double asked_median, double asked_most) {
    Times all;
    std::printf("shot stages  state  drawn  conv.  cert. ms after the edit (user, medians)\n");
    for (int number = 1; number <= 32; ++number) all.append(edit_shot(number, camera));
    std::printf("%s: %d edits of 32 shots, user time of one thread after the edit, ms\n",
                camera ? "with every camera term" : "the flight alone", all.edits);
    const auto line = [](const char* what, const std::vector<double>& list, const char* asked) {
      std::printf("  %-22s median %6.1f  95 %% %6.1f   asked: %s\n", what,
                  1e3 * quantile(list, 0.5), 1e3 * quantile(list, 0.95), asked);
    };
    char asked[64];
    std::snprintf(asked, sizeof asked, "%g and %g", asked_median, asked_most);
    line("stated", all.stated, "-");
    line("first curve to draw", all.drawn, "15");
    line("converged", all.converged, "-");
    line("certified", all.certified, asked);
    std::printf("  %d of %d edits were answered without a certificate\n", all.rejected, all.edits);
    EXPECT_LT(all.rejected, 0.1 * all.edits);
  }

  MissionSettings settings() const {
    MissionSettings settings;
    settings.scripts = shipped_folder("scripts");
    settings.configs = shipped_folder("configs");
    settings.registry = &plugins();
    settings.data = {folder_};
    return settings;
  }

  // The stretch at which the shot is certified, as an override; and its plan.
  std::string stretch_of(const EditedShot& shot, std::shared_ptr<const Plan>& plan) const {
    Mission mission(kExamples / "own_shot.lua", settings());
    const std::string overrides[] = {shot.input()};
    mission.configure({}, overrides);
    const MissionResult result = mission.plan();
    plan = std::make_shared<const Plan>(result.plan);
    char text[48];
    std::snprintf(text, sizeof text, "stretch=%.17g", result.block.at("stretch").as_number());
    return text;
  }

  Times edit_shot(int number, bool camera) {
    SCOPED_TRACE(number);
    const EditedShot shot(number, camera, folder_);
    if (!shot.local()) return {};
    MissionSettings with_start = settings();
    std::shared_ptr<const Plan> plan;
    const std::string stretch = stretch_of(shot, plan);
    with_start.start = plan;
    double begin = 0, stated = 0, drawn = 0, converged = 0, certified = 0;
    int stages = 0;
    with_start.observe_problem = [&](const std::shared_ptr<const TrajectoryProblem>& problem) {
      stated = user_seconds() - begin;
      stages = problem->horizon().stages;
    };
    std::string said;
    MissionEditor editor(kExamples / "own_shot.lua", with_start, [&](const EditedPlan& edited) {
      const double spent = user_seconds() - begin;
      const AnswerGrade grade = edited.answer.grade;
      if (grade == AnswerGrade::refused) ADD_FAILURE() << edited.answer.message;
      if (drawn == 0) drawn = spent;
      if (grade == AnswerGrade::converged) converged = spent;
      if (grade == AnswerGrade::certified) certified = spent;
      if (grade == AnswerGrade::rejected) said = edited.answer.message;
    });
    const auto edit = [&](std::vector<std::string> more) {
      drawn = converged = certified = 0;
      more.insert(more.end(), {shot.input(), stretch});
      editor.edit({{}, std::move(more)});
      begin = user_seconds();
      editor.work();
    };
    edit({});
    std::mt19937 random(number);
    const auto uniform = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    Times mine;
    for (int k = 0; k < kEdits; ++k) {
      const int keyframe = std::uniform_int_distribution<int>(0, shot.keyframes() - 1)(random);
      const bool inner = keyframe > 0 && keyframe + 1 < shot.keyframes();
      const Eigen::Vector3d by(uniform(-0.5, 0.5), uniform(-0.5, 0.5), uniform(-0.3, 0.3));
      shot.move(keyframe, by, inner && k % 3 == 1 ? uniform(-0.2, 0.2) : 0.0);
      std::vector<std::string> more;
      if (k % 3 == 2)
        more.push_back("weights.smoothness=" + std::to_string(1e-3 * std::exp(uniform(-1, 1))));
      edit(std::move(more));
      ++mine.edits;
      mine.stated.push_back(stated);
      mine.drawn.push_back(drawn);
      mine.converged.push_back(converged);
      if (certified > 0)
        mine.certified.push_back(certified);
      else
        ++mine.rejected;
    }
    std::printf("  %02d %6d %6.1f %6.1f %6.1f %6.1f  %s\n", number, stages,
                1e3 * quantile(mine.stated, 0.5), 1e3 * quantile(mine.drawn, 0.5),
                1e3 * quantile(mine.converged, 0.5), 1e3 * quantile(mine.certified, 0.5),
                mine.rejected ? said.c_str() : "");
    std::fflush(stdout);
    return mine;
  }
};

TEST_F(EditedShots, FlightAlone) {
  edit_all(false, 50, 150);
}
TEST_F(EditedShots, EveryCameraTerm) {
  edit_all(true, 100, 400);
}

}  // namespace
}  // namespace lapwing
