// SPDX-License-Identifier: Apache-2.0
// `lapwing fly` and `lapwing autopilot` as processes of their own, over the loopback interface.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <pty.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/fly/link.h"
#include "framework/mavlink/packet_parser.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;
using Words = std::vector<std::string>;

struct Ended {
  int status = -1;
  std::string out, err;
};

class Live : public testing::Test {
 protected:
  Live() {
    static int count = 0;
    folder_ = fs::temp_directory_path() /
              ("lapwing_live_" + std::to_string(::getpid()) + "_" + std::to_string(count++));
    fs::create_directories(folder_);
  }
  ~Live() override {
    if (autopilot_ > 0) finish(autopilot_, "autopilot", SIGKILL);
    fs::remove_all(folder_);
  }

  pid_t start(const Words& words, const std::string& name) {
    const pid_t child = ::fork();
    if (child != 0) return child;
    if (::chdir(folder_.c_str()) != 0 || !std::freopen((name + ".out").c_str(), "w", stdout) ||
        !std::freopen((name + ".err").c_str(), "w", stderr) ||
        !std::freopen("/dev/null", "r", stdin))
      ::_exit(99);
    execute(words);
  }
  [[noreturn]] static void execute(const Words& words) {
    const std::string program = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing";
    std::vector<char*> pointers = {const_cast<char*>(program.c_str())};
    for (const std::string& word : words) pointers.push_back(const_cast<char*>(word.c_str()));
    pointers.push_back(nullptr);
    ::execv(program.c_str(), pointers.data());
    ::_exit(98);
  }
  Ended finish(pid_t child, const std::string& name, int signal = 0) {
    if (signal != 0) ::kill(child, signal);
    int status = 0;
    ::waitpid(child, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status),
            read_file(folder_ / (name + ".out")), read_file(folder_ / (name + ".err"))};
  }
  Ended run(const Words& words, const std::string& name = "fly") {
    return finish(start(words, name), name);
  }

  // Plans a script and returns its plan.
  std::string planned(const std::string& script, Words more = {}) {
    write_file_atomically(folder_ / "mission.lua", script);
    Words words = {"run", "mission.lua", "--quiet", "-o", "plan"};
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = run(words, "run");
    EXPECT_EQ(ended.status, 0) << ended.err;
    return "plan/plan.json";
  }
  std::string film() {
    return planned(
        "return require 'mission.film'.shot { name = 'short', keyframes = {\n"
        "  { position = {0, 0, 3}, time = 0 }, { position = {3, 1, 3.5}, time = 3 } } }");
  }

  // The simulated vehicle, on a port of its own.
  void begin_autopilot(const std::string& plan, Words more = {}) {
    Words words = {"autopilot", plan, "--port", "0", "--once", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    fs::remove(folder_ / "autopilot.err");
    to_.clear();
    autopilot_ = start(words, "autopilot");
    const std::string before = "udp:127.0.0.1:";
    for (int i = 0; i < 3000 && to_.empty(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      if (!fs::exists(folder_ / "autopilot.err")) continue;
      const std::string said = read_file(folder_ / "autopilot.err");
      const std::size_t at = said.find(before);
      if (at != std::string::npos && said.back() == '\n')
        to_ = said.substr(at, said.find('\n', at) - at);
    }
    ASSERT_FALSE(to_.empty());
  }
  Value end_autopilot() {
    const Ended ended = finish(autopilot_, "autopilot");
    autopilot_ = 0;
    const Value seen = from_json(ended.out, "autopilot");
    EXPECT_EQ(seen.at("setpoints").at("beyond_limits").as_integer(), 0) << ended.out;
    EXPECT_EQ(seen.at("arm_requests").as_integer(), 0);
    EXPECT_LT(seen.at("speed").as_number(), 0.75) << "it holds, or sinks";
    return seen;
  }
  // Both in lockstep.
  Ended fly(const std::string& plan, Words more = {}, Words autopilot = {"--pilot", "fly"}) {
    autopilot.push_back("--lockstep");
    begin_autopilot(plan, autopilot);
    Words words = {"fly", plan, "--to", to_, "--lockstep", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
  void expect_flown(const std::string& plan, Words more = {"--frame", "local"}) {
    const Ended ended = fly(plan, more);
    EXPECT_EQ(ended.status, 0) << ended.err << ended.out;
    const Value summary = from_json(ended.out, "fly");
    EXPECT_EQ(summary.at("end").as_text(), "flown");
    EXPECT_TRUE(summary.at("within_tolerance").as_boolean()) << ended.out;
    EXPECT_NEAR(summary.at("plan_time").as_number(), summary.at("plan_duration").as_number(), 0.1);
    const Value seen = end_autopilot();
    EXPECT_NEAR(seen.at("setpoints").at("rate").as_number(), 50, 1);
    EXPECT_LT(seen.at("setpoints").at("gap_worst").as_number(), 0.05);
  }
  void expect_refused(const Ended& ended, const std::string& part, int status = 2) {
    EXPECT_EQ(ended.status, status) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(part));
  }

  fs::path folder_;
  pid_t autopilot_ = 0;
  std::string to_;
};

TEST_F(Live, AFilmIsFlownInRealTimeAndLogged) {
  const std::string plan = film();
  begin_autopilot(plan, {"--pilot", "fly"});
  const Ended ended = run({"fly", plan, "--to", to_, "--frame", "local", "--hold", "0.5", "-o",
                           "take", "--tolerance", "0.5", "--json"});
  EXPECT_EQ(ended.status, 0) << ended.err << ended.out;
  // A log of packets of both sides, in the order of their times.
  const std::string log = read_file(folder_ / "take.tlog");
  std::uint64_t before = 0;
  int ours = 0, theirs = 0;
  for (std::size_t at = 0; at + 8 < log.size();) {
    std::uint64_t time = 0;
    for (std::size_t i = 0; i < 8; ++i) time = time << 8 | static_cast<std::uint8_t>(log[at + i]);
    EXPECT_GE(time, before);
    before = time;
    mavlink::PacketParser parser;
    const std::size_t length = 12 + static_cast<std::uint8_t>(log[at + 9]);
    const auto packets = parser.read(log.substr(at + 8, length), mavlink::Source::datagram);
    ASSERT_EQ(packets.size(), 1u) << at;
    ++(packets[0].system == 1 ? theirs : ours);
    at += 8 + length;
  }
  EXPECT_GT(ours, 350);
  EXPECT_GT(theirs, 700);
  const Value kept = from_json(read_file(folder_ / "take.json"), "take.json");
  EXPECT_EQ(kept.at("end").as_text(), "flown");
  end_autopilot();
  // A log is not replaced.
  expect_refused(run({"fly", plan, "--to", to_, "--frame", "local", "-o", "take"}),
                 "is there already");
}

TEST_F(Live, AFilmOnTheEarth) {
  expect_flown(planned(R"(return require 'mission.film'.shot { name = 'placed', keyframes = {
  { position = {0, 0, 3}, time = 0 }, { position = {6, 2, 4}, time = 5 } },
  origin = { latitude_deg = 46.5, longitude_deg = 6.6, height = 1, height_of = 'ground' },
  obstacles = { { type = 'no_fly_zone', name = 'yard',
                  corners = { {20, 0}, {30, 0}, {30, 9} } } } })"),
               {});
}

