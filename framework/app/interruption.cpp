// SPDX-License-Identifier: Apache-2.0
#include "framework/app/interruption.h"

#include <unistd.h>
#include <atomic>
#include <csignal>

namespace lapwing {

namespace {

constexpr int kInterrupted = 130;

// Static storage: a signal handler may touch nothing else.
CancellationToken g_token;
std::atomic<int> g_count{0};
std::atomic<bool> g_only_counts{false};
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);
struct sigaction g_before_int, g_before_term;

extern "C" void lapwing_interrupt(int) {
  ++g_count;
  if (g_token.cancelled() && !g_only_counts) _exit(kInterrupted);
  g_token.cancel();
}

}  // namespace

Interruption::Interruption() {
  struct sigaction action {};
  action.sa_handler = &lapwing_interrupt;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, &g_before_int);
  sigaction(SIGTERM, &action, &g_before_term);
}

Interruption::~Interruption() {
  g_only_counts = false;
  sigaction(SIGINT, &g_before_int, nullptr);
  sigaction(SIGTERM, &g_before_term, nullptr);
}

void Interruption::only_count() const {
  g_only_counts = true;
}

int Interruption::count() const {
  return g_count;
}

const CancellationToken& Interruption::token() const {
  return g_token;
}

}  // namespace lapwing
