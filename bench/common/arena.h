#pragma once

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>
#include <map>

namespace winnow::bench {

/// TBB arenas by number of threads, which may exceed the number of cores.
class Arenas {
 public:
  /// `most`: the largest number of threads that `run` is called with.
  explicit Arenas(int most)
      : control_(tbb::global_control::max_allowed_parallelism,
                 std::max(static_cast<std::size_t>(most),
                          tbb::global_control::active_value(
                              tbb::global_control::max_allowed_parallelism))) {}

  template <typename Work>
  void run(int threads, Work&& work) {
    arenas_.try_emplace(threads, threads).first->second.execute(work);
  }

 private:
  // TBB limits arenas to the number of cores unless this allows more.
  tbb::global_control control_;
  std::map<int, tbb::task_arena> arenas_;
};

}  // namespace winnow::bench
