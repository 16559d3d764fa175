#pragma once

#include "bench/contenders/engines.h"

#include <Eigen/Geometry>
#include <vector>

namespace winnow::bench {

/// Base of narrow-phase adapters: Adapter::pair_function selects a function for one pair by kind
/// and level, and this class calls it for each pair and stores the answers.
template <typename Adapter>
class NarrowAdapter : public NarrowEngine {
 public:
  using PairFunction = void (Adapter::*)(const BodyPair&, NarrowAnswer&);

  [[nodiscard]] bool takes(const PairKind& kind, ContactLevel level) const final {
    return Adapter::pair_function(kind, level) != nullptr;
  }

  void run(ContactLevel level, std::span<const BodyPair> pairs) final {
    answers_.resize(pairs.size());
    level_ = level;
    const PairFunction one = Adapter::pair_function(kind_, level);
    auto& adapter = static_cast<Adapter&>(*this);
    for (std::size_t i = 0; i < pairs.size(); ++i) (adapter.*one)(pairs[i], answers_[i]);
  }

  [[nodiscard]] NarrowAnswer answer(std::size_t i) const final { return answers_[i]; }

 protected:
  void set_kind(const PairKind& kind) { kind_ = kind; }
  /// True if the current run computes only verdicts.
  [[nodiscard]] bool only_verdicts() const { return level_ == ContactLevel::boolean; }

 private:
  PairKind kind_;
  ContactLevel level_{};
  std::vector<NarrowAnswer> answers_;
};

/// Base of adapters for times of impact, which computes each pair by Adapter::impact and stores the
/// answers.
template <typename Adapter>
class ImpactAdapter : public ImpactEngine {
 public:
  void run(std::span<const BodyPair> pairs) final {
    answers_.resize(pairs.size());
    auto& adapter = static_cast<Adapter&>(*this);
    for (std::size_t i = 0; i < pairs.size(); ++i) answers_[i] = adapter.impact(pairs[i]);
  }

  [[nodiscard]] ImpactAnswer answer(std::size_t i) const final { return answers_[i]; }

 private:
  std::vector<ImpactAnswer> answers_;
};

[[nodiscard]] inline Eigen::Quaterniond orientation_of(const Pose& pose) {
  const Eigen::Quaterniond orientation = pose.orientation;
  return orientation.normalized();
}

}  // namespace winnow::bench
