#include "bench/common/address_range.h"
#include "bench/peers/peers.h"
#include "bench/peers/registry.h"

#include <sg3.h>

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

namespace winnow::bench {
namespace {

static_assert(sizeof(::Box) == sizeof(Aabb) && sizeof(Pair) == sizeof(u64));

/// Reserves addresses for all possible pairs: the prototype writes without checking capacity.
std::unique_ptr<AddressRange> room_for_pairs(std::size_t objects) {
  constexpr std::size_t kSlack = 64;  // the prototype stores whole vectors
  constexpr std::size_t kMaxPairs = std::size_t{1} << 40U;
  const std::size_t pairs = std::min(objects * (objects + 1) / 2, kMaxPairs);
  return std::make_unique<AddressRange>((pairs + kSlack) * sizeof(u64));
}

class YardstickEngine final : public Yardstick {
 public:
  explicit YardstickEngine(int threads) : threads_(std::min(threads, kMaxThreads)) {
    sweep_.k = 5;  // strips of five mean extents
    if (threads > kMaxThreads) arena_ = std::make_unique<tbb::task_arena>(kMaxThreads);
  }

  [[nodiscard]] std::string name() const override { return std::string(kYardstickName); }
  [[nodiscard]] std::size_t largest() const override { return (std::size_t{1} << 30U) - 1; }

  void start(std::span<const Aabb> boxes) override { frame({}, boxes); }

  void frame(std::span<const std::uint32_t> /*changed_rows*/,
             std::span<const Aabb> boxes) override {
    make_room(boxes.size());
    for (int t = 0; t < threads_; ++t) found_.o[t].w = room_of(t);
    if (boxes.size() < 2) return;
    NT = threads_;
    const auto step = [&] {
      sweep_.step(reinterpret_cast<const ::Box*>(boxes.data()), boxes.size(), found_);
    };
    if (arena_ != nullptr) {
      arena_->execute(step);
    } else {
      step();
    }
  }

  [[nodiscard]] std::span<const Pair> pairs() const override {
    const auto of = [&](int t) {
      const u64* const first = room_of(t);
      return std::span(reinterpret_cast<const Pair*>(first),
                       static_cast<std::size_t>(found_.o[t].w - first));
    };
    if (threads_ == 1) return of(0);
    joined_.assign(of(0).begin(), of(0).end());
    joined_.insert(joined_.end(), of(1).begin(), of(1).end());
    return joined_;
  }

  [[nodiscard]] std::size_t bytes() const override {
    const auto held = [](const auto& buffer) { return buffer.cap * sizeof(*buffer.p); };
    std::size_t sum = held(sweep_.R) + held(sweep_.q8) + held(sweep_.st);
    for (int t = 0; t < threads_; ++t) {
      sum += held(sweep_.cnt[t]) + held(sweep_.kk[t]) + held(sweep_.sc[t].id);
      for (int a = 0; a < 3; ++a) sum += held(sweep_.sc[t].lo[a]) + held(sweep_.sc[t].hi[a]);
    }
    return sum;
  }

 private:
  static constexpr int kMaxThreads = 2;  // the prototype has arrays of two

  [[nodiscard]] u64* room_of(int t) const { return reinterpret_cast<u64*>(room_[t]->begin()); }
  void make_room(std::size_t objects) {
    if (objects <= objects_ && room_[0] != nullptr) return;
    objects_ = objects;
    for (int t = 0; t < threads_; ++t) room_[t] = room_for_pairs(objects);
  }

  int threads_;
  std::unique_ptr<tbb::task_arena> arena_;  // used if there are more than kMaxThreads threads
  SG4<true> sweep_;
  Outs found_;  // only the ends of the pairs are used
  std::array<std::unique_ptr<AddressRange>, kMaxThreads> room_;
  std::size_t objects_ = 0;
  mutable std::vector<Pair> joined_;
};

const RegisteredPeer<Yardstick, YardstickEngine> kYardstickEngine;

}  // namespace
}  // namespace winnow::bench
