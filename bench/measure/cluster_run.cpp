#include "bench/measure/cluster_run.h"

#include "bench/common/random.h"
#include "bench/common/sample.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>

namespace winnow::bench {
namespace {

void require_ok(Status status, const char* what) {
  if (status != Status::ok) {
    throw std::runtime_error(std::string("cluster: ") + what + ": " + to_string(status));
  }
}

/// A scene as the ranks of this process see it.
class ClusterEngine {
 public:
  ClusterEngine(Transport& transport, const Execution& execution)
      : transport_(transport),
        cluster_(transport, {.execution = execution}),
        told_(cluster_.hosted()) {}

  ClusterFrame show(std::span<const Aabb> boxes) {
    find_changes(boxes);
    synchronize();
    const Stopwatch clock;
    tell();
    ClusterFrame frame;
    frame.update_ms = clock.ms();
    require_ok(cluster_.self_pairs(), "self_pairs");
    frame.frame_ms = clock.ms();
    follow();
    summarize_into(frame);
    return frame;
  }

  std::uint64_t bytes() {
    std::uint64_t sum = cluster_.bytes().reserved;
    require_ok(transport_.reduce(std::span(&sum, 1), {}), "bytes");
    return sum;
  }

 private:
  struct Home {
    std::uint32_t rank = kElsewhere;
    Key key;
  };
  /// What a rank is told of a frame.
  struct Told {
    std::vector<Key> keys;
    std::vector<Aabb> boxes;
    std::vector<BodyName> fresh;
    std::vector<Aabb> fresh_boxes;
  };
  static constexpr std::uint32_t kElsewhere = ~0U;

  void find_changes(std::span<const Aabb> boxes) {
    for (Told& told : told_) told = {};
    for (std::size_t i = 0; i < last_.size(); ++i) {
      if (homes_[i].rank == kElsewhere || std::memcmp(&boxes[i], &last_[i], sizeof(Aabb)) == 0) {
        continue;
      }
      Told& told = told_[homes_[i].rank - cluster_.first_hosted()];
      told.keys.push_back(homes_[i].key);
      told.boxes.push_back(boxes[i]);
    }
    for (std::size_t i = last_.size(); i < boxes.size(); ++i) {
      const std::size_t rank = i * cluster_.ranks() / boxes.size() - cluster_.first_hosted();
      if (rank >= told_.size()) continue;
      told_[rank].fresh.push_back(i);
      told_[rank].fresh_boxes.push_back(boxes[i]);
    }
    grows_ = boxes.size() > last_.size();
    last_.assign(boxes.begin(), boxes.end());
    homes_.resize(boxes.size());
  }

  /// No process begins before all others are there.
  void synchronize() {
    std::uint64_t nothing = 0;
    require_ok(transport_.reduce(std::span(&nothing, 1), {}), "start of a frame");
  }

  void tell() {
    for (std::uint32_t r = 0; r < told_.size(); ++r) {
      if (told_[r].keys.empty()) continue;
      require_ok(cluster_.move(cluster_.first_hosted() + r, told_[r].keys, told_[r].boxes), "move");
    }
    if (!grows_) return;
    std::vector<ClusterBatch> batches;
    for (const Told& told : told_) batches.push_back({told.fresh, told.fresh_boxes});
    std::vector<Status> answers(batches.size());
    require_ok(cluster_.add(batches, answers), "add");
    for (const Status answer : answers) require_ok(answer, "add");
  }

  void follow() {
    for (std::uint32_t r = 0; r < told_.size(); ++r) {
      for (const BodyName name : cluster_.departed(cluster_.first_hosted() + r)) {
        homes_[name].rank = kElsewhere;
      }
    }
    for (std::uint32_t r = 0; r < told_.size(); ++r) {
      const std::uint32_t rank = cluster_.first_hosted() + r;
      for (const ClusterBody& body : cluster_.arrived(rank)) homes_[body.name] = {rank, body.key};
    }
  }

  void summarize_into(ClusterFrame& frame) {
    frame.statistics = cluster_.statistics();
    frame.pairs.reported = frame.pairs.pairs = frame.statistics.pairs;
    std::uint64_t fingerprint = 0;
    for (std::uint32_t r = 0; r < told_.size(); ++r) {
      for (const NamePair& pair : cluster_.pairs(cluster_.first_hosted() + r)) {
        fingerprint += mix((pair.first << 32U) | pair.second);
      }
    }
    constexpr double kNanoseconds = 1e6;
    std::uint64_t times[2] = {static_cast<std::uint64_t>(frame.frame_ms * kNanoseconds),
                              static_cast<std::uint64_t>(frame.update_ms * kNanoseconds)};
    require_ok(transport_.reduce(std::span(&fingerprint, 1), times), "fingerprint");
    frame.pairs.fingerprint = fingerprint;
    frame.frame_ms = static_cast<double>(times[0]) / kNanoseconds;
    frame.update_ms = static_cast<double>(times[1]) / kNanoseconds;
    require_ok(cluster_.digest(frame.digest), "digest");
  }

  Transport& transport_;
  Cluster cluster_;
  std::vector<Told> told_;  // by hosted rank
  std::vector<Aabb> last_;
  std::vector<Home> homes_;  // by row
  bool grows_ = false;
};

}  // namespace

double ClusterRun::median_ms() const {
  const std::vector<double> ms = each([](const ClusterFrame& frame) { return frame.frame_ms; });
  return median_of(std::span(ms).subspan(ms.size() > 1 ? 1 : 0));
}

ClusterRun run_cluster(FrameSource& source, Transport& transport, std::size_t frames,
                       const Execution& execution) {
  ClusterRun run;
  run.ranks = transport.ranks();
  ClusterEngine engine(transport, execution);
  do {
    run.frames.push_back(engine.show(source.boxes()));
  } while (run.frames.size() < frames && source.advance());
  run.bytes = engine.bytes();
  return run;
}

}  // namespace winnow::bench
