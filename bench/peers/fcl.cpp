#include "bench/common/sample.h"
#include "bench/peers/adapter_tools.h"
#include "bench/peers/adapters.h"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>

#include <limits>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

/// A shape that is nothing but its box, so that the box reaches the tree exactly: the object stands
/// at the origin and FCL adds a zero translation.
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

std::uint32_t row_of(const Object* object) {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(object->getUserData()));
}

// FCL calls this only for objects whose exact boxes overlap.
bool collect(Object* a, Object* b, void* pairs) {
  static_cast<std::vector<Pair>*>(pairs)->push_back(ordered(row_of(a), row_of(b)));
  return false;
}

/// FCL: DynamicAABBTreeCollisionManager, in float because its templates allow it (10-20 % faster
/// than the double that the library is built for). One thread: it has no more.
/// Best of what was tried: refitting the whole tree, even where 5 % moved (update of the changed
/// objects by re-insertion costs 1.1 to 2.3 times as much), and building it anew as soon as the
/// time lost to its ageing since the last build has reached what a build takes. Where few moved
/// they are inserted again, and so are objects that left the place they had: refitted they would
/// take the upper nodes along (then a search takes up to 600 times as long). Where those are many
/// the tree is built anew. Of its other managers, at 1,000 and 3,000 objects, the array of nodes
/// takes 1.1 to 6 times as long, the interval tree 10 times, and the two sweeps 0.3 to 0.9 times
/// where hardly anything moves and 5 to 1,000 times where all does.
class FclEngine final : public PairsAdapter {
 public:
  [[nodiscard]] std::string name() const override { return "FCL tree"; }
  [[nodiscard]] bool is_serial() const override { return true; }

  void start(std::span<const Aabb> boxes) override {
    const Stopwatch watch;
    add_objects(boxes);
    build();
    update_ms_ = watch.ms();
    find_pairs();
  }

  void frame(std::span<const std::uint32_t> changed_rows,
             std::span<const Aabb> all_boxes) override {
    const Stopwatch watch;
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
      build();
    } else {
      for (std::size_t i = known; i < objects_.size(); ++i) tree_.registerObject(handles_[i]);
      if (!displaced_.empty()) tree_.update(displaced_);
      if (!few && !changed_rows.empty()) tree_.update();
    }
    update_ms_ = watch.ms();
    find_pairs();
  }

  /// At least: objects, shapes, nodes and the entries of the tree's hash table, without what the
  /// allocator adds.
  [[nodiscard]] std::size_t bytes() const override {
    constexpr std::size_t table_entry = sizeof(Tree::DynamicAABBTable::value_type) + 16;
    return objects_.size() *
           (sizeof(BoxShape) + sizeof(Object) + 2 * sizeof(Tree::DynamicAABBNode) + table_entry +
            sizeof(shapes_[0]) + sizeof(objects_[0]) + sizeof(handles_[0]));
  }

 private:
  /// Of the rows that have none.
  void add_objects(std::span<const Aabb> boxes) {
    shapes_.reserve(boxes.size());
    objects_.reserve(boxes.size());
    handles_.reserve(boxes.size());
    for (std::size_t i = objects_.size(); i < boxes.size(); ++i) {
      shapes_.push_back(std::make_shared<BoxShape>(boxes[i]));
      objects_.push_back(std::make_unique<Object>(shapes_.back()));
      objects_.back()->setUserData(reinterpret_cast<void*>(static_cast<std::uintptr_t>(i)));
      handles_.push_back(objects_.back().get());
    }
  }

  void build() {
    const Stopwatch watch;
    tree_.clear();
    tree_.registerObjects(handles_);
    tree_.setup();
    build_ms_ = watch.ms();
    lost_ms_ = 0.0;
    best_search_ms_ = std::numeric_limits<double>::infinity();
  }

  void find_pairs() {
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

}  // namespace

std::unique_ptr<Engine> make_fcl() {
  return std::make_unique<FclEngine>();
}

}  // namespace winnow::bench
