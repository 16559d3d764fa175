// Soak test of a partition: plays random frames on a partition, on a copy loaded from its snapshot,
// and on a model, and compares them. Called by soak.cpp for each structure.

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

#include "tests/soak/soak.h"
#include "tests/support/config.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

class PartitionSoak {
 public:
  PartitionSoak(const StructureKind& structure, const SoakPlan& plan);

  SoakTally run();

 private:
  void begin_lap();
  /// Plans the changes of a frame, which are then made on the partition and on its model.
  void plan_frame(std::uint64_t frame);
  void come();
  void go();
  void move_some();
  void refilter();
  void apply_frame();
  void apply_frame(Partition& partition, bool is_followed);
  void query_pairs();
  void check();
  void check_boxes();
  void save();
  void follow();
  [[nodiscard]] std::size_t held() const;
  [[nodiscard]] Aabb some_box();
  [[nodiscard]] bool has_left(const Aabb& box) const;

  SoakPlan plan_;
  SoakTally tally_;
  CountingMemory memory_;
  CountingMemory saved_memory_;  // for snapshots
  std::size_t most_;
  std::size_t most_at_once_;  // that arrive or leave
  double side_;
  Random random_;
  Threads threads_;
  Partition partition_;
  Partition loaded_;
  PairBuffer pairs_{&memory_};
  PairBuffer loaded_pairs_{&saved_memory_};
  PairEvents events_{&memory_};
  Column<std::byte> saved_{&saved_memory_};
  std::uint64_t followed_ = 0;  // remaining frames in which the loaded copy is compared

  std::vector<Object> model_;  // dense, in no order
  std::set<Pair> active_;      // pairs that are active by the events
  Motion motion_ = Motion::little;
  double target_size_ = 0.0;  // number of objects

  // Changes of the current frame.
  std::vector<ObjectId> gone_;
  std::vector<Aabb> come_;
  std::vector<std::size_t> moved_;
  std::vector<std::size_t> refiltered_;
  std::vector<Key> keys_;
  std::vector<Aabb> boxes_;
  FrameTimes times_{plan_.threads};
};

Config config_of(const StructureKind& structure, int threads) {
  return {std::string(structure.name()), active_isa(), threads};
}

PartitionSoak::PartitionSoak(const StructureKind& structure, const SoakPlan& plan)
    : plan_(plan),
      most_(structure == n_squared() || structure == bounds_n_squared() ? plan.objects / 4
                                                                        : plan.objects),
      most_at_once_(std::max<std::size_t>(4, most_ / 64)),
      side_(std::cbrt(2.0 * static_cast<double>(most_))),
      random_(plan.seed),
      threads_(plan.threads),
      partition_(config_of(structure, plan.threads).make(&memory_)),
      loaded_(config_of(structure, plan.threads).make(&saved_memory_)) {
  tally_.name = structure.name();
  require(partition_.reserve(most_) == Status::ok, "reserve was refused");
  require(partition_.reserve_pairs(pairs_, most_ * 16) == Status::ok, "pairs were refused");
  require(partition_.reserve_events(events_, most_ * 16) == Status::ok, "events were refused");
}

Aabb PartitionSoak::some_box() {
  Aabb box;
  const double edge = random_.chance(0.02) ? 0.5 * side_ : random_.log_uniform(0.5, 2.0);
  for (int axis = 0; axis < 3; ++axis) {
    // Multiples of a quarter, so that some boxes touch exactly.
    box.min[axis] = static_cast<float>(0.25 * std::floor(random_.uniform(0.0, 4.0 * side_)));
    box.max[axis] = box.min[axis] + static_cast<float>(edge);
  }
  return box;
}

/// Returns true if the box has left the world or has grown too large.
bool PartitionSoak::has_left(const Aabb& box) const {
  for (int axis = 0; axis < 3; ++axis) {
    const double least = static_cast<double>(box.min[axis]);
    const double most = static_cast<double>(box.max[axis]);
    if (least < -side_ || most > 2.0 * side_ || most - least > side_) return true;
  }
  return false;
}