TEST_F(Live, ARace) {
  expect_flown(planned(R"(return require 'mission.race'.course { name = 'course',
  keyframes = { { position = {0, 0, 2} }, { position = {6, 2, 3} },
    { position = {10, -3, 2.5} }, { position = {3, -5, 2} } },
  timing = 'profile', solver = 'iqp', step = 0.3, tolerance = 0.05, thrust = 1,
  vehicle = { mass = 1, inertia = {0.01, 0.01, 0.02}, yaw_share = 0.1, flight_time = 600,
    rotors = { thrust = {0, 6}, torque_coefficient = 0.02, arm_length = 0.2 },
    limits = { speed_across = 2.4, climb_speed = 1.8, descent_speed = 1.8,
      acceleration_across = 4, acceleration_up = 3, acceleration_down = 3, yaw_rate_deg = 180 },
    camera = 'cameras/racing' } })"));
}

TEST_F(Live, ALightPainting) {
  expect_flown(
      planned("return require 'mission.light_painting'.text { name = 'letter', text = 'L',\n"
              "  height = 1, base = {0, 0, 2} }"));
}

TEST_F(Live, AScan) {
  fs::create_directories(folder_ / "scene");
  write_file_atomically(folder_ / "scene/hut.lua", R"(return function(options)
  local scene = lapwing.scene { name = "hut", seed = options.seed }
  scene:quad({-30, -30, 0}, {30, -30, 0}, {30, 30, 0}, {-30, 30, 0})
  scene:box({-4, -3, 0}, {4, 3, 4})
  scene:region({-6, -5, -0.4}, {6, 5, 7})
  return scene
end
)");
  expect_flown(planned(R"(return require "mission.scan".of_scene {
  name = "hut", scene = "hut", resolution = 0.4, range = 30, reach = 8,
  tour = { budget = 40, iterations = 10 },
  usable = { range = 30 },
  camera = { width = 80, height = 60, focal = 46 },
  flights = { { pattern = "ellipse", views = 8, reach = 3, pitch_deg = -40, height = 14 },
              { pattern = "meander", views = 12, reach = 1, height = 13 } },
  safe_height = 9, surface = { spacing = 0.8, cell = 1, trim = 2 },
  candidates = { most = 16, step = 2.5, distance_apart = 2 },
  motions = { alpha = 0.3, coarse = 40 } })"));
}

