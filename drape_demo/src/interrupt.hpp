#pragma once
/// @file
/// Ctrl-C and its like, turned into an exception at the next report of progress, so that the
/// program leaves by the ordinary way and tidies up behind itself.

#include <exception>

namespace crossbeam::drape {

class Interrupted : public std::exception {
 public:
  explicit Interrupted(int signal) : signal_(signal) {}
  [[nodiscard]] const char* what() const noexcept override { return "interrupted"; }
  [[nodiscard]] int signal() const noexcept { return signal_; }

 private:
  int signal_;
};

/// From now on the signals that ask a program to end only leave a note: SIGINT, SIGTERM, SIGHUP and
/// SIGQUIT, of which a second one ends the program at once; SIGXCPU, SIGUSR1, SIGUSR2 and SIGALRM.
/// What the caller ignores stays ignored, as `nohup` and shells in the background want it. A reader
/// that has gone is no reason to end (SIGPIPE): the writing fails instead.
void catch_interrupts();

/// Throws Interrupted when a signal has arrived.
void check_interrupt();

}  // namespace crossbeam::drape