void PartitionSoak::come() {
  const auto target = static_cast<std::size_t>(target_size_);
  const std::size_t count = std::min(most_ - model_.size(), 1 + random_.below(most_at_once_));
  if (model_.size() > target) return;
  for (std::size_t i = 0; i < count; ++i) come_.push_back(some_box());
}

void PartitionSoak::go() {
  // Sometimes all objects at once.
  const std::size_t count = random_.chance(2e-4) ? model_.size() : 1 + random_.below(most_at_once_);
  for (std::size_t i = 0; i < count && !model_.empty(); ++i) {
    const std::size_t place = random_.below(model_.size());
    gone_.push_back(model_[place].id);
    model_[place] = model_.back();
    model_.pop_back();
  }
}

void PartitionSoak::move_some() {
  boxes_.clear();
  for (const Object& object : model_) boxes_.push_back(object.box);
  if (boxes_.size() < 2) return;
  moved_ = move(motion_, boxes_, random_);
  for (const std::size_t i : moved_) {
    if (has_left(boxes_[i])) boxes_[i] = some_box();
    model_[i].box = boxes_[i];
  }
}

void PartitionSoak::refilter() {
  if (model_.empty() || !random_.chance(0.1)) return;
  const std::size_t place = random_.below(model_.size());
  ObjectFilter& filter = model_[place].filter;
  filter = ObjectFilter{};
  if (random_.chance(0.3)) filter = {1U << random_.below(3), random_.chance(0.5) ? 3U : 5U, 0};
  if (random_.chance(0.1)) filter.environment = 1 + static_cast<unsigned>(random_.below(2));
  refiltered_.push_back(place);
}

void PartitionSoak::begin_lap() {
  partition_.clear();
  model_.clear();
  active_.clear();
  events_.clear();
  followed_ = 0;
  random_ = Random(plan_.seed);
}

void PartitionSoak::plan_frame(std::uint64_t frame) {
  gone_.clear();
  come_.clear();
  moved_.clear();
  refiltered_.clear();
  if (frame % 64 == 0) {
    motion_ = kMotions[random_.below(kMotions.size())];
    target_size_ = random_.uniform(0.0, static_cast<double>(most_));
  }
  if (static_cast<double>(model_.size()) > target_size_) go();
  move_some();
  refilter();
  come();
}

/// Makes the calls of a frame on the original or on the loaded copy, whose keys differ.
void PartitionSoak::apply_frame(Partition& partition, bool is_followed) {
  keys_.clear();
  for (const ObjectId id : gone_) keys_.push_back(partition.key_of(id));
  require(partition.remove(keys_) == Status::ok, "remove was refused");
  keys_.clear();
  boxes_.clear();
  for (const std::size_t i : moved_) {
    keys_.push_back(partition.key_of(model_[i].id));
    boxes_.push_back(model_[i].box);
  }
  require(partition.update(keys_, boxes_) == Status::ok, "update was refused");
  for (const std::size_t i : refiltered_) {
    require(partition.set_filter(partition.key_of(model_[i].id), model_[i].filter) == Status::ok,
            "set_filter was refused");
  }
  keys_.resize(come_.size());
  require(partition.insert(come_, {}, keys_) == Status::ok, "insert was refused");
  for (std::size_t i = 0; i < come_.size() && is_followed; ++i) {
    require(keys_[i].id == model_[model_.size() - come_.size() + i].id,
            "the loaded partition gives another id");
  }
}

void PartitionSoak::apply_frame() {
  times_.begin();
  threads_.run([&] { apply_frame(partition_, false); });
  query_pairs();
  times_.end();
  for (std::size_t i = 0; i < come_.size(); ++i) model_.push_back({keys_[i].id, come_[i], {}});
  tally_.operations +=
      gone_.size() + moved_.size() + refiltered_.size() + come_.size() + 1 /* the query */;
  for (const KeyPair& pair : events_.ended()) {
    require(active_.erase({pair.first.id, pair.second.id}) == 1, "a pair ended that had not begun");
  }
  for (const KeyPair& pair : events_.begun()) {
    require(active_.insert({pair.first.id, pair.second.id}).second, "a pair began twice");
  }
}

