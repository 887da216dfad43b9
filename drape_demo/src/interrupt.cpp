#include "interrupt.hpp"

#include <csignal>
#include <initializer_list>

namespace crossbeam::drape {
namespace {

volatile std::sig_atomic_t signal_arrived = 0;

extern "C" void note_signal(int signal) {
  signal_arrived = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

void catch_interrupts() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, note_signal);
}

void check_interrupt() {
  if (signal_arrived != 0) throw Interrupted();
}

}  // namespace crossbeam::drape
