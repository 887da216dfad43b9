#pragma once
/// @file
/// A few threads that work through numbered tasks together, again and again. Theory:
/// docs/theory/sweep.md, [S-5].

#include "crossbeam/base/error.hpp"

#include <atomic>
#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace crossbeam {

/// The caller is the first of the threads; without others there is neither thread nor lock.
class ThreadTeam {
 public:
  static constexpr int most_threads = 256;

  /// @param threads 1 to most_threads
  /// @throws InputError also where the system does not let the process have as many; none is left
  /// running then
  explicit ThreadTeam(int threads = 1) {
    if (!(threads >= 1 && threads <= most_threads))
      throw InputError("threads", std::to_string(threads), "",
                       "1 to " + std::to_string(most_threads));
    if (threads == 1) return;
    shared_ = std::make_unique<Shared>();
    try {
      for (int k = 1; k < threads; ++k)
        workers_.emplace_back([shared = shared_.get()] { shared->serve(); });
    } catch (const std::system_error& error) {
      const int most = this->threads();
      stop();
      throw InputError("threads", std::to_string(threads), "",
                       "at most " + std::to_string(most) +
                           ", which is all that the system lets this process have now (" +
                           error.what() + ")");
    } catch (...) {
      stop();
      throw;
    }
  }
  ThreadTeam(ThreadTeam&&) = default;
  ThreadTeam& operator=(ThreadTeam&& other) noexcept {
    stop();
    shared_ = std::move(other.shared_);
    workers_ = std::move(other.workers_);
    return *this;
  }
  ~ThreadTeam() { stop(); }

  [[nodiscard]] int threads() const { return static_cast<int>(workers_.size()) + 1; }

  /// Calls task(0), ..., task(count - 1), each once, and returns when all are done. The tasks must
  /// not depend on each other. When one of them throws, those not yet begun are left out, and the
  /// caller gets the first exception once the others have ended; the team can be used on.
  void run(int count, const std::function<void(int)>& task) {
    if (workers_.empty() || count < 2) {
      for (int k = 0; k < count; ++k) task(k);
      return;
    }
    shared_->task = &task;
    shared_->count = count;
    shared_->next.store(0, std::memory_order_relaxed);
    shared_->busy.store(static_cast<int>(workers_.size()), std::memory_order_relaxed);
    shared_->round.fetch_add(1, std::memory_order_release);
    shared_->round.notify_all();
    shared_->work();
    while (shared_->busy.load(std::memory_order_acquire) > 0) Shared::pause();
    if (shared_->failed.exchange(false, std::memory_order_relaxed))
      std::rethrow_exception(std::exchange(shared_->error, nullptr));
  }

 private:
  struct Shared {
    const std::function<void(int)>* task = nullptr;
    int count = 0;
    std::atomic<int> next{0}, busy{0};
    std::atomic<unsigned> round{0};
    std::atomic<bool> over{false}, failed{false};
    std::exception_ptr error;  // the first one; its writer is the one that sets `failed`

    void work() {
      try {
        for (int k; (k = next.fetch_add(1, std::memory_order_relaxed)) < count;) (*task)(k);
      } catch (...) {
        next.store(count, std::memory_order_relaxed);
        if (!failed.exchange(true, std::memory_order_relaxed)) error = std::current_exception();
      }
    }
    void serve() {
      for (unsigned seen = 0;;) {
        // A step is short: look for a while before going to sleep.
        for (int k = 0; k < 2000 && round.load(std::memory_order_acquire) == seen; ++k) pause();
        round.wait(seen, std::memory_order_acquire);
        seen = round.load(std::memory_order_acquire);
        if (over.load(std::memory_order_relaxed)) return;
        work();
        busy.fetch_sub(1, std::memory_order_release);
      }
    }
    static void pause() {
#if defined(__SSE2__)
      __builtin_ia32_pause();
#endif
    }
  };

  void stop() {
    if (!shared_) return;
    shared_->over.store(true, std::memory_order_relaxed);
    shared_->round.fetch_add(1, std::memory_order_release);
    shared_->round.notify_all();
    for (std::thread& worker : workers_) worker.join();
    workers_.clear();
    shared_.reset();
  }

  std::unique_ptr<Shared> shared_;
  std::vector<std::thread> workers_;
};

}  // namespace crossbeam
