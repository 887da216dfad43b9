#include "interrupt.hpp"

#include <csignal>
#include <initializer_list>

namespace crossbeam::drape {
namespace {

volatile std::sig_atomic_t signal_arrived = 0;

extern "C" void note_signal(int signal) { signal_arrived = signal; }

/// @param flags SA_RESETHAND: the next one of its kind ends the program
void note(int signal, int flags) {
  struct sigaction action {};
  if (sigaction(signal, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) return;
  action = {};
  action.sa_handler = note_signal;
  action.sa_flags = flags | SA_RESTART;
  sigaction(signal, &action, nullptr);
}

}  // namespace

void catch_interrupts() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT})
    note(signal, static_cast<int>(SA_RESETHAND));
  // Of these a second one is no sign of impatience: SIGXCPU comes every second.
  for (const int signal : {SIGXCPU, SIGUSR1, SIGUSR2, SIGALRM}) note(signal, 0);
  std::signal(SIGPIPE, SIG_IGN);
}

void check_interrupt() {
  if (signal_arrived != 0) throw Interrupted(signal_arrived);
}

}  // namespace crossbeam::drape
