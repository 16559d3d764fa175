#include "tests/support/hosts.h"

#include <cstdlib>

#if WINNOW_TEST_THREADS
#include <map>

#include "bench/common/thread_pool.h"
#endif

namespace winnow::test {
namespace {

#if WINNOW_TEST_THREADS
constexpr std::size_t kCrowd = 8;

JobSystem pool_of(std::size_t threads) {
  static std::mutex mutex;
  static std::map<std::size_t, bench::ThreadPool> pools;
  const std::lock_guard lock(mutex);
  return pools.try_emplace(threads, threads).first->second.jobs();
}
#endif

}  // namespace

JobSystem jobs_of(std::string_view host, std::size_t threads) {
#if WINNOW_TEST_THREADS
  if (host == "pool") return pool_of(threads);
  if (host == "crowd") {
    JobSystem jobs = pool_of(kCrowd);
    jobs.threads = threads;
    return jobs;
  }
#endif
  if (host != "reversed") std::abort();
  const auto backwards = [](void*, std::size_t count, JobSystem::Task task, void* tasks) {
    while (count > 0) task(tasks, --count);
  };
  return {backwards, nullptr, threads};
}

}  // namespace winnow::test
