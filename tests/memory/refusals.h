#pragma once

#include <gtest/gtest.h>
#include <winnow/core/status.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <memory_resource>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/support/config.h"
#include "tests/support/counting_memory.h"
#include "tests/support/random.h"

namespace winnow::test {

inline std::size_t refused_to_all_plays = 0;

/// Values that are compared bit by bit.
using Digest = std::vector<std::uint64_t>;

inline void put(Digest& digest, double value) {
  digest.push_back(std::bit_cast<std::uint64_t>(value));
}

/// One call of a script: a name for messages and its effect on the world.
template <typename World>
struct Call {
  const char* name;
  std::function<Status(World&)> run;
};

/// Runs a list of calls many times. In each run the memory resource refuses request k of one call:
/// only this request, or this request and all later ones. At full scale there is one run for each
/// call and each k up to the number of requests of the call. A call that returns `out_of_memory`
/// must leave the digest as it was, and must succeed once memory is available. The remaining calls
/// must then return the keys, ids and results of a run without refusals.
///
/// A World is constructed with a memory resource and has `void describe(Digest&) const`, which
/// appends all its observable state and the results of the calls so far.
template <typename World, typename... Arguments>
class RefusedPlay {
 public:
  RefusedPlay(std::vector<Call<World>> calls, int threads, Arguments... arguments)
      : calls_(std::move(calls)), threads_(threads), arguments_(arguments...) {}

  /// Returns the number of refused requests. Records the total over all plays of the process as a
  /// property of the running test.
  std::size_t check() {
    play_reference();
    for (std::size_t call = 0; call < calls_.size() && !testing::Test::HasFailure(); ++call) {
      SCOPED_TRACE(std::string("call ") + std::to_string(call) + ", " + calls_[call].name);
      for (const bool once : {true, false}) {
        std::size_t k = is_quick() && !once ? 1 : 0;
        while (refuse(call, k, once)) k += step_after(k);
        EXPECT_LT(k, kMaxRequests) << "the call never stops requesting memory";
      }
    }
    refused_to_all_plays += refused_;
    testing::Test::RecordProperty("refused_so_far", std::to_string(refused_to_all_plays));
    return refused_;
  }

 private:
  static constexpr std::size_t kMaxRequests = 2000;

  /// Returns the step to the next request to refuse. Below full scale most requests after the first
  /// 20 are skipped. Below half scale, requests with an even number are refused only once, and
  /// requests with an odd number only together with all later ones.
  static std::size_t step_after(std::size_t k) {
    if (!is_reduced()) return 1;
    if (is_quick()) return k < 6 ? 2 : 62;
    return k < 20 ? 1 : 7;
  }

  std::unique_ptr<World> make(CountingMemory& memory) const {
    return std::apply(
        [&](auto... arguments) { return std::make_unique<World>(&memory, arguments...); },
        arguments_);
  }
  Status run(World& world, std::size_t call) {
    return threads_.run([&] { return calls_[call].run(world); });
  }
  static Digest digest(const World& world) {
    Digest digest;
    world.describe(digest);
    return digest;
  }

  void play_reference() {
    CountingMemory memory;
    const auto world = make(memory);
    truths_.push_back(digest(*world));
    for (std::size_t call = 0; call < calls_.size(); ++call) {
      ASSERT_EQ(run(*world, call), Status::ok) << calls_[call].name;
      truths_.push_back(digest(*world));
    }
  }

  /// Returns false if no request of the call was refused, or if a check failed.
  bool refuse(std::size_t call, std::size_t k, bool once) {
    CountingMemory memory;
    const auto world = make(memory);
    for (std::size_t i = 0; i < call; ++i) {
      if (run(*world, i) != Status::ok) return false;
    }
    const std::size_t refusals = memory.refusals();
    once ? memory.refuse_one_after(k) : memory.refuse_after(k);
    const Status status = run(*world, call);
    memory.grant_all();
    if (memory.refusals() == refusals) {
      EXPECT_EQ(status, Status::ok);
      return false;
    }
    ++refused_;
    if (status != Status::ok) {
      EXPECT_EQ(status, Status::out_of_memory);
      EXPECT_TRUE(digest(*world) == truths_[call]) << "a refused call changed the state";
      EXPECT_EQ(run(*world, call), Status::ok) << "after memory was granted";
    }
    for (std::size_t i = call + 1; i < calls_.size(); ++i) {
      EXPECT_EQ(run(*world, i), Status::ok) << "later, " << calls_[i].name;
    }
    EXPECT_TRUE(digest(*world) == truths_.back()) << "differs from the run without refusals";
    if (!testing::Test::HasFailure() && k < kMaxRequests) return true;
    ADD_FAILURE() << "request " << k << (once ? " only" : " and all later ones");
    return false;
  }

  std::vector<Call<World>> calls_;
  Threads threads_;
  std::tuple<Arguments...> arguments_;
  std::vector<Digest> truths_;  // before each call, and at the end
  std::size_t refused_ = 0;
};

}  // namespace winnow::test