TEST_F(Live, AnExploration) {
  write_file_atomically(folder_ / "yard.obj",
                        "v -20 -20 0.1\nv 20 -20 0.1\nv 20 20 0.1\nv -20 20 0.1\nf 1 2 3 4\n"
                        "v 6 -8 0.1\nv 14 -8 0.1\nv 14 -8 7\nv 6 -8 7\nf 5 6 7 8\n");
  expect_flown(planned("return require 'mission.explore'.of_mesh { name = 'yard' }",
                       {"--config", "explore/small", "--set", "utility=frontier", "--set",
                        "camera.width=80", "--set", "camera.height=60", "--set", "start=[0,0,4]",
                        "--set", "input=yard.obj", "--set", "steps=3"}));
}

// The script of the example, with the program of this build.
TEST_F(Live, TheExampleIsRehearsed) {
  const fs::path example = fs::path(LAPWING_SOURCE_DIR) / "examples/flying";
  const std::string line = "cd '" + folder_.string() + "' && LAPWING='" + LAPWING_BUILD_DIR +
                           "/bin/lapwing' bash '" + (example / "rehearse.sh").string() + "' '" +
                           (example / "shot.lua").string() + "' out > said.txt 2> errors.txt";
  EXPECT_EQ(std::system(line.c_str()), 0) << read_file(folder_ / "errors.txt");
  const std::string said = read_file(folder_ / "said.txt");
  EXPECT_THAT(said, testing::AllOf(HasSubstr("rehearsal: calm"), HasSubstr("rehearsal: bad_link"),
                                   HasSubstr("crane over the field: flown"),
                                   HasSubstr("beyond them, or jumps   0"),
                                   HasSubstr("crane over the field: flown as planned")));
  for (const char* file : {"shot.plan", "calm.tlog", "calm.json", "bad_link.json"})
    EXPECT_TRUE(fs::exists(folder_ / "out" / file)) << file;
  for (const char* name : {"calm.json", "bad_link.json"}) {
    const Value kept = from_json(read_file(folder_ / "out" / name), name);
    EXPECT_TRUE(kept.at("within_tolerance").as_boolean());
    EXPECT_EQ(kept.at("fence_items").as_integer(), 4);
  }
}

