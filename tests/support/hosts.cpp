#include "tests/support/hosts.h"

#include <map>
#include <mutex>
#include <stdexcept>

#include "bench/common/thread_pool.h"

namespace winnow::test {
namespace {

constexpr std::size_t kCrowd = 8;

JobSystem pool_of(std::size_t threads) {
  static std::mutex mutex;
  static std::map<std::size_t, bench::ThreadPool> pools;
  const std::lock_guard lock(mutex);
  return pools.try_emplace(threads, threads).first->second.jobs();
}

}  // namespace

JobSystem jobs_of(std::string_view host, std::size_t threads) {
  if (host == "pool") return pool_of(threads);
  if (host == "crowd") {
    JobSystem jobs = pool_of(kCrowd);
    jobs.threads = threads;
    return jobs;
  }
  if (host != "reversed") throw std::invalid_argument("there is no such host");
  const auto backwards = [](void*, std::size_t count, JobSystem::Task task, void* tasks) {
    while (count > 0) task(tasks, --count);
  };
  return {backwards, nullptr, threads};
}

}  // namespace winnow::test
