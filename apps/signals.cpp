#include "apps/signals.h"

#include <signal.h>
#include <unistd.h>

namespace lamella::apps {

namespace {

std::atomic<bool> cancelled{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may touch nothing else");

extern "C" void on_signal(int number) {
  if (cancelled.exchange(true)) {
    ::signal(number, SIG_DFL);
    ::raise(number);
    return;
  }
  constexpr char kMessage[] = "\nlamella: info: stopping; once more to stop at once\n";
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kMessage, sizeof kMessage - 1);
}

}  // namespace

void watch_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
}

const std::atomic<bool>& cancel_flag() { return cancelled; }

}  // namespace lamella::apps
