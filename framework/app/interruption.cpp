// SPDX-License-Identifier: Apache-2.0
#include "framework/app/interruption.h"

#include <unistd.h>
#include <csignal>

namespace lapwing {

namespace {

constexpr int kInterrupted = 130;

CancellationToken g_token;  // static storage: a signal handler may touch nothing else
struct sigaction g_before_int, g_before_term;

extern "C" void lapwing_interrupt(int) {
  if (g_token.cancelled()) _exit(kInterrupted);
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
  sigaction(SIGINT, &g_before_int, nullptr);
  sigaction(SIGTERM, &g_before_term, nullptr);
}

const CancellationToken& Interruption::token() const {
  return g_token;
}

}  // namespace lapwing
