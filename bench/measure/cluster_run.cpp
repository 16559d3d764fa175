// Runs a recording or scene on the ranks of a cluster, as pairs of boxes (BoxCluster) or contacts
// of bodies (BodyCluster). commands/cluster.cpp and bench/rows/cluster_rows.cpp call `run_cluster`.

#include "bench/measure/cluster_run.h"

#include <winnow/pipeline/cluster_scene.h>
#include <winnow/pipeline/shape_pool.h>
#include "bench/common/need.h"
#include "bench/common/random.h"
#include "bench/common/sample.h"

#include <algorithm>
#include <cstring>
#include <unordered_set>

namespace winnow::bench {
namespace {

/// Adds batches; returns the first error of any of them.
template <typename Batch, typename Ranks>
Status add_all(const std::vector<Batch>& batches, Ranks& ranks) {
  std::vector<Status> answers(batches.size());
  const Status status = ranks.add(batches, answers);
  if (status != Status::ok) return status;
  const auto refused = std::ranges::find_if(answers, [](Status s) { return s != Status::ok; });
  return refused == answers.end() ? Status::ok : *refused;
}

/// A cluster of boxes.
struct BoxCluster {
  BoxCluster(Transport& transport, const Execution& execution)
      : cluster(transport, {.execution = execution}) {}

  void see(std::span<const Aabb>) const noexcept {}
  Status add(std::span<const std::vector<BodyName>> names,
             std::span<const std::vector<Aabb>> boxes) {
    std::vector<ClusterBatch> batches;
    for (std::size_t r = 0; r < names.size(); ++r) batches.push_back({names[r], boxes[r]});
    return add_all(batches, cluster);
  }
  Status move(std::uint32_t rank, std::span<const Key> keys, std::span<const Aabb> boxes) {
    return cluster.move(rank, keys, boxes);
  }
  Status find() { return cluster.self_pairs(); }
  template <typename Take>
  void each_pair(std::uint32_t rank, Take&& take) const {
    for (const NamePair pair : cluster.pairs(rank)) take(pair.first, pair.second);
  }

  Cluster cluster;
};

/// A cluster of bodies.
struct BodyCluster {
  BodyCluster(Transport& transport, const Execution& execution, ContactLevel contact_level)
      : cluster(transport, pool, {.scene = {.execution = execution}}), level(contact_level) {}

  /// Adds the shapes of new bodies. Every process adds all of them, in the order of rows.
  void see(std::span<const Aabb> boxes) {
    for (std::size_t i = shapes.size(); i < boxes.size(); ++i) {
      shapes.push_back(need(pool.add(box_shape_of(boxes[i])), "shape"));
    }
  }

  Status add(std::span<const std::vector<BodyName>> names,
             std::span<const std::vector<Aabb>> boxes) {
    std::vector<std::vector<BodyDefinition>> bodies(names.size());
    std::vector<ClusterSceneBatch> batches;
    for (std::size_t r = 0; r < names.size(); ++r) {
      for (std::size_t i = 0; i < names[r].size(); ++i) {
        bodies[r].push_back({.shape = shapes[names[r][i]], .pose = middle_of(boxes[r][i])});
      }
      batches.push_back({names[r], bodies[r]});
    }
    return add_all(batches, cluster);
  }
  Status move(std::uint32_t rank, std::span<const Key> keys, std::span<const Aabb> boxes) {
    poses.clear();
    for (const Aabb& box : boxes) poses.push_back(middle_of(box));
    return cluster.move(rank, keys, poses);
  }
  Status find() { return cluster.collide(level); }
  template <typename Take>
  void each_pair(std::uint32_t rank, Take&& take) const {
    const Contacts& contacts = cluster.contacts(rank);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const auto [first, second] = std::minmax(contacts.data_a()[i], contacts.data_b()[i]);
      take(first, second);
    }
  }

  ShapePool pool;
  std::vector<ShapeId> shapes;  // by row
  std::vector<Pose> poses;
  ClusterScene cluster;
  ContactLevel level;
};

/// Runs frames of a scene on the ranks of this process.
template <typename Ranks>
class ClusterEngine {
 public:
  ClusterEngine(Transport& transport, Ranks& ranks)
      : transport_(transport),
        ranks_(ranks),
        cluster_(ranks.cluster),
        bodies_(cluster_.hosted()),
        keys_(cluster_.hosted()),
        boxes_(cluster_.hosted()),
        fresh_(cluster_.hosted()),
        fresh_boxes_(cluster_.hosted()) {}

  void show(std::span<const Aabb> boxes, ClusterRun& run) {
    find_changes(boxes);
    ranks_.see(boxes);
    synchronize();
    const Stopwatch clock;
    apply_changes();
    const double update_ms = clock.ms();
    need(ranks_.find(), "pairs");
    const double frame_ms = clock.ms();
    follow();
    summarize_into(run, frame_ms, update_ms);
  }

  std::uint64_t bytes() {
    std::uint64_t sum = cluster_.bytes().reserved;
    need(transport_.reduce(std::span(&sum, 1), {}), "bytes");
    return sum;
  }

 private:
  [[nodiscard]] std::uint32_t rank_of(std::size_t place) const {
    return cluster_.first_hosted() + static_cast<std::uint32_t>(place);
  }

