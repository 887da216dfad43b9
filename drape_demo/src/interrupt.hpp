#pragma once
/// @file
/// Ctrl-C and its like, turned into an exception at the next report of progress, so that the
/// program leaves by the ordinary way and tidies up behind itself.

#include <exception>

namespace crossbeam::drape {

class Interrupted : public std::exception {
 public:
  [[nodiscard]] const char* what() const noexcept override { return "interrupted"; }
};

/// From now on SIGINT, SIGTERM and SIGHUP only leave a note; a second one ends the program at once.
void catch_interrupts();

/// Throws Interrupted when a signal has arrived.
void check_interrupt();

}  // namespace crossbeam::drape
