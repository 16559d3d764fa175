// winnow's engines for pairs of shapes.

#include <winnow/pipeline/impacts.h>
#include <winnow/pipeline/narrow_phase.h>
#include "bench/common/need.h"
#include "bench/contenders/partitions.h"
#include "bench/contenders/winnow_engines.h"

#include <algorithm>
#include <stdexcept>

namespace winnow::bench {
namespace {

class WinnowNarrow final : public NarrowEngine {
 public:
  WinnowNarrow(NarrowTier tier, int threads)
      : options_{.tier = tier, .execution = execution_for(threads)} {}

  [[nodiscard]] std::string name() const override { return std::string(to_text(options_.tier)); }
  [[nodiscard]] bool takes(const PairKind&, ContactLevel) const override { return true; }
  void start(const PairSet& set) override { set_ = &set; }

  void run(ContactLevel level, std::span<const BodyPair> pairs) override {
    options_.level = level;
    pairs_ = pairs;
    need(narrow_.collide(set_->pool, set_->bodies(), pairs, options_, result_), "pairs");
  }

  [[nodiscard]] NarrowAnswer answer(std::size_t i) const override {
    // All pairs of a set are of one kind, so that the result has them in the order of the input.
    if (result_.pair_of(i) != i) throw std::logic_error("pairs of one kind changed their order");
    NarrowAnswer answer;
    answer.overlap = result_.overlaps(i);
    if (options_.level == ContactLevel::boolean) return answer;
    answer.distance = result_.distance()[i];
    answer.error_bound = result_.error_bound()[i];
    answer.normal = {result_.normal(0)[i], result_.normal(1)[i], result_.normal(2)[i]};
    if (options_.level == ContactLevel::distance) {
      const Vec3d point{result_.point(0)[i], result_.point(1)[i], result_.point(2)[i]};
      answer.point = set_->poses[pairs_[i].a].position + point;
    } else {
      answer.contacts = result_.contact_count()[i];
    }
    return answer;
  }

  [[nodiscard]] double recomputed() const override {
    const NarrowStatistics& statistics = narrow_.statistics();
    const auto scalar = static_cast<double>(statistics.recomputed + statistics.without_lanes);
    return scalar / static_cast<double>(std::max<std::uint64_t>(statistics.pairs, 1));
  }

 private:
  NarrowOptions options_;
  const PairSet* set_ = nullptr;
  std::span<const BodyPair> pairs_;
  NarrowPhase narrow_;
  NarrowResult result_;
};

class WinnowOnePair final : public NarrowEngine {
 public:
  explicit WinnowOnePair(NarrowTier tier) : options_{.tier = tier} {}

  [[nodiscard]] std::string name() const override {
    return std::string(to_text(options_.tier)) + ", one a call";
  }
  [[nodiscard]] bool takes(const PairKind&, ContactLevel) const override { return true; }
  void start(const PairSet& set) override { set_ = &set; }

  void run(ContactLevel level, std::span<const BodyPair> pairs) override {
    options_.level = level;
    answers_.resize(std::max(answers_.size(), pairs.size()));
    PairAnswer found;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const BodyPair pair = pairs[i];
      const Pose& a = set_->poses[pair.a];
      need(collide(set_->pool, set_->shapes[pair.a], a, set_->shapes[pair.b], set_->poses[pair.b],
                   options_, found),
           "pair");
      NarrowAnswer& answer = answers_[i];
      answer.overlap = found.overlap;
      if (level == ContactLevel::boolean) continue;
      answer.distance = found.distance;
      answer.error_bound = found.error_bound;
      answer.normal = found.normal;
      if (level == ContactLevel::distance) answer.point = a.position + found.point;
      answer.contacts = found.contact_count;
    }
  }

  [[nodiscard]] NarrowAnswer answer(std::size_t i) const override { return answers_[i]; }

 private:
  NarrowOptions options_;
  const PairSet* set_ = nullptr;
  std::vector<NarrowAnswer> answers_;
};

class WinnowImpacts final : public ImpactEngine {
 public:
  [[nodiscard]] std::string name() const override { return "winnow"; }
  [[nodiscard]] bool takes(const PairKind&, PairTurn) const override { return true; }
  void start(const MovingPairSet& set) override { set_ = &set; }

  void run(std::span<const BodyPair> pairs) override {
    const PairSet& middle = *set_->middle;
    need(time_of_impact(middle.pool, {middle.shapes, set_->motions}, pairs, {}, result_),
         "moving pairs");
  }

  [[nodiscard]] ImpactAnswer answer(std::size_t i) const override {
    return {result_.hits(i), result_.time()[i]};
  }

 private:
  const MovingPairSet* set_ = nullptr;
  ImpactResult result_;
};

}  // namespace

std::unique_ptr<NarrowEngine> make_winnow_narrow(NarrowTier tier, int threads) {
  return std::make_unique<WinnowNarrow>(tier, threads);
}

std::unique_ptr<NarrowEngine> make_winnow_one_pair(NarrowTier tier) {
  return std::make_unique<WinnowOnePair>(tier);
}

std::unique_ptr<ImpactEngine> make_winnow_impacts() {
  return std::make_unique<WinnowImpacts>();
}

}  // namespace winnow::bench
