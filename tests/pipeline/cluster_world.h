#pragma once

#include <winnow/pipeline/cluster.h>

#include <cstdint>
#include <map>
#include <vector>

#include "tests/support/random.h"

namespace winnow::test {

/// A transport that fails from the given call on, like a broken network.
class FailingTransport final : public Transport {
 public:
  FailingTransport(std::uint32_t ranks, int calls) : inner_(ranks), calls_(calls) {}

  [[nodiscard]] std::uint32_t ranks() const noexcept override { return inner_.ranks(); }
  [[nodiscard]] std::uint32_t first_hosted() const noexcept override { return 0; }
  [[nodiscard]] std::uint32_t hosted() const noexcept override { return inner_.ranks(); }
  Status exchange(std::span<const RankMessage> sent, std::span<const RankMessage>& received,
                  const OverlappedWork& meanwhile) override {
    return fails() ? Status::communication_failed : inner_.exchange(sent, received, meanwhile);
  }
  Status reduce(std::span<std::uint64_t> sums, std::span<std::uint64_t> greatest) override {
    return fails() ? Status::communication_failed : inner_.reduce(sums, greatest);
  }
  Status cut(std::span<const CutWork> work, std::span<SplitPlane> cuts) override {
    return fails() ? Status::communication_failed : inner_.cut(work, cuts);
  }

 private:
  bool fails() noexcept { return calls_-- <= 0; }
  LoopbackTransport inner_;
  int calls_;
};

/// A cluster of ranks in this process, and a table of its boxes for brute-force pairs.
class ClusterWorld {
 public:
  explicit ClusterWorld(std::uint32_t ranks, const ClusterOptions& options = {});

  /// Adds each box on a random rank. Names are not in the order of boxes.
  void add(const std::vector<Aabb>& boxes, Random& random);
  /// Moves a share of the bodies by up to `step`, each on its own rank.
  void move(double share, double step, Random& random);
  void remove(std::size_t count, Random& random);
  /// Finds pairs and checks them, their digest, and the rank of each body.
  void check();

  [[nodiscard]] std::vector<NamePair> true_pairs() const;
  [[nodiscard]] std::vector<NamePair> found_pairs() const;
  /// Returns the rank that owns a body.
  [[nodiscard]] std::uint32_t rank_of(BodyName name) const { return placements_.at(name).rank; }
  [[nodiscard]] Key key_of(BodyName name) const { return placements_.at(name).key; }
  [[nodiscard]] const std::map<BodyName, Aabb>& boxes() const { return boxes_; }
  [[nodiscard]] Cluster& cluster() { return cluster_; }

 private:
  struct Placement {
    std::uint32_t rank;
    Key key;
  };
  void follow();

  LoopbackTransport transport_;
  Cluster cluster_;
  std::map<BodyName, Aabb> boxes_;
  std::map<BodyName, Placement> placements_;
  BodyName next_ = 1;
};

/// Computes the digest from its definition.
[[nodiscard]] ClusterDigest digest_of(const std::vector<NamePair>& pairs);

}  // namespace winnow::test