// What fly has logged, told by the plan and by another one.
TEST_F(Live, ALoggedFlightIsCompared) {
  const std::string other = planned(
      "return require 'mission.film'.shot { name = 'other', keyframes = {\n"
      "  { position = {0, 0, 3}, time = 0 }, { position = {-4, 6, 9}, time = 8 } } }");
  fs::rename(folder_ / other, folder_ / "other.json");
  const std::string plan = planned(R"(return require 'mission.film'.shot { name = 'placed',
  keyframes = { { position = {0, 0, 3}, time = 0 }, { position = {6, 2, 4}, time = 5 } },
  origin = { latitude_deg = 46.5, longitude_deg = 6.6, height = 0, height_of = 'ground' } })");
  for (const char* frame : {"global", "local"}) {
    SCOPED_TRACE(frame);
    const std::string take = std::string("take_") + frame;
    const Ended flown = fly(plan, {"--frame", frame, "-o", take});
    ASSERT_EQ(flown.status, 0) << flown.err;
    end_autopilot();
    const double told = from_json(flown.out, "fly").at("position_error_worst").as_number();
    const Ended ended = run({"compare", plan, take + ".tlog", "--json"}, "compare");
    EXPECT_EQ(ended.status, 0) << ended.err << ended.out;
    const Value review = from_json(ended.out, "compare");
    EXPECT_EQ(review.at("log").at("damage").as_text(), "");
    EXPECT_EQ(review.at("missing_after").as_number(), 0);
    // The comparison finds the clock: without the delay of the link it is nearer.
    const double found = review.at("errors").at("distance").at("worst").as_number();
    EXPECT_LT(found, told + 0.01);
    EXPECT_NEAR(found, told, 0.08);
    for (const Value& offset : review.at("alignment").at("offset").as_list())
      EXPECT_NEAR(offset.as_number(), 0, 0.02);
    EXPECT_THAT(run({"compare", plan, take + ".tlog"}, "compare").out,
                HasSubstr("placed: flown as planned"));
  }
  const Ended wrong = run({"compare", "other.json", "take_local.tlog"}, "compare");
  EXPECT_EQ(wrong.status, 1) << wrong.err << wrong.out;
  EXPECT_THAT(wrong.out, Not(HasSubstr("flown as planned")));
}

struct LiveFault {
  const char* fault;
  int status;
  const char* end;  // or a part of the message where it is refused
};

// The same faults as of the session, with sockets between.
TEST_F(Live, FaultsAreFlownOrEndSafely) {
  const std::string plan = film();
  const LiveFault all[] = {{"lost=0.2", 0, "flown"},
                           {"noise=0.1", 0, "flown"},
                           {"jump=30@2", 0, "flown"},
                           {"gap=5@3", 1, "aborted"},
                           {"takeover=3", 1, "taken_over"},
                           {"unwell=3", 1, "aborted"},
                           {"refuse=arm", 2, "the pilot did not arm within 15 s"},
                           {"refuse=mode", 2, "did not come to OFFBOARD within 15 s"},
                           {"offset=38", 2, "38 m from the plan's start: 38 m east"},
                           {"battery=8", 2, "the battery has 8 %"}};
  for (const LiveFault& one : all) {
    SCOPED_TRACE(one.fault);
    to_.clear();
    const Ended ended =
        fly(plan, {"--frame", "local", "--wait", "15"}, {"--pilot", "fly", "--fault", one.fault});
    EXPECT_EQ(ended.status, one.status) << ended.err << ended.out;
    const Value answer = from_json(ended.out, "fly");
    if (one.status == 2) {
      EXPECT_THAT(answer.at("error").as_text(), HasSubstr(one.end));
      EXPECT_THAT(ended.err, HasSubstr(one.end));
    } else {
      EXPECT_EQ(answer.at("end").as_text(), one.end);
    }
    end_autopilot();
  }
}

