// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/sandbox.h"

#include <time.h>

#include <algorithm>
#include <cstring>

#include "framework/core/files.h"
#include "framework/core/log.h"
#include "framework/mission/guard.h"
#include "framework/mission/sandbox_library.h"
#include "framework/mission/sandbox_text.h"

namespace lapwing {

namespace {

constexpr int kHookInterval = 100;                      // instructions
constexpr std::int64_t kGraceInstructions = 5'000'000;  // to finish after an interruption
constexpr std::size_t kLargeBlock = 64u << 10;    // bytes; allocations above look at the clock
constexpr std::size_t kLargestScript = 4u << 20;  // bytes
constexpr std::size_t kMostPrinted = 1u << 20;    // bytes

// s of processor time of this thread: a script must not end because the machine is busy.
double now() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  constexpr double kNanosecond = 1e-9;
  return static_cast<double>(time.tv_sec) + kNanosecond * static_cast<double>(time.tv_nsec);
}

constexpr std::size_t kLongestArgument = 1u << 20;  // bytes of a name or a message

std::string shortest(double number) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.6g", number);
  return buffer;
}

// Lua abbreviates long file names in its messages; this is how.
std::string abbreviated(const std::string& source) {
  constexpr std::size_t kShown = LUA_IDSIZE - 1;
  if (source.size() <= kShown) return source;
  return "..." + source.substr(source.size() - (kShown - 3));
}

std::string with_full_name(const std::string& message, const std::string& source) {
  const std::string shown = abbreviated(source) + ":";
  if (message.rfind(shown, 0) != 0) return message;
  return source + ":" + message.substr(shown.size());
}

// "shot.lua:3: ..." or "--set: ...".
bool begins_with_place(const std::string& message) {
  if (message.rfind("--", 0) == 0) return true;
  const std::size_t end = message.find(": ");
  if (end == std::string::npos) return false;
  std::size_t digits = end;
  while (digits > 0 && std::isdigit(static_cast<unsigned char>(message[digits - 1]))) --digits;
  return digits < end && digits > 1 && message[digits - 1] == ':';
}

// Names a module as being loaded, also when loading fails.
class LoadingMark {
 public:
  LoadingMark(std::vector<std::string>& loading, std::string file) : loading_(loading) {
    loading_.push_back(std::move(file));
  }
  ~LoadingMark() { loading_.pop_back(); }
  LoadingMark(const LoadingMark&) = delete;
  LoadingMark& operator=(const LoadingMark&) = delete;

 private:
  std::vector<std::string>& loading_;
};

}  // namespace

ParameterTable sandbox_table() {
  const SandboxLimits standard;
  ParameterTable table;
  table.number("memory", standard.memory, "", "MB of memory that a script may use", between(1, 1e5))
      .integer("instructions", standard.instructions,
               "instructions of the Lua machine that a script may run", between(1000, 1e15))
      .number("seconds", standard.seconds, "s",
              "computing time of a script; solving does not count", between(0.01, 1e6))
      .number("pattern_work", standard.pattern_work, "",
              "steps that one string pattern may need at the worst", between(1, 1e15));
  return table;
}

SandboxLimits sandbox_limits(const Parameters& checked) {
  SandboxLimits limits;
  limits.memory = checked.number("memory");
  limits.instructions = checked.integer("instructions");
  limits.seconds = checked.number("seconds");
  limits.pattern_work = checked.number("pattern_work");
  return limits;
}

Sandbox::Sandbox(const SandboxLimits& limits, std::uint64_t seed,
                 std::vector<std::filesystem::path> module_folders,
                 std::function<void(const std::string&)> print)
    : limits_(limits),
      random_(seed),
      module_folders_(std::move(module_folders)),
      print_(std::move(print)),
      heap_(limits.memory) {
  state_ = lua_newstate(&Sandbox::allocate, this);
  if (!state_) throw Error("no memory for a Lua state");
  *static_cast<Sandbox**>(lua_getextraspace(state_)) = this;
  lua_gc(state_, LUA_GCSTOP);  // `collect_when_due` does it
  heap_.learn_layout(state_);
  open_allowed_libraries(state_);
  heap_.set_capped(true);
  started_ = now();
  arm(state_);
}

Sandbox::~Sandbox() {
  heap_.set_capped(false);
  lua_sethook(state_, nullptr, 0, 0);
  lua_close(state_);
}

Sandbox& Sandbox::of(lua_State* state) {
  return **static_cast<Sandbox**>(lua_getextraspace(state));
}

