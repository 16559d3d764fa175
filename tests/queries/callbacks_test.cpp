// An exception of a callback ends the process in every query. It cannot leave the query, because
// some kernels that call a predicate are compiled without exceptions.

#include <winnow/core/debug_draw.h>

#include <stdexcept>

#include "tests/support/platform.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

// WebAssembly has neither exceptions nor signals. Windows has no signals that end a process.
#if WINNOW_TEST_EXCEPTIONS
#include <csignal>
#endif
#if WINNOW_TEST_EXCEPTIONS && defined(SIGKILL)

namespace winnow::test {
namespace {

class ThrowingCallbacks : public testing::TestWithParam<int> {
 protected:
  ThrowingCallbacks() {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    world_.insert(boxes_);
    filter_.predicate.accept = [](void*, Key, ClientData) -> bool {
      throw std::runtime_error("x");
    };
    options_.predicate.accept = [](void*, ObjectId, ObjectId) -> bool {
      throw std::runtime_error("x");
    };
  }
  /// Runs a query on the threads of the test and expects that the process aborts.
  template <typename Query>
  void expect_end(Query&& query) {
    const auto run = [&] {
      try {
        (void)world_.threads().run(query);
      } catch (...) {
        // The exception left the query: the process ends, but without the expected signal.
      }
    };
    EXPECT_EXIT(run(), testing::KilledBySignal(SIGABRT), "");
  }

  std::vector<Aabb> boxes_ = std::vector<Aabb>(500, Aabb{{0, 0, 0}, {1, 1, 1}});
  World world_{Config{"LinearBvh", active_isa(), GetParam()}};
  const Partition& partition_ = world_.partition();
  Filter filter_;
  PairOptions options_;
};

TEST_P(ThrowingCallbacks, throwing_predicate_ends_a_pair_query) {
  PairBuffer pairs;
  expect_end([&] { return partition_.self_pairs(pairs, options_); });
  expect_end([&] { return partition_.pairs_with(partition_, pairs, options_); });
  expect_end([&] { return partition_.overlap(BoxView(boxes_), pairs, filter_); });
}

TEST_P(ThrowingCallbacks, throwing_predicate_ends_an_object_query) {
  HitBuffer hits;
  OverlapBuffer seen;
  const std::vector<Ray> rays(500, Ray{{-5, 0.5F, 0.5F}, {1, 0, 0}});
  expect_end([&] { return partition_.all(rays, hits, filter_); });
  expect_end([&] { return partition_.overlap(Sphere{{0, 0, 0}, 3.0F}, seen, filter_); });
}

struct ThrowingDraw final : DebugDraw {
  void box(const Aabb&, Colour) override { throw std::runtime_error("x"); }
  void line(const Vec3f&, const Vec3f&, Colour) override {}
  void sphere(const Sphere&, Colour) override {}
  void text(const Vec3f&, std::string_view, Colour) override {}
};

TEST_P(ThrowingCallbacks, throwing_drawing_ends_the_process) {
  ThrowingDraw draw;
  expect_end([&] { return partition_.debug_draw(draw); });
}

INSTANTIATE_TEST_SUITE_P(Threads, ThrowingCallbacks, testing::Values(1, 2));

}  // namespace
}  // namespace winnow::test

#endif