TEST_F(Live, PausesResumesAndAbortsOnRequest) {
  const std::string plan = film();
  const Ended paused = fly(plan, {"--frame", "local", "--press", "pause@1,resume@4"});
  EXPECT_EQ(paused.status, 0) << paused.err << paused.out;
  EXPECT_THAT(paused.err, testing::AllOf(HasSubstr("paused"), HasSubstr("resumed")));
  end_autopilot();
  const Ended aborted = fly(plan, {"--frame", "local", "--press", "abort@1"});
  EXPECT_EQ(aborted.status, 1) << aborted.err;
  EXPECT_EQ(from_json(aborted.out, "fly").at("end").as_text(), "aborted");
  end_autopilot();
}

// Keys of a terminal, and Ctrl-C, in real time.
TEST_F(Live, ListensToKeysAndToCtrlC) {
  const std::string plan = film();
  begin_autopilot(plan, {"--pilot", "fly"});
  int terminal = -1;
  const pid_t child = ::forkpty(&terminal, nullptr, nullptr, nullptr);
  if (child == 0) {
    if (::chdir(folder_.c_str()) != 0) ::_exit(99);
    execute({"fly", plan, "--to", to_, "--frame", "local", "--hold", "0.2"});
  }
  std::string said;
  const auto wait_for = [&](const std::string& part) {
    for (int i = 0; i < 3000 && said.find(part) == std::string::npos; ++i) {
      char buffer[4096];
      const ssize_t got = ::read(terminal, buffer, sizeof buffer);
      if (got <= 0) break;
      said.append(buffer, static_cast<std::size_t>(got));
    }
    EXPECT_THAT(said, HasSubstr(part));
  };
  wait_for("lapwing: flying");
  EXPECT_EQ(::write(terminal, " ", 1), 1);
  wait_for("lapwing: paused");
  EXPECT_EQ(::write(terminal, "r", 1), 1);
  wait_for("lapwing: resumed");
  EXPECT_EQ(::write(terminal, "\x03", 1), 1);
  wait_for("aborted by the user");
  while (true) {
    char buffer[4096];
    if (::read(terminal, buffer, sizeof buffer) <= 0) break;
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ::close(terminal);
  EXPECT_EQ(WEXITSTATUS(status), 130);
  end_autopilot();
}

// Two at once: the session ends the flight, and the summary is written.
TEST_F(Live, EndsThroughTheSessionAtASecondCtrlC) {
  const std::string plan = film();
  begin_autopilot(plan, {"--pilot", "fly"});
  const pid_t child =
      start({"fly", plan, "--to", to_, "--frame", "local", "--hold", "600", "--json"}, "fly");
  const auto says = [&](const std::string& part) {
    const fs::path file = folder_ / "fly.err";
    for (int i = 0; i < 3000; ++i) {
      if (fs::exists(file) && read_file(file).find(part) != std::string::npos) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  };
  ASSERT_TRUE(says("lapwing: flying"));
  std::this_thread::sleep_for(std::chrono::milliseconds(1200));
  ::kill(child, SIGINT);
  ASSERT_TRUE(says("aborted by the user"));
  const Ended ended = finish(child, "fly", SIGINT);
  EXPECT_EQ(ended.status, 130) << ended.err;
  const Value summary = from_json(ended.out, "fly");
  EXPECT_EQ(summary.at("end").as_text(), "aborted");
  const std::string log = summary.at("log").as_text();
  EXPECT_TRUE(fs::exists(folder_ / (log.substr(0, log.size() - 5) + ".json"))) << log;
  end_autopilot();
}

TEST_F(Live, LockstepIsForSimulatorsThatTick) {
  const std::string plan = film();
  const auto lockstep = [&](const std::string& to) {
    return Words{"fly", plan, "--frame", "local", "--lockstep", "--to", to, "--yes-a-real-vehicle"};
  };
  expect_refused(run(lockstep("udp:192.0.2.7:14540")), "lockstep is for `lapwing autopilot");
  expect_refused(run(lockstep("serial:/dev/ttyACM0:57600")), "lockstep is for `lapwing autopilot");
  begin_autopilot(plan, {"--pilot", "fly"});
  expect_refused(run(lockstep(to_)), "a vehicle answers at " + to_ + " but does not tick");
  finish(autopilot_, "autopilot", SIGTERM);
  autopilot_ = 0;
  // Nobody is there; Ctrl-C is heard.
  Words waiting = lockstep("udp:127.0.0.1:9");
  waiting.insert(waiting.end(), {"--answer", "80000"});
  const pid_t child = start(waiting, "fly");
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  EXPECT_EQ(finish(child, "fly", SIGINT).status, 130);
}

TEST_F(Live, BadInputIsToldInOneMessage) {
  const std::string plan = film();
  const Words local = {"fly", plan, "--frame", "local", "--to"};
  const auto refused = [&](Words words, const std::string& part) {
    const Ended ended = run(words);
    expect_refused(ended, part);
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_FALSE(fs::exists(folder_ / "flights"));
  };
  const auto to = [&](const std::string& address) {
    Words words = local;
    words.push_back(address);
    return words;
  };
  refused({"fly", plan, "--to", "udp:127.0.0.1:9"}, "has no origin on the earth");
  refused(to("udp:192.0.2.1:14540"), "--yes-a-real-vehicle");
  refused(to("udpin:0.0.0.0:14550"), "--yes-a-real-vehicle");
  refused(to("tcp:127.0.0.1:5760"), "expected udp:HOST:PORT");
  refused(to("serial:/dev/none:57600"), "cannot open '/dev/none'");
  const auto taken = open_link({LinkAddress::Kind::udp_listening, "127.0.0.1", 0});
  const std::string port = std::to_string(taken->port());
  refused(to("udpin:127.0.0.1:" + port), "another program listens at port " + port);
  expect_refused(run({"autopilot", plan, "--port", port}), "another program listens at port");
  expect_refused(run({"autopilot", plan, "--fault", "storm=1"}), "expected lost=SHARE");
  Words gimbal = to("udp:127.0.0.1:9");
  gimbal.insert(gimbal.end(), {"--gimbal", "roi"});
  refused(gimbal, "--gimbal roi");
  Words press = to("udp:127.0.0.1:9");
  press.insert(press.end(), {"--press", "jump@3"});
  refused(press, "expected pause, resume or abort");
  // Nobody answers: said after the places that are sent, and nothing is written.
  Words alone = to("udp:127.0.0.1:" + port);
  alone.insert(alone.end(), {"--answer", "0.5", "--quiet"});
  const Ended ended = run(alone);
  expect_refused(ended, "nobody answers");
  EXPECT_FALSE(fs::exists(folder_ / "flights"));
}

TEST_F(Live, OnlyCertifiedPlansAreFlown) {
  std::string text = read_file(folder_ / film());
  const std::string from = "\"mission\": \"short\"";
  text.replace(text.find(from), from.size(), "\"mission\": \"other\"");
  write_file_atomically(folder_ / "changed.json", text);
  const auto listens = open_link({LinkAddress::Kind::udp_listening, "127.0.0.1", 0});
  const Ended ended = run({"fly", "changed.json", "--frame", "local", "--to",
                           "udp:127.0.0.1:" + std::to_string(listens->port())});
  expect_refused(ended, "is not certified, and is not flown", 1);
  EXPECT_FALSE(listens->receive(0.1)) << "nothing is sent";
}

}  // namespace
}  // namespace lapwing