Sandbox::ClockPause::ClockPause(Sandbox& sandbox) : sandbox_(sandbox), since_(now()) {}
Sandbox::ClockPause::~ClockPause() {
  sandbox_.paused_ += now() - since_;
}

bool Sandbox::out_of_time() const {
  return now() - started_ - paused_ > limits_.seconds;
}

void* Sandbox::allocate(void* sandbox, void* block, std::size_t old_size, std::size_t new_size) {
  Sandbox& self = *static_cast<Sandbox*>(sandbox);
  const std::size_t old_bytes = block ? old_size : 0;
  if (new_size > kLargeBlock && new_size > old_bytes && self.started_ > 0 && self.out_of_time()) {
    self.begin_overrun("");
    return nullptr;
  }
  return self.heap_.resize(block, old_size, new_size);
}

// Not inside of allocations, where Lua itself would: those come at other places in another run,
// because the seed of Lua's hashes decides when a table grows.
void Sandbox::collect_when_due(lua_State* state) {
  if (!heap_.collection_due()) return;
  lua_gc(state, LUA_GCCOLLECT);
  heap_.note_collection();
}

void Sandbox::claim(lua_State* state, std::size_t bytes) {
  if (heap_.fits(bytes)) return;
  lua_gc(state, LUA_GCCOLLECT);
  heap_.note_collection();
  if (heap_.fits(bytes)) return;
  throw InputError(script_position(state), too_much_memory());
}

std::string Sandbox::too_much_memory() const {
  return "the script needs more than " + shortest(limits_.memory) +
         " MB of memory; raise sandbox.memory";
}

void Sandbox::arm(lua_State* state) {
  const int lines = watching_lines_ ? LUA_MASKLINE : 0;
  lua_sethook(state, &Sandbox::hook, LUA_MASKCOUNT | lines, overrun_ ? 1 : kHookInterval);
}

void Sandbox::begin_overrun(std::string message) {
  if (overrun_) return;
  overrun_ = true;
  overrun_message_ = message.empty() ? "the script ran for more than " + shortest(limits_.seconds) +
                                           " s; raise sandbox.seconds if necessary"
                                     : std::move(message);
}

void Sandbox::hook(lua_State* state, lua_Debug* record) {
  Sandbox& self = of(state);
  if (record->event == LUA_HOOKLINE) {
    lua_getinfo(state, "S", record);
    if (record->source[0] == '@' && self.script_ == record->source + 1) {
      self.last_line_ = record->currentline;
      if (std::string_view(record->what) == "main") self.last_main_line_ = record->currentline;
    }
    return;
  }
  self.count(state, record);
}

void Sandbox::count(lua_State* state, lua_Debug* record) {
  collect_when_due(state);
  executed_ += lua_gethookcount(state);
  if (!overrun_ && executed_ > limits_.instructions) {
    begin_overrun("the script ran more than " + std::to_string(limits_.instructions) +
                  " instructions; raise sandbox.instructions if necessary");
  }
  if (!overrun_ && out_of_time()) begin_overrun("");
  if (!overrun_ && cancellation_ && cancellation_->cancelled()) {
    if (interrupted_at_ < 0) interrupted_at_ = executed_;
    if (executed_ - interrupted_at_ > kGraceInstructions) begin_overrun("interrupted");
  }
  if (!overrun_) return;
  arm(state);
  lua_getinfo(state, "Sl", record);
  const bool of_a_file = record->source[0] == '@';  // else one of our own replacements
  const Origin place =
      of_a_file ? Origin{record->source + 1, record->currentline} : script_position(state);
  push_text(state, place.to_string() + ": " + overrun_message_);
  lua_error(state);
}

void Sandbox::check_clock(lua_State* state) {
  collect_when_due(state);
  if (!overrun_ && !out_of_time()) return;
  begin_overrun("");
  arm(state);
  push_text(state, script_position(state).to_string() + ": " + overrun_message_);
  lua_error(state);
}

void Sandbox::print(const std::string& line) {
  printed_ += line.size() + 1;
  if (printed_ > kMostPrinted) throw InputError("print: more than a megabyte in one run");
  print_(line);
}

Origin Sandbox::script_position(lua_State* state) const {
  lua_Debug record;
  for (int level = 0; lua_getstack(state, level, &record); ++level) {
    lua_getinfo(state, "Sl", &record);
    if (record.currentline > 0 && record.source[0] == '@' && script_ == record.source + 1) {
      return {script_, record.currentline};
    }
  }
  // `return film.shot {...}` is a tail call, after which the script has no frame any more.
  return {script_, std::max(last_main_line_, 1)};
}

