#pragma once

#include <winnow/pipeline/narrow_phase.h>
#include "bench/contenders/narrow_engine.h"

#include <cstdint>
#include <string>
#include <vector>

namespace winnow::bench {

/// winnow's NarrowPhase in one tier, named after it.
class WinnowNarrow final : public NarrowEngine {
 public:
  WinnowNarrow(NarrowTier tier, int threads);

  [[nodiscard]] std::string name() const override { return std::string(to_text(options_.tier)); }
  [[nodiscard]] bool takes(const PairKind&, ContactLevel) const override { return true; }
  void start(const PairSet& set) override { set_ = &set; }
  /// Throws std::runtime_error if the pairs are refused.
  void run(ContactLevel level, std::span<const BodyPair> pairs) override;
  [[nodiscard]] NarrowAnswer answer(std::size_t i) const override;
  [[nodiscard]] double recomputed() const override;

 private:
  NarrowOptions options_;
  const PairSet* set_ = nullptr;
  std::span<const BodyPair> pairs_;
  NarrowPhase narrow_;
  NarrowResult result_;
};

/// winnow's function for one pair, in one tier, called for each.
class WinnowOnePair final : public NarrowEngine {
 public:
  explicit WinnowOnePair(NarrowTier tier) : options_{.tier = tier} {}

  [[nodiscard]] std::string name() const override {
    return std::string(to_text(options_.tier)) + ", one a call";
  }
  [[nodiscard]] bool takes(const PairKind&, ContactLevel) const override { return true; }
  void start(const PairSet& set) override { set_ = &set; }
  /// Throws std::runtime_error if a pair is refused.
  void run(ContactLevel level, std::span<const BodyPair> pairs) override;
  [[nodiscard]] NarrowAnswer answer(std::size_t i) const override { return answers_[i]; }

 private:
  NarrowOptions options_;
  const PairSet* set_ = nullptr;
  std::vector<NarrowAnswer> answers_;
};

}  // namespace winnow::bench
