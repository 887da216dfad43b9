// A team of threads when things go wrong: tasks that throw, and a system that gives no more threads.

#include "crossbeam/dynamics/thread_team.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <stdexcept>
#include <string>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

using crossbeam::InputError;
using crossbeam::ThreadTeam;

TEST_SUITE_BEGIN("dynamics");

TEST_CASE("an exception of a task reaches the caller, and the team can be used on") {
  for (const int threads : {1, 2, 4}) {
    CAPTURE(threads);
    ThreadTeam team(threads);
    for (int round = 0; round < 50; ++round) {
      CHECK_THROWS_WITH_AS(team.run(100,
                                    [](int task) {
                                      if (task % 7 == 3) throw std::runtime_error("task");
                                    }),
                           "task", std::runtime_error);
      std::atomic<int> done{0};
      team.run(100, [&done](int) { ++done; });
      CHECK(done == 100);
    }
  }
}

TEST_CASE("threads that the system does not give are an InputError that tells how many there are") {
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    // No address space for the stacks of 256 threads.
    rlimit space{};
    getrlimit(RLIMIT_AS, &space);
    space.rlim_cur = 300'000'000;
    setrlimit(RLIMIT_AS, &space);
    try {
      const ThreadTeam team(ThreadTeam::most_threads);
    } catch (const InputError& error) {
      const std::string text = error.what();
      const bool told = error.field() == "threads" && text.find("at most") != std::string::npos;
      _exit(told ? 42 : 2);
    }
    _exit(1);
  }
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  REQUIRE(WIFEXITED(status));  // no std::terminate
  CHECK(WEXITSTATUS(status) == 42);
}

TEST_SUITE_END();
