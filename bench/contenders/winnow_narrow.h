#pragma once

#include <winnow/pipeline/narrow_phase.h>
#include "bench/contenders/narrow_engine.h"

#include <cstdint>
#include <string>
#include <vector>

namespace winnow::bench {

/// winnow's NarrowPhase in one tier; its name is the tier's.
class WinnowNarrow final : public NarrowEngine {
 public:
  WinnowNarrow(NarrowTier tier, int threads);

  [[nodiscard]] std::string name() const override { return std::string(to_text(options_.tier)); }
  [[nodiscard]] bool takes(const PairKind&, ContactLevel) const override { return true; }
  void start(const PairSet& set) override { set_ = &set; }
  /// Throws std::runtime_error if winnow returns an error.
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

/// winnow's function for one pair, in one tier, called once per pair.
class WinnowOnePair final : public NarrowEngine {
 public:
  explicit WinnowOnePair(NarrowTier tier) : options_{.tier = tier} {}

  [[nodiscard]] std::string name() const override {
    return std::string(to_text(options_.tier)) + ", one a call";
  }
  [[nodiscard]] bool takes(const PairKind&, ContactLevel) const override { return true; }
  void start(const PairSet& set) override { set_ = &set; }
  /// Throws std::runtime_error if winnow returns an error for a pair.
  void run(ContactLevel level, std::span<const BodyPair> pairs) override;
  [[nodiscard]] NarrowAnswer answer(std::size_t i) const override { return answers_[i]; }

 private:
  NarrowOptions options_;
  const PairSet* set_ = nullptr;
  std::vector<NarrowAnswer> answers_;
};

}  // namespace winnow::bench
