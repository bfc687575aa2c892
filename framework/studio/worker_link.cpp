// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/worker_link.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <condition_variable>
#include <csignal>
#include <cstring>
#include <deque>
#include <mutex>
#include <thread>

#include "framework/core/json.h"

namespace lapwing {
namespace {

constexpr std::size_t kKeptErrors = 4096;  // bytes of standard error

// Both ends close when a program is executed.
struct Pipe {
  int from = -1, to = -1;
  Pipe() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) < 0)
      throw Error(std::string("studio: no pipe to a working process: ") + std::strerror(errno));
    from = ends[0];
    to = ends[1];
  }
};

// In the child, with nothing but what is safe after a fork.
[[noreturn]] void become(const char* program, char* const* arguments, int input, int output,
                         int errors, pid_t parent) {
  ::setpgid(0, 0);  // Ctrl-C at a terminal reaches the server alone
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(3);
  // Out of the way of the numbers that they become.
  const int in = ::fcntl(input, F_DUPFD, 10), out = ::fcntl(output, F_DUPFD, 10),
            err = ::fcntl(errors, F_DUPFD, 10);
  if (::dup2(in, STDIN_FILENO) < 0 || ::dup2(err, STDOUT_FILENO) < 0 ||
      ::dup2(err, STDERR_FILENO) < 0 || ::dup2(out, kWorkerOutput) < 0)
    ::_exit(3);
  for (const int done : {in, out, err}) ::close(done);
  ::execv(program, arguments);
  ::_exit(3);
}

std::string how_it_ended(int status) {
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    return signal == SIGKILL ? "it was killed" : std::string("it ended: ") + ::strsignal(signal);
  }
  return "it ended with exit status " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

struct WorkerLink::Run {
  pid_t process = -1;
  int input = -1, output = -1, errors = -1;  // our ends
  std::thread writer, reader, listener;
  std::mutex mutex;  // of what follows
  std::condition_variable changed;
  std::deque<Frame> waiting;
  bool closing = false;
  std::string said;  // the last of its standard error

  void write_frames() {
    for (;;) {
      std::unique_lock lock(mutex);
      changed.wait(lock, [&] { return closing || !waiting.empty(); });
      if (closing) return;
      const Frame frame = std::move(waiting.front());
      waiting.pop_front();
      lock.unlock();
      if (!write_frame(input, frame)) return;
    }
  }
  void keep_errors() {
    char bytes[1024];
    for (;;) {
      const ssize_t count = ::read(errors, bytes, sizeof bytes);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return;
      const std::lock_guard lock(mutex);
      said.append(bytes, static_cast<std::size_t>(count));
      if (said.size() > kKeptErrors) said.erase(0, said.size() - kKeptErrors);
    }
  }
  // Ends the process, and all threads.
  int finish() {
    {
      const std::lock_guard lock(mutex);
      closing = true;
    }
    changed.notify_all();
    // With what it started itself, which holds the pipes open as well.
    ::kill(-process, SIGKILL);
    ::kill(process, SIGKILL);
    int status = 0;
    while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    for (std::thread* thread : {&writer, &reader, &listener})
      if (thread->joinable()) thread->join();
    for (const int end : {input, output, errors}) ::close(end);
    return status;
  }
};

WorkerLink::WorkerLink(EventLoop& loop, WorkerProgram program, WorkerListener listener)
    : loop_(loop), program_(std::move(program)), listener_(std::move(listener)) {
  start();
}

WorkerLink::~WorkerLink() {
  *alive_ = false;
  if (run_) run_->finish();
}

pid_t WorkerLink::process() const {
  return run_ ? run_->process : -1;
}

void WorkerLink::start() {
  std::vector<std::string> words = program_.words;
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  Pipe input, output, errors;
  const pid_t parent = ::getpid(), child = ::fork();
  if (child == 0)
    become(program_.program.c_str(), arguments.data(), input.from, output.to, errors.to, parent);
  for (const int end : {input.from, output.to, errors.to}) ::close(end);
  if (child < 0) {
    for (const int end : {input.to, output.from, errors.from}) ::close(end);
    throw Error(std::string("studio: no working process: ") + std::strerror(errno));
  }
  auto run = std::make_shared<Run>();
  run->process = child;
  run->input = input.to;
  run->output = output.from;
  run->errors = errors.from;
  Run* const raw = run.get();
  run->writer = std::thread([raw] { raw->write_frames(); });
  run->listener = std::thread([raw] { raw->keep_errors(); });
  // Weak: the last owner joins this very thread.
  run->reader = std::thread([this, raw, weak = std::weak_ptr<Run>(run), alive = alive_] {
    const auto on_loop = [&](std::function<void(const std::shared_ptr<Run>&)> work) {
      loop_.post([weak, alive, work = std::move(work)] {
        const std::shared_ptr<Run> held = weak.lock();
        if (held && *alive) work(held);
      });
    };
    try {
      while (std::optional<Frame> frame = read_frame(raw->output)) {
        auto shared = std::make_shared<Frame>(std::move(*frame));
        on_loop([this, shared](const std::shared_ptr<Run>& held) {
          if (held == run_) listener_.heard(std::move(*shared));
        });
      }
    } catch (const std::exception&) {  // no frame: it is as good as dead
    }
    on_loop([this](const std::shared_ptr<Run>& held) { ended(held); });
  });
  run_ = std::move(run);
  loop_.post([this, alive = alive_] {
    if (*alive) listener_.started();
  });
}

void WorkerLink::ended(const std::shared_ptr<Run>& run) {
  if (run != run_) return;
  const int status = run_->finish();
  std::string why = how_it_ended(status);
  if (const std::size_t end = run->said.find_last_not_of(" \n"); end != std::string::npos) {
    const std::size_t line = run->said.rfind('\n', end);
    why = as_utf8(run->said.substr(line == std::string::npos ? 0 : line + 1,
                                   end - (line == std::string::npos ? 0 : line + 1) + 1)) +
          " (" + why + ")";
  }
  run_.reset();
  listener_.crashed(why);
  const auto now = std::chrono::steady_clock::now();
  std::erase_if(crashes_, [&](auto time) { return now - time > std::chrono::seconds(10); });
  crashes_.push_back(now);
  const bool keeps_ending = crashes_.size() > 8;
  loop_.after(std::chrono::milliseconds(keeps_ending ? 1000 : 0), [this, alive = alive_] {
    if (*alive && !run_) start();
  });
}

void WorkerLink::send(Frame frame) {
  if (!run_) return;
  {
    const std::lock_guard lock(run_->mutex);
    run_->waiting.push_back(std::move(frame));
  }
  run_->changed.notify_all();
}

}  // namespace lapwing