void Sandbox::protect(const std::function<void(lua_State*)>& body) {
  lua_State* state = state_;
  const int top = lua_gettop(state);
  lua_pushcfunction(state, &Sandbox::describe_error);
  lua_pushcfunction(
      state, +[](lua_State* inner) {
        const auto& work =
            *static_cast<const std::function<void(lua_State*)>*>(lua_touserdata(inner, 1));
        lua_settop(inner, 0);
        try {
          work(inner);
          return 0;
        } catch (const InputError& error) {
          push_input_error(inner, error);
        } catch (const std::exception& error) {
          push_defect(inner, error);
        }
        return lua_error(inner);
      });
  lua_pushlightuserdata(state, const_cast<std::function<void(lua_State*)>*>(&body));
  defect_ = nullptr;
  heap_.set_exceeded(false);
  const int status = lua_pcall(state, 1, 0, top + 1);
  std::string message;
  if (status != LUA_OK) {
    std::size_t length = 0;
    if (const char* text = lua_tolstring(state, -1, &length)) message = as_message({text, length});
  }
  lua_settop(state, top);
  const bool interrupted = overrun_ && interrupted_at_ >= 0;
  if (status != LUA_OK && interrupted) throw Cancelled();
  if (status != LUA_OK) fail(status, message);
}

void Sandbox::fail(int status, const std::string& message) {
  if (defect_) std::rethrow_exception(std::exchange(defect_, nullptr));
  const Origin last{script_, std::max(last_line_, 1)};
  const bool no_memory = status == LUA_ERRMEM || message.find("not enough memory") != message.npos;
  if (no_memory && overrun_) throw InputError(last, overrun_message_);
  if (no_memory && heap_.exceeded()) throw InputError(last, too_much_memory());
  if (status == LUA_ERRERR && overrun_) throw InputError(last, overrun_message_);
  if (!begins_with_place(message)) throw InputError(last, message);
  throw InputError(message);
}

// Called where the error was raised, before the stack unwinds.
int Sandbox::describe_error(lua_State* state) {
  const Sandbox& self = of(state);
  std::string message;
  if (lua_type(state, 1) == LUA_TSTRING) {
    std::size_t length = 0;
    const char* const text = lua_tolstring(state, 1, &length);
    message = as_message({text, length});
  } else {
    message = std::string("the script raised an error that is not a text but a ") +
              luaL_typename(state, 1);
  }
  lua_Debug record;
  for (int level = 0; level < 20 && lua_getstack(state, level, &record); ++level) {
    lua_getinfo(state, "S", &record);
    if (record.source[0] == '@') message = with_full_name(message, record.source + 1);
  }
  const Origin place = self.script_position(state);
  if (!begins_with_place(message)) {
    message = place.to_string() + ": " + message;
  } else if (place.line > 0 && message.rfind("--", 0) != 0 &&
             message.find(self.script_ + ":") == message.npos &&
             message.find(".lua:") != message.npos) {
    message += " (called from " + place.to_string() + ")";
  }
  luaL_traceback(state, state, nullptr, 1);
  logging::debug(message + "\n" + lua_tostring(state, -1));
  push_text(state, message);
  return 1;
}

void Sandbox::load(lua_State* state, const std::filesystem::path& file, const std::string& shown) {
  if (hear_file_) hear_file_(file);
  const std::string text = read_file(file, kLargestScript);
  if (!text.empty() && text[0] == LUA_SIGNATURE[0]) {
    throw InputError({shown, 1}, "this is precompiled Lua; only source text is accepted");
  }
  if (luaL_loadbufferx(state, text.data(), text.size(), ("@" + shown).c_str(), "t") == LUA_OK) {
    return;
  }
  std::size_t length = 0;
  const char* const given = lua_tolstring(state, -1, &length);
  const std::string message =
      with_full_name(given ? as_message({given, length}) : "the file does not load", shown);
  if (begins_with_place(message)) throw InputError(message);
  throw InputError({shown, 1}, message);
}

void Sandbox::run_script(lua_State* state, const std::filesystem::path& script) {
  script_ = script.string();
  last_line_ = last_main_line_ = 0;
  const std::filesystem::path folder = script.parent_path();
  module_folders_.insert(module_folders_.begin(), folder.empty() ? "." : folder);
  load(state, script, script_);
  watching_lines_ = true;
  arm(state);
  lua_call(state, 0, 1);
  watching_lines_ = false;
  arm(state);
}