  void find_changes(std::span<const Aabb> boxes) {
    for (std::size_t r = 0; r < keys_.size(); ++r) {
      keys_[r].clear();
      boxes_[r].clear();
      fresh_[r].clear();
      fresh_boxes_[r].clear();
    }
    for (std::size_t r = 0; r < bodies_.size(); ++r) {
      for (const ClusterBody& body : bodies_[r]) {
        const BodyName i = body.name;
        if (std::memcmp(&boxes[i], &last_[i], sizeof(Aabb)) == 0) continue;
        keys_[r].push_back(body.key);
        boxes_[r].push_back(boxes[i]);
      }
    }
    for (std::size_t i = last_.size(); i < boxes.size(); ++i) {
      const std::size_t place = i * cluster_.ranks() / boxes.size() - cluster_.first_hosted();
      if (place >= fresh_.size()) continue;
      fresh_[place].push_back(i);
      fresh_boxes_[place].push_back(boxes[i]);
    }
    grows_ = boxes.size() > last_.size();
    last_.assign(boxes.begin(), boxes.end());
  }

  /// Starts the frame on all processes at the same time.
  void synchronize() {
    std::uint64_t nothing = 0;
    need(transport_.reduce(std::span(&nothing, 1), {}), "start of a frame");
  }

  void apply_changes() {
    for (std::size_t r = 0; r < keys_.size(); ++r) {
      if (keys_[r].empty()) continue;
      need(ranks_.move(rank_of(r), keys_[r], boxes_[r]), "move");
    }
    if (grows_) need(ranks_.add(fresh_, fresh_boxes_), "add");
  }

  /// Updates the list of each rank's own bodies, sorted by key: moves are fastest in that order.
  void follow() {
    for (std::size_t r = 0; r < bodies_.size(); ++r) {
      std::vector<ClusterBody>& bodies = bodies_[r];
      const std::span<const BodyName> departed = cluster_.departed(rank_of(r));
      const std::span<const ClusterBody> arrived = cluster_.arrived(rank_of(r));
      if (departed.empty() && arrived.empty()) continue;
      const std::unordered_set<BodyName> gone(departed.begin(), departed.end());
      if (!gone.empty()) {
        std::erase_if(bodies, [&](const ClusterBody& body) { return gone.contains(body.name); });
      }
      const auto id_of = [](const ClusterBody& body) { return body.key.id; };
      const auto fresh = bodies.insert(bodies.end(), arrived.begin(), arrived.end());
      std::ranges::sort(fresh, bodies.end(), {}, id_of);
      std::ranges::inplace_merge(bodies, fresh, {}, id_of);
    }
  }

  void summarize_into(ClusterRun& run, double frame_ms, double update_ms) {
    const ClusterStatistics& statistics = run.statistics.emplace_back(cluster_.statistics());
    std::uint64_t fingerprint = 0;
    for (std::size_t r = 0; r < keys_.size(); ++r) {
      ranks_.each_pair(rank_of(r), [&](BodyName first, BodyName second) {
        fingerprint += mix((first << 32U) | second);
      });
    }
    constexpr double kNanoseconds = 1e6;
    std::uint64_t times[2] = {static_cast<std::uint64_t>(frame_ms * kNanoseconds),
                              static_cast<std::uint64_t>(update_ms * kNanoseconds)};
    need(transport_.reduce(std::span(&fingerprint, 1), times), "fingerprint");
    run.pairs.push_back({statistics.pairs, statistics.pairs, fingerprint});
    run.frame_ms.push_back(static_cast<double>(times[0]) / kNanoseconds);
    run.update_ms.push_back(static_cast<double>(times[1]) / kNanoseconds);
    run.digests.push_back(need(cluster_.digest(), "digest"));
  }

  Transport& transport_;
  Ranks& ranks_;
  decltype(Ranks::cluster)& cluster_;
  std::vector<std::vector<ClusterBody>> bodies_;  // of each hosted rank
  // The input of a frame for each hosted rank.
  std::vector<std::vector<Key>> keys_;
  std::vector<std::vector<Aabb>> boxes_;
  std::vector<std::vector<BodyName>> fresh_;
  std::vector<std::vector<Aabb>> fresh_boxes_;
  std::vector<Aabb> last_;
  bool grows_ = false;
};

template <typename Ranks>
ClusterRun run_ranks(FrameSource& source, Transport& transport, std::size_t frames, Ranks& ranks) {
  ClusterRun run;
  run.engine = "LinearBvh";
  run.isa = active_isa();
  run.ranks = transport.ranks();
  ClusterEngine<Ranks> engine(transport, ranks);
  do {
    engine.show(source.boxes(), run);
  } while (run.frame_ms.size() < frames && source.advance());
  run.bytes = engine.bytes();
  return run;
}

}  // namespace

BoxShape box_shape_of(const Aabb& box) noexcept {
  return {0.5 * (box.max.cast<double>() - box.min.cast<double>())};
}

Pose middle_of(const Aabb& box) noexcept {
  return Pose::at(0.5 * (box.max.cast<double>() + box.min.cast<double>()));
}

ClusterRun run_cluster(FrameSource& source, Transport& transport, const ClusterRunOptions& order,
                       const Execution& execution) {
  if (order.level.has_value()) {
    BodyCluster ranks(transport, execution, *order.level);
    return run_ranks(source, transport, order.frames, ranks);
  }
  BoxCluster ranks(transport, execution);
  return run_ranks(source, transport, order.frames, ranks);
}

}  // namespace winnow::bench
