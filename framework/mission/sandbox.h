// SPDX-License-Identifier: Apache-2.0
// A Lua 5.4 state that a stranger's script may run in.
//
// What a script can reach is an allow-list: base functions without load and its kin, string, table,
// math, utf8 and coroutine. There is no os, io, debug or package; `require` reads modules from the
// folders given and nowhere else. Only text chunks are loaded. Memory, instructions and the
// script's own seconds are limited; each limit's message names the setting that raises it.
//
// How the limits hold. The allocator refuses above the cap. A count hook looks at the clock and the
// instruction count every thousand instructions; after the first overrun it fires at every
// instruction, so that pcall cannot swallow the error; coroutines inherit it. The hook never fires
// inside C functions, so those whose run time a script chooses (pattern matching, string.rep,
// table.move and the like) are wrapped and refuse work beyond a limit before they start. Finalisers
// and message handlers could run with hooks off and are refused or replaced.
//
// What a script computes is the same in every run: see sandbox_library.h and sandbox_heap.h.
// Garbage is collected by the hook, not by Lua.
//
// Not thread-safe. Everything that touches the state goes through `protect`: errors of the script
// come out as InputError with the script's file and line, defects of the bindings as themselves.
#pragma once

#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "framework/core/error.h"
#include "framework/core/parameters.h"
#include "framework/core/progress.h"
#include "framework/core/random.h"
#include "framework/mission/sandbox_heap.h"

struct lua_State;
struct lua_Debug;

namespace lapwing {

struct SandboxLimits {
  double memory = 256;                      // MB of Lua memory
  std::int64_t instructions = 100'000'000;  // of the Lua virtual machine
  double seconds = 20;                      // s of the script's own time; solving does not count
  double pattern_work = 2e8;                // steps one pattern match may need at the worst
};

// The settings `sandbox.*` of --config and --set.
ParameterTable sandbox_table();
SandboxLimits sandbox_limits(const Parameters& checked);

class Sandbox {
 public:
  // `module_folders`: where `require` looks, in this order; the script's own folder comes before
  // them. `print` receives whole lines.
  Sandbox(const SandboxLimits& limits, std::uint64_t seed,
          std::vector<std::filesystem::path> module_folders,
          std::function<void(const std::string&)> print);
  ~Sandbox();
  Sandbox(const Sandbox&) = delete;
  Sandbox& operator=(const Sandbox&) = delete;

  // Runs `body` inside a protected call. InputError for errors of the script and for InputErrors of
  // the bindings, with file and line; any other exception of a binding unchanged.
  void protect(const std::function<void(lua_State*)>& body);

  // Inside `protect`: loads a text file, runs it and leaves its one result on the stack. The first
  // file run is *the script*; its folder becomes the first module folder.
  void run_script(lua_State* state, const std::filesystem::path& script);

  // Where the script is: the innermost frame of the script's own file, else the last of its lines
  // outside of functions that ran.
  Origin script_position(lua_State* state) const;
  const std::string& script() const { return script_; }
  const SandboxLimits& limits() const { return limits_; }
  Random& random() { return random_; }
  const SandboxHeap& heap() const { return heap_; }
  // InputError once a script has printed more than a megabyte.
  void print(const std::string& line);

  // An interruption ends the script, after a grace in which it may finish with what it has:
  // `protect` then throws Cancelled. Null: never.
  void watch(const CancellationToken* cancellation) { cancellation_ = cancellation; }
  // Hears of the script and of every module before it is read. May be null.
  void watch_files(std::function<void(const std::filesystem::path&)> hear) {
    hear_file_ = std::move(hear);
  }

  static Sandbox& of(lua_State* state);

  // Stops the script's clock while the kernel works for it.
  class ClockPause {
   public:
    explicit ClockPause(Sandbox& sandbox);
    ~ClockPause();
    ClockPause(const ClockPause&) = delete;
    ClockPause& operator=(const ClockPause&) = delete;

   private:
    Sandbox& sandbox_;
    double since_;
  };

  // For the library's own sources only. `check_clock` raises the error when the time is up: called
  // by functions that may work long at one instruction.
  void check_clock(lua_State* state);
  // InputError where `bytes` that the kernel is about to hold for the script do not fit into what
  // its limit of memory leaves.
  void claim(lua_State* state, std::size_t bytes);
  void require(lua_State* state, const std::string& module);
  // The file that `require` would read; empty where there is none.
  std::filesystem::path module_file(const std::string& module) const;
  // The module of the same folder whose name is nearest; empty where none is near.
  std::string nearest_module(const std::string& module) const;
  void keep_defect(std::exception_ptr defect) { defect_ = std::move(defect); }

 private:
  static void* allocate(void* sandbox, void* block, std::size_t old_size, std::size_t new_size);
  static void hook(lua_State* state, lua_Debug* record);
  static int describe_error(lua_State* state);
  void count(lua_State* state, lua_Debug* record);
  bool out_of_time() const;
  void collect_when_due(lua_State* state);
  void begin_overrun(std::string message);
  std::string too_much_memory() const;
  void load(lua_State* state, const std::filesystem::path& file, const std::string& shown);
  void arm(lua_State* state);
  [[noreturn]] void fail(int status, const std::string& message);

  SandboxLimits limits_;
  Random random_;
  std::function<void(const std::filesystem::path&)> hear_file_;
  std::vector<std::filesystem::path> module_folders_;
  std::function<void(const std::string&)> print_;
  lua_State* state_ = nullptr;
  std::string script_;      // as the user typed it
  int last_line_ = 0;       // of the script, that ran
  int last_main_line_ = 0;  // the same outside of its functions
  SandboxHeap heap_;
  std::int64_t executed_ = 0;
  bool watching_lines_ = false;
  bool overrun_ = false;
  const CancellationToken* cancellation_ = nullptr;
  std::int64_t interrupted_at_ = -1;  // instructions run when the interruption was seen
  std::string overrun_message_;
  std::size_t printed_ = 0;           // bytes
  double started_ = 0, paused_ = 0;   // s
  std::vector<std::string> loading_;  // modules being loaded, to see circles
  std::exception_ptr defect_;
};

}  // namespace lapwing
