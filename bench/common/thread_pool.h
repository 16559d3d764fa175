#pragma once

#include <winnow/core/execution.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

namespace winnow::bench {

/// A minimal thread pool, as a host program may have. The caller of a batch works on it together
/// with the workers. Workers take tasks one by one, from the newest batch first.
class ThreadPool {
 public:
  /// `threads` includes the caller.
  explicit ThreadPool(std::size_t threads) : threads_(threads) {
    for (std::size_t i = 1; i < threads; ++i) workers_.emplace_back([this] { serve(); });
  }
  ~ThreadPool() {
    stopped_ = true;
    wake();
    for (std::thread& worker : workers_) worker.join();
  }
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  [[nodiscard]] JobSystem jobs() noexcept {
    return {[](void* self, std::size_t count, JobSystem::Task task, void* tasks) {
              static_cast<ThreadPool*>(self)->run({.task = task, .tasks = tasks, .count = count});
            },
            this, threads_};
  }

 private:
  struct Batch {
    JobSystem::Task task;
    void* tasks;
    std::size_t count;
    std::atomic<std::size_t> next{0};
    std::atomic<std::size_t> helpers{0};
    Batch* older = nullptr;

    void work() {
      for (std::size_t i = next++; i < count; i = next++) task(tasks, i);
    }
  };

  void run(Batch&& batch) {
    {
      const std::lock_guard lock(mutex_);
      batch.older = newest_;
      newest_ = &batch;
    }
    wake();
    batch.work();
    {
      const std::lock_guard lock(mutex_);
      Batch** at = &newest_;
      while (*at != &batch) at = &(*at)->older;
      *at = batch.older;
    }
    // Helpers that joined may still be in their last task.
    while (batch.helpers.load() != 0) std::this_thread::yield();
  }

  void serve() {
    while (!stopped_) {
      const std::uint32_t seen = signal_.load();
      Batch* const batch = join();
      if (batch != nullptr) {
        batch->work();
        --batch->helpers;
      } else if (!stopped_ && !wait_awake(seen)) {
        signal_.wait(seen);
      }
    }
  }

  // Returns the newest batch that has tasks left, or null.
  Batch* join() {
    const std::lock_guard lock(mutex_);
    for (Batch* batch = newest_; batch != nullptr; batch = batch->older) {
      if (batch->next.load() < batch->count) {
        ++batch->helpers;
        return batch;
      }
    }
    return nullptr;
  }

  // A frame has many short batches in quick succession, and putting a thread to sleep between two
  // batches would take longer than a batch: this spins first. Returns true if a new batch was
  // signalled.
  [[nodiscard]] bool wait_awake(std::uint32_t seen) const {
    constexpr int kSpinChecks = 200;
    for (int look = 0; look < kSpinChecks; ++look) {
      if (signal_.load() != seen) return true;
      std::this_thread::yield();
    }
    return false;
  }

  void wake() {
    ++signal_;
    signal_.notify_all();
  }

  std::size_t threads_;
  std::mutex mutex_;
  Batch* newest_ = nullptr;
  std::atomic<std::uint32_t> signal_{0};
  std::atomic<bool> stopped_{false};
  std::vector<std::thread> workers_;
};

}  // namespace winnow::bench
