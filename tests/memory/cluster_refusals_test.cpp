// Refuses each memory request of clusters in turn. A refusal either ends the cluster, after which
// every call returns the error, or has no lasting effect.

#include <winnow/pipeline/cluster_scene.h>
#include <winnow/winnow.h>

#include <functional>
#include <vector>

#include "tests/memory/refusals.h"

namespace winnow::test {
namespace {

constexpr std::uint32_t kRanks = 3;

const ShapePool& balls_and_boxes() {
  static const auto pool = [] {
    auto made = std::make_unique<ShapePool>();
    EXPECT_EQ(made->add(SphereShape{0.6}).bits, ShapeId::of(ShapeKind::sphere, 0).bits);
    EXPECT_EQ(made->add(BoxShape{{0.5, 0.6, 0.4}}).bits, ShapeId::of(ShapeKind::box, 0).bits);
    return made;
  }();
  return *pool;
}

/// A cluster with bodies on three ranks, which move once.
class ClusterPlay {
 public:
  explicit ClusterPlay(std::pmr::memory_resource* memory)
      : transport_(kRanks),
        cluster_(transport_, balls_and_boxes(),
                 {.scene = {.memory = memory, .execution = Execution::serial()}}) {
    Random random(12);
    for (std::uint32_t rank = 0; rank < kRanks; ++rank) {
      for (std::uint32_t i = 0; i < 12; ++i) {
        names_[rank].push_back(100 * rank + i);
        const ShapeKind kind = i % 2 == 0 ? ShapeKind::sphere : ShapeKind::box;
        bodies_[rank].push_back(
            {.shape = ShapeId::of(kind, 0),
             .pose = Pose::at(random.uniform(0, 4), random.uniform(0, 4), random.uniform(0, 2))});
      }
    }
  }

  /// Returns the digest of all contacts, or zeros if the cluster ended. Repeats refused calls.
  ClusterDigest run() {
    call([&] { return add(); });
    call([&] { return cluster_.collide(ContactLevel::manifold); });
    call([&] { return move(); });
    call([&] { return cluster_.collide(ContactLevel::manifold); });
    ClusterDigest digest;
    call([&] { return cluster_.digest().get(digest); });
    return cluster_.status() == Status::ok ? digest : ClusterDigest{};
  }
  [[nodiscard]] Status status() const { return cluster_.status(); }

 private:
  void call(const std::function<Status()>& what) {
    const bool had_ended = cluster_.status() != Status::ok;
    Status status = what();
    EXPECT_TRUE(status == Status::ok || status == Status::out_of_memory) << to_string(status);
    if (had_ended) {
      EXPECT_EQ(status, cluster_.status());
    }
    if (status != Status::ok && cluster_.status() == Status::ok) status = what();
    if (cluster_.status() == Status::ok) {
      EXPECT_EQ(status, Status::ok);
    }
  }
  Status add() {
    std::vector<ClusterSceneBatch> batches(kRanks);
    for (std::uint32_t rank = 0; rank < kRanks; ++rank) {
      if (added_[rank]) continue;
      batches[rank] = {names_[rank], bodies_[rank]};
    }
    std::vector<Status> answers(kRanks, Status::ok);
    const Status status = cluster_.add(batches, answers);
    for (std::uint32_t rank = 0; rank < kRanks; ++rank) {
      added_[rank] = added_[rank] || (status == Status::ok && answers[rank] == Status::ok);
      if (status == Status::ok && answers[rank] != Status::ok) return answers[rank];
    }
    return status;
  }
  Status move() {
    for (; moved_ < kRanks; ++moved_) {
      std::vector<ClusterBody> there(cluster_.size(moved_));
      Status status = cluster_.bodies(moved_, there);
      std::vector<BodyName> names;
      std::vector<Pose> poses;
      for (const ClusterBody& body : there) {
        names.push_back(body.name);
        const double x = static_cast<double>(body.name % 7);
        poses.push_back(Pose::at(x, 0.5 * static_cast<double>(body.name % 5), 0.1 * x));
      }
      if (status == Status::ok) status = cluster_.move(moved_, names, poses);
      if (status != Status::ok) return status;
    }
    return Status::ok;
  }

  LoopbackTransport transport_;
  ClusterScene cluster_;
  std::vector<BodyName> names_[kRanks];
  std::vector<BodyDefinition> bodies_[kRanks];
  bool added_[kRanks] = {};
  std::uint32_t moved_ = 0;
};

TEST(ClusterRefusals, refused_memory_ends_cluster_or_changes_nothing) {
  CountingMemory plenty;
  const ClusterDigest truth = ClusterPlay(&plenty).run();
  EXPECT_FALSE(truth == ClusterDigest{});
  for (const bool once : {true, false}) {
    std::size_t k = 0;
    for (bool refused = true; refused; ++k) {
      CountingMemory memory;
      once ? memory.refuse_one_after(k) : memory.refuse_after(k);
      {
        ClusterPlay play(&memory);
        const ClusterDigest digest = play.run();
        if (play.status() == Status::ok) {
          EXPECT_TRUE(digest == truth);
        }
      }
      EXPECT_EQ(memory.outstanding(), 0U);
      refused = memory.refusals() != 0;
      ASSERT_FALSE(HasFailure()) << "request " << k << (once ? " only" : " and all later ones");
    }
    EXPECT_GT(k, 50U);
  }
}

}  // namespace
}  // namespace winnow::test
