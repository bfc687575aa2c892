// SPDX-License-Identifier: Apache-2.0
// Whether the environment holds together: shapes that exist, tracks without gaps.
#include <set>

#include "framework/verify/checks.h"

namespace lapwing {
namespace {

std::string problem_of(const Subject& subject) {
  if (subject.times.empty()) return " must have at least one time";
  if (subject.times.size() != subject.positions.size()) {
    return " has " + std::to_string(subject.times.size()) + " times and " +
           std::to_string(subject.positions.size()) + " positions";
  }
  for (std::size_t i = 0; i < subject.times.size(); ++i) {
    if (!sound(subject.times[i]) || !sound(subject.positions[i])) {
      return " holds a number that is not finite or beyond 1e7";
    }
    if (i > 0 && !(subject.times[i] > subject.times[i - 1])) {
      return " has times that do not increase";
    }
  }
  if (!(subject.height >= 0 && subject.width >= 0) || !sound(subject.height) ||
      !sound(subject.width)) {
    return " must have a height and a width of at least 0";
  }
  if (!(subject.distance >= 0) || !sound(subject.distance)) {
    return " must have a distance of at least 0";
  }
  return "";
}

}  // namespace

void list_problems(const Environment& environment, std::vector<std::string>& problems) {
  if (!(environment.margin >= 0) || !sound(environment.margin)) {
    problems.push_back("the margin must be at least 0");
  }
  if (!(environment.accuracy >= 0 && environment.accuracy <= environment.margin))
    problems.push_back("the accuracy of the position is part of the margin: from 0 to the margin");
  if (const auto& pilot = environment.pilot;
      pilot && !(sound(pilot->eye) && pilot->range > 0 && pilot->range <= 1e5 &&
                 pilot->beside >= 0 && pilot->beside <= 100))
    problems.push_back(
        "the pilot needs a place, a range above 0 and at most 1e5 m, and from 0 to 100 m beside "
        "which nothing hides the flight");
  for (std::size_t i = 0; i < environment.obstacles.size(); ++i) {
    const Obstacle& obstacle = environment.obstacles[i];
    const std::string problem = problem_of(obstacle);
    if (!problem.empty()) problems.push_back(obstacle.label(i + 1) + problem);
  }
  std::set<std::string> names;
  for (const Subject& subject : environment.subjects) {
    if (subject.name.empty()) problems.push_back("a subject has no name");
    if (!names.insert(subject.name).second) {
      problems.push_back("two subjects are named '" + subject.name + "'");
    }
    const std::string problem = problem_of(subject);
    if (!problem.empty()) problems.push_back("subject '" + subject.name + "'" + problem);
  }
}

void list_problems(const Plan& film, double finish, std::vector<std::string>& problems) {
  const auto judge = [&](const TimeSpan& span, const std::string& name) {
    if (!(span.start < span.finish) || !(span.start >= -tolerances::kSpanTime) ||
        !(span.finish <= finish + tolerances::kSpanTime)) {
      problems.push_back(name + " must start before it finishes, and lie within the flight");
    }
  };
  const auto judge_all = [&](const std::vector<TimeSpan>& spans, const char* kind) {
    for (std::size_t i = 0; i < spans.size(); ++i) {
      const std::string name = kind + std::to_string(i + 1);
      judge(spans[i], name);
      if (i > 0 && !(spans[i].start > spans[i - 1].finish))
        problems.push_back(name + " must start after the one before it finishes");
    }
  };
  judge_all(film.cuts, "cut ");
  judge_all(film.lights, "light ");
  for (std::size_t i = 0; i < film.task.strokes.size(); ++i) {
    const Points& stroke = film.task.strokes[i];
    if (stroke.size() < 2 || !(length_of(stroke) > 0) ||
        !std::all_of(stroke.begin(), stroke.end(), [](const auto& p) { return sound(p); }))
      problems.push_back("stroke " + std::to_string(i + 1) +
                         " must have a length, and finite coordinates up to 1e7");
  }
  if (!film.task.strokes.empty() && !(film.task.drawing_tolerance > 0))
    problems.emplace_back("the tolerance of the drawing must be above 0");
  if (!sound(film.task.drawing_view) || !(film.task.drawing_view.norm() > 0))
    problems.emplace_back("the view of the drawing must be a direction");
  for (std::size_t i = 0; i < film.task.framing.size(); ++i) {
    const FramingTask& asked = film.task.framing[i];
    const std::string name = "framing " + std::to_string(i + 1);
    judge(asked.span, name);
    const auto& subjects = film.environment.subjects;
    if (std::none_of(subjects.begin(), subjects.end(),
                     [&](const Subject& subject) { return subject.name == asked.subject; })) {
      problems.push_back(name + " names the subject '" + asked.subject +
                         "', which the environment lacks");
    }
  }
  if (!film.task.framing.empty() &&
      !(film.task.framing_share > 0 && film.task.framing_share <= 1)) {
    problems.emplace_back("the share of framing must be above 0 and at most 1");
  }
}

}  // namespace lapwing
