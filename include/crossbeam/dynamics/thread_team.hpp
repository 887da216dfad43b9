#pragma once
/// @file
/// A few threads that work through numbered tasks together, again and again. Theory:
/// docs/theory/sweep.md, [S-5].

#include "crossbeam/base/error.hpp"

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace crossbeam {

/// The caller is the first of the threads; without others there is neither thread nor lock.
class ThreadTeam {
 public:
  /// @param threads 1 to 256
  explicit ThreadTeam(int threads = 1) {
    if (!(threads >= 1 && threads <= 256))
      throw InputError("threads", std::to_string(threads), "", "1 to 256");
    if (threads == 1) return;
    shared_ = std::make_unique<Shared>();
    for (int k = 1; k < threads; ++k)
      workers_.emplace_back([shared = shared_.get()] { shared->serve(); });
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
  /// not throw and must not depend on each other.
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
  }

 private:
  struct Shared {
    const std::function<void(int)>* task = nullptr;
    int count = 0;
    std::atomic<int> next{0}, busy{0};
    std::atomic<unsigned> round{0};
    std::atomic<bool> over{false};

    void work() {
      for (int k; (k = next.fetch_add(1, std::memory_order_relaxed)) < count;) (*task)(k);
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
