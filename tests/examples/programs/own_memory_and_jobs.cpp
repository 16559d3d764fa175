// winnow on the allocator and the job system of a program. All memory comes from the allocator, all
// parallel work runs on the job system, and frames that need no more than earlier frames do not
// allocate. Compared with the threads of oneTBB and with one thread.

#include <winnow/partitions/partition.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <cstddef>
#include <memory_resource>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "tests/examples/check.h"
#include "tests/examples/programs/race.h"

namespace {

/// The allocator of the program: counts requests and takes memory from the heap.
class CountingMemory final : public std::pmr::memory_resource {
 public:
  std::size_t requests = 0;
  std::size_t bytes = 0;

 private:
  void* do_allocate(std::size_t size, std::size_t alignment) override {
    ++requests;
    bytes += size;
    return std::pmr::new_delete_resource()->allocate(size, alignment);
  }
  void do_deallocate(void* block, std::size_t size, std::size_t alignment) override {
    bytes -= size;
    std::pmr::new_delete_resource()->deallocate(block, size, alignment);
  }
  [[nodiscard]] bool do_is_equal(const memory_resource& other) const noexcept override {
    return this == &other;
  }
};

/// The job system of the program: threads that wait for work. The calling thread also runs tasks.
class Jobs {
 public:
  explicit Jobs(std::size_t threads) {
    for (std::size_t i = 1; i < threads; ++i) workers_.emplace_back([this] { work(); });
  }
  ~Jobs() {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    wake_.notify_all();
  }
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;

  [[nodiscard]] winnow::JobSystem system() {
    return {[](void* self, std::size_t count, winnow::JobSystem::Task task, void* tasks) {
              static_cast<Jobs*>(self)->run({task, tasks, count});
            },
            this, workers_.size() + 1};
  }

 private:
  struct Batch {
    winnow::JobSystem::Task task = nullptr;
    void* tasks = nullptr;
    std::size_t count = 0;
  };

  void run(const Batch& batch) {
    const std::lock_guard one_at_a_time(callers_);
    {
      const std::lock_guard lock(mutex_);
      batch_ = batch;
      next_ = 0;
      ++number_;
    }
    wake_.notify_all();
    take_tasks(batch);
    // Waits for the threads that still run a task; other threads find no remaining task.
    std::unique_lock lock(mutex_);
    batch_ = {};
    done_.wait(lock, [&] { return working_ == 0; });
  }
  void take_tasks(const Batch& batch) {
    for (std::size_t i = next_++; i < batch.count; i = next_++) batch.task(batch.tasks, i);
  }
  void work() {
    std::size_t seen = 0;
    for (;;) {
      // A new batch often follows at once, so a thread tests kLooks times for one before it
      // sleeps.
      for (int look = 0; look < kLooks && number_ == seen; ++look) std::this_thread::yield();
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [&] { return stopping_ || number_ != seen; });
      if (stopping_) return;
      seen = number_;
      const Batch batch = batch_;
      ++working_;
      lock.unlock();
      take_tasks(batch);
      lock.lock();
      if (--working_ == 0) done_.notify_one();
    }
  }

  static constexpr int kLooks = 200;

  std::mutex callers_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::condition_variable done_;
  Batch batch_;
  std::size_t working_ = 0;
  bool stopping_ = false;
  std::atomic<std::size_t> number_{0};
  std::atomic<std::size_t> next_{0};
  std::vector<std::jthread> workers_;
};

/// Boxes that fly through a periodic world.
struct Boxes {
  explicit Boxes(std::size_t count) : side(std::cbrt(4.0F * static_cast<float>(count))) {
    std::uniform_real_distribution<float> place(0.0F, side);
    for (std::size_t i = 0; i < count; ++i) {
      const winnow::Vec3f at(place(random), place(random), place(random));
      all.push_back({at, at + winnow::Vec3f::constant(1)});
    }
  }
  void step() {
    for (winnow::Aabb& box : all) {
      const float by = box.min.x() > side ? -side : 0.02F;
      box.min.x() += by;
      box.max.x() += by;
    }
  }

  std::mt19937 random{1};
  float side;
  std::vector<winnow::Aabb> all;
};

/// A partition and its results, with given memory and threads.
class Finder {
 public:
  Finder(const Boxes& boxes, const winnow::Execution& execution, std::pmr::memory_resource* memory)
      : partition_(winnow::linear_bvh(), {.memory = memory, .execution = execution}),
        pairs(memory),
        keys_(boxes.all.size()) {
    check(partition_.reserve(boxes.all.size()) == winnow::Status::ok, "room is reserved");
    check(partition_.reserve_pairs(pairs, 4 * boxes.all.size()) == winnow::Status::ok,
          "room for pairs is reserved");
    check(partition_.insert(boxes.all, {}, keys_) == winnow::Status::ok, "boxes are inserted");
  }
  void find(const Boxes& boxes) {
    check(partition_.update(keys_, boxes.all) == winnow::Status::ok, "boxes move");
    check(partition_.self_pairs(pairs, {.order = winnow::Order::canonical}) == winnow::Status::ok,
          "pairs are found");
  }
  [[nodiscard]] std::size_t bytes() const {
    return partition_.footprint().total().reserved + pairs.footprint().total().reserved;
  }

 private:
  winnow::Partition partition_;

 public:
  winnow::PairBuffer pairs;

 private:
  std::vector<winnow::Key> keys_;
};

}  // namespace

int main(int argc, char** argv) {
  Race race(argc, argv);
  const std::size_t threads = std::max(2U, std::thread::hardware_concurrency());
  Jobs jobs(threads);
  CountingMemory memory;
  Boxes boxes(race.size(5'000, 100'000));
  Finder own(boxes, winnow::Execution::on(jobs.system()), &memory);
  Finder on_tbb(boxes, winnow::Execution::parallel(), std::pmr::get_default_resource());
  Finder single_threaded(boxes, winnow::Execution::serial(), std::pmr::get_default_resource());

  const std::size_t frames = race.size(20, 60);
  std::size_t before = 0;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    boxes.step();
    if (frame == frames / 2) before = memory.requests;
    race.time("winnow on own threads", [&] { own.find(boxes); });
    race.time("on oneTBB", [&] { on_tbb.find(boxes); });
    race.time("on one thread", [&] { single_threaded.find(boxes); });
    check(std::ranges::equal(own.pairs.pairs(), on_tbb.pairs.pairs()) &&
              std::ranges::equal(own.pairs.pairs(), single_threaded.pairs.pairs()),
          "all find the same pairs in the same order");
  }
  check(own.bytes() == memory.bytes, "the footprint equals the allocated memory, to the byte");
  const std::size_t later = memory.requests - before;
  return race.finish("own allocator and job system: " + std::to_string(boxes.all.size()) +
                     " boxes, " + std::to_string(memory.bytes / boxes.all.size()) +
                     " bytes each with pairs, " + std::to_string(later) +
                     " requests for memory in " + std::to_string(frames - frames / 2) +
                     " later frames, " + std::to_string(threads) + " threads");
}
