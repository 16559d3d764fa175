#include "bench/contenders/engines.h"
#include "bench/peers/adapter_tools.h"
#include "bench/peers/registry.h"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>

#include <limits>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

/// A shape that consists of its box only, so that the tree gets exactly that box: the object is at
/// the origin, and FCL adds a zero translation.
class BoxShape final : public fcl::CollisionGeometry<float> {
 public:
  explicit BoxShape(const Aabb& box) { set(box); }

  [[nodiscard]] bool overlaps(const Aabb& box) const {
    return box.overlaps({aabb_local.min_, aabb_local.max_});
  }
  void set(const Aabb& box) {
    aabb_local.min_ = box.min;
    aabb_local.max_ = box.max;
  }
  void computeLocalAABB() override {}
  [[nodiscard]] fcl::OBJECT_TYPE getObjectType() const override { return fcl::OT_GEOM; }
  [[nodiscard]] fcl::NODE_TYPE getNodeType() const override { return fcl::GEOM_BOX; }
};

using Object = fcl::CollisionObject<float>;
using Tree = fcl::DynamicAABBTreeCollisionManager<float>;

// FCL calls this only for objects whose exact boxes overlap.
bool collect(Object* a, Object* b, void* pairs) {
  static_cast<std::vector<Pair>*>(pairs)->push_back(
      ordered(row_of(a->getUserData()), row_of(b->getUserData())));
  return false;
}

/// FCL: DynamicAABBTreeCollisionManager, in float, which its templates allow and which is faster
/// than the double of its library. FCL supports one thread only.
/// Settings, the best of those tried (measured by `winnow dev throughput --peers`): refits the
/// whole tree, and rebuilds it once the time lost to its degradation exceeds the time of a build.
/// If few objects moved, they are inserted again instead. Objects that left their last box are
/// always inserted again, because refitting them would enlarge the upper nodes; if they are many,
/// the tree is rebuilt. FCL's other managers were slower, except its two sweeps in scenes in which
/// hardly anything moves.
class FclEngine final : public PairsAdapter {
 public:
  [[nodiscard]] std::string name() const override { return "FCL tree"; }
  [[nodiscard]] bool is_serial() const override { return true; }

  /// A lower bound: objects, shapes, nodes and the entries of the tree's hash table, without
  /// overhead of the allocator.
  [[nodiscard]] std::size_t bytes() const override {
    constexpr std::size_t table_entry = sizeof(Tree::DynamicAABBTable::value_type) + 16;
    return objects_.size() *
           (sizeof(BoxShape) + sizeof(Object) + 2 * sizeof(Tree::DynamicAABBNode) + table_entry +
            sizeof(shapes_[0]) + sizeof(objects_[0]) + sizeof(handles_[0]));
  }

 private:
  void build(std::span<const Aabb> boxes) override {
    add_objects(boxes);
    build_tree();
  }

  void update(std::span<const std::uint32_t> changed_rows,
              std::span<const Aabb> all_boxes) override {
    const std::size_t known = objects_.size();
    const bool few = changed_rows.size() < known / 64;
    displaced_.clear();
    for (const std::uint32_t row : changed_rows) {
      if (few || !shapes_[row]->overlaps(all_boxes[row])) displaced_.push_back(handles_[row]);
      shapes_[row]->set(all_boxes[row]);
      objects_[row]->computeAABB();
    }
    add_objects(all_boxes);
    if (lost_ms_ > build_ms_ || displaced_.size() + objects_.size() - known > known / 4) {
      build_tree();
    } else {
      for (std::size_t i = known; i < objects_.size(); ++i) tree_.registerObject(handles_[i]);
      if (!displaced_.empty()) tree_.update(displaced_);
      if (!few && !changed_rows.empty()) tree_.update();
    }
  }

  /// Adds objects for new rows.
  void add_objects(std::span<const Aabb> boxes) {
    shapes_.reserve(boxes.size());
    objects_.reserve(boxes.size());
    handles_.reserve(boxes.size());
    for (std::size_t i = objects_.size(); i < boxes.size(); ++i) {
      shapes_.push_back(std::make_shared<BoxShape>(boxes[i]));
      objects_.push_back(std::make_unique<Object>(shapes_.back()));
      objects_.back()->setUserData(pointer_of(i));
      handles_.push_back(objects_.back().get());
    }
  }

  void build_tree() {
    const Stopwatch watch;
    tree_.clear();
    tree_.registerObjects(handles_);
    tree_.setup();
    build_ms_ = watch.ms();
    lost_ms_ = 0.0;
    best_search_ms_ = std::numeric_limits<double>::infinity();
  }

  void find_pairs(std::span<const Aabb>) override {
    const Stopwatch watch;
    pairs_.clear();
    tree_.collide(&pairs_, collect);
    const double search_ms = watch.ms();
    best_search_ms_ = std::min(best_search_ms_, search_ms);
    lost_ms_ += search_ms - best_search_ms_;
  }

  std::vector<std::shared_ptr<BoxShape>> shapes_;
  std::vector<std::unique_ptr<Object>> objects_;
  std::vector<Object*> handles_;
  std::vector<Object*> displaced_;
  Tree tree_;
  double build_ms_ = 0.0;
  double lost_ms_ = 0.0;
  double best_search_ms_ = 0.0;
};

const RegisteredPeer<Engine, FclEngine> kFclEngine;

}  // namespace
}  // namespace winnow::bench