namespace {

// The module's file below a folder of modules. InputError where the name is none.
std::string module_path(const std::string& module) {
  const bool well_formed =
      !module.empty() && module.front() != '.' && module.back() != '.' &&
      module.find("..") == module.npos &&
      module.find_first_not_of(
          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.") == module.npos;
  if (!well_formed) {
    throw InputError("'" + module +
                     "' is not a module name; expected names joined by dots, such as "
                     "\"mission.film\"");
  }
  std::string relative = module;
  std::replace(relative.begin(), relative.end(), '.', '/');
  return relative + ".lua";
}

}  // namespace

std::filesystem::path Sandbox::module_file(const std::string& module) const {
  const std::string relative = module_path(module);
  for (const std::filesystem::path& folder : module_folders_) {
    std::error_code error;
    const auto file = std::filesystem::canonical(folder / relative, error);
    if (!error) return file;
  }
  return {};
}

std::string Sandbox::nearest_module(const std::string& module) const {
  std::string folder = module.substr(0, module.rfind('.') == module.npos ? 0 : module.rfind('.'));
  const std::string before = folder.empty() ? "" : folder + ".";
  std::replace(folder.begin(), folder.end(), '.', '/');
  std::vector<std::string> known;
  for (const std::filesystem::path& root : module_folders_) {
    std::error_code error;
    for (const auto& item : std::filesystem::directory_iterator(root / folder, error))
      if (item.path().extension() == ".lua") known.push_back(before + item.path().stem().string());
  }
  std::sort(known.begin(), known.end());
  return nearest_name(module, known);
}

void Sandbox::require(lua_State* state, const std::string& module) {
  const std::string relative = module_path(module);
  std::string looked;
  for (const std::filesystem::path& folder : module_folders_) {
    std::error_code error;
    const auto root = std::filesystem::canonical(folder, error);
    if (error) continue;
    const auto file = std::filesystem::canonical(root / relative, error);
    looked += (looked.empty() ? "" : ", ") + (folder / relative).string();
    if (error) continue;
    const auto [at, unused] = std::mismatch(root.begin(), root.end(), file.begin(), file.end());
    if (at != root.end()) {
      throw InputError("module '" + module + "' leads out of " + folder.string());
    }
    luaL_getsubtable(state, LUA_REGISTRYINDEX, "lapwing.modules");
    if (lua_getfield(state, -1, file.c_str()) != LUA_TNIL) {
      lua_remove(state, -2);
      return;
    }
    lua_pop(state, 1);
    for (const std::string& open : loading_) {
      if (open == file) throw InputError("module '" + module + "' requires itself");
    }
    const LoadingMark mark(loading_, file.string());
    const std::string shown = folder.filename().empty() || folder == "."
                                  ? relative
                                  : (folder.filename() / relative).string();
    load(state, file, shown);
    lua_call(state, 0, 1);
    if (lua_isnil(state, -1)) {
      lua_pop(state, 1);
      lua_pushboolean(state, 1);
    }
    lua_pushvalue(state, -1);
    lua_setfield(state, -3, file.c_str());
    lua_remove(state, -2);
    return;
  }
  const std::string nearest = nearest_module(module);
  throw InputError("module '" + module + "' not found" +
                   (nearest.empty() ? "" : "; did you mean '" + nearest + "'?") + "; looked for " +
                   looked);
}

void push_input_error(lua_State* state, const InputError& error) {
  std::string text = error.what();
  if (!begins_with_place(text)) {
    const Origin place = Sandbox::of(state).script_position(state);
    text = place.to_string() + ": " + text;
  }
  push_text(state, text);
}

void push_defect(lua_State* state, const std::exception& error) {
  Sandbox::of(state).keep_defect(std::current_exception());
  push_text(state, error.what());
}

std::string text_argument(lua_State* state, int index, const char* what) {
  if (lua_type(state, index) != LUA_TSTRING) {
    throw InputError(std::string(what) + ": expected a text, got " + luaL_typename(state, index));
  }
  std::size_t length = 0;
  const char* text = lua_tolstring(state, index, &length);
  if (length > kLongestArgument) {
    throw InputError(std::string(what) + ": a text of " + std::to_string(length) +
                     " bytes; expected at most " + std::to_string(kLongestArgument));
  }
  return std::string(text, length);
}

}  // namespace lapwing