void PartitionSoak::query_pairs() {
  const Status status = threads_.run([&] { return partition_.self_pairs(pairs_, events_); });
  require(status == Status::ok, "self_pairs was refused");
}

void PartitionSoak::check() {
  const std::vector<Pair> truth = true_pairs(model_);
  const auto right = right_pairs(pairs_.pairs(), truth, partition_.is_exact());
  require(right, right.message());
  require(active_.size() == pairs_.size() &&
              std::all_of(pairs_.begin(), pairs_.end(),
                          [&](const Pair& pair) { return active_.contains(pair); }),
          "events and pairs differ");
  require(partition_.size() == model_.size(), "another number of objects");
  check_boxes();
  tally_.comparisons += model_.size() * (model_.size() - 1) / 2;
  ++tally_.checks;
}

/// Compares the content of the partitions and the overlaps with a box.
void PartitionSoak::check_boxes() {
  const Aabb query_box = some_box();
  PairBuffer found;
  require(partition_.overlap(BoxView(std::span(&query_box, 1)), found, {}, Order::canonical) ==
              Status::ok,
          "a box was refused");
  std::vector<ObjectId> truth;
  for (const Object& object : model_) {
    Aabb stored;
    require(partition_.bounds(partition_.key_of(object.id)).get(stored) == Status::ok &&
                stored == object.box,
            "another box");
    if (object.box.overlaps(query_box)) truth.push_back(object.id);
  }
  std::sort(truth.begin(), truth.end());
  require(std::ranges::equal(found, truth, {}, &Pair::second), "a box has other overlaps");
  tally_.comparisons += model_.size();
  ++tally_.operations;
}

void PartitionSoak::save() {
  saved_.clear();
  require(partition_.save(saved_) == Status::ok, "save was refused");
  require(loaded_.load({saved_.data(), saved_.size()}) == Status::ok, "load was refused");
  followed_ = plan_.follow_frames;
}

void PartitionSoak::follow() {
  threads_.run([&] { apply_frame(loaded_, true); });
  const auto query_canonical = [&](Partition& partition) {
    return threads_.run(
        [&] { return partition.self_pairs(loaded_pairs_, {.order = Order::canonical}); });
  };
  require(query_canonical(loaded_) == Status::ok, "self_pairs was refused");
  std::vector<Pair> mine(pairs_.begin(), pairs_.end());
  std::sort(mine.begin(), mine.end());
  require(std::ranges::equal(mine, loaded_pairs_), "the loaded partition finds other pairs");
  if (--followed_ == 0) ++tally_.snapshots;
}

std::size_t PartitionSoak::held() const {
  std::size_t bytes = saved_.bytes().reserved;
  for (const Partition* one : {&partition_, &loaded_}) bytes += one->footprint().total().reserved;
  for (const PairBuffer* one : {&pairs_, &loaded_pairs_}) {
    bytes += one->footprint().total().reserved;
  }
  return bytes + events_.footprint().total().reserved;
}

SoakTally PartitionSoak::run() {
  MemoryWatch watch(tally_, memory_, saved_memory_, plan_.frames);
  for (std::uint64_t frame = 0; frame < plan_.frames; ++frame) {
    if (plan_.lap != 0 && frame % plan_.lap == 0) begin_lap();
    plan_frame(frame);
    apply_frame();
    if (followed_ != 0) {
      follow();
    } else if (frame % plan_.save_every == plan_.save_every / 2) {
      save();
    }
    if (frame % plan_.check_every == 0) check();
    watch.look(frame, held());
    ++tally_.frames;
  }
  tally_.median_us = times_.quantile(0.5);
  tally_.p999_us = times_.quantile(0.999);
  return tally_;
}

}  // namespace

SoakTally soak_partition(const StructureKind& structure, const SoakPlan& plan) {
  return PartitionSoak(structure, plan).run();
}

}  // namespace winnow::test
