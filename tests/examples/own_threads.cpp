// A partition that runs its work on the threads of the program.

#include <winnow/partitions/partition.h>

#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

#include "tests/examples/check.h"

namespace {

/// A job system of a program: runs a function for every i < count on its threads. A real one keeps
/// its threads.
class JobQueue {
 public:
  static constexpr std::size_t kThreads = 4;

  template <typename Work>
  void for_each(std::size_t count, const Work& work) {
    std::atomic<std::size_t> next{0};
    std::vector<std::jthread> threads;
    for (std::size_t thread = 0; thread < kThreads; ++thread) {
      threads.emplace_back([&] {
        for (std::size_t i = next++; i < count; i = next++) work(i);
      });
    }
  }
};

}  // namespace

int main() {
  std::vector<winnow::Aabb> boxes;
  for (int i = 0; i < 20'000; ++i) {
    const float x = 0.75F * static_cast<float>(i);
    boxes.push_back({{x, 0, 0}, {x + 1, 1, 1}});
  }
  std::vector<winnow::Key> keys(boxes.size());
  JobQueue queue;

  // [own threads]
  const auto parallel_for = [](void* context, std::size_t count, winnow::JobSystem::Task task,
                               void* tasks) {
    static_cast<JobQueue*>(context)->for_each(count, [&](std::size_t i) { task(tasks, i); });
  };
  const winnow::JobSystem jobs{parallel_for, &queue, JobQueue::kThreads};
  winnow::Partition partition(winnow::linear_bvh(), {.execution = winnow::Execution::on(jobs)});
  // [end]
  winnow::PairBuffer pairs;
  check(partition.insert(boxes, {}, keys) == winnow::Status::ok, "boxes are inserted");
  check(partition.self_pairs(pairs) == winnow::Status::ok, "pairs are found");
  check(pairs.size() == boxes.size() - 1, "each overlaps the next");
}
