// Life cycles of partitions: objects are inserted, removed, moved and refiltered, while the row
// order degrades and is rebuilt. The decisions to rebuild depend on counted tests and never on
// time, so they repeat exactly and are digested like results.

#include "tests/digests/digest.h"
#include "tests/support/float_modes.h"

#include <algorithm>
#include <limits>
#include <memory_resource>
#include <numeric>
#include <span>

namespace winnow::test {
namespace {

/// Digests all draw calls.
class Drawing final : public DebugDraw {
 public:
  explicit Drawing(Digest& digest) : digest_(digest) {}

  void box(const Aabb& box, Colour colour) override {
    add(box.min);
    add(box.max);
    add(colour);
  }
  void line(const Vec3f& from, const Vec3f& to, Colour colour) override {
    add(from);
    add(to);
    add(colour);
  }
  void sphere(const Sphere& sphere, Colour colour) override {
    add(sphere.center);
    digest_.add(static_cast<double>(sphere.radius));
    add(colour);
  }
  void text(const Vec3f& at, std::string_view text, Colour colour) override {
    add(at);
    for (const char letter : text) digest_.add(static_cast<std::uint64_t>(letter));
    add(colour);
  }

 private:
  void add(const Vec3f& point) {
    for (int k = 0; k < 3; ++k) digest_.add(static_cast<double>(point[k]));
  }
  void add(Colour colour) {
    for (const std::uint8_t part : {colour.r, colour.g, colour.b, colour.a}) {
      digest_.add(std::uint64_t{part});
    }
  }

  Digest& digest_;
};

class Life {
 public:
  Life(StructureKind structure, const PartitionOptions& options, std::size_t count, Digest& digest)
      : partition_(structure, options),
        bounded_(options.volume != Volume::aabb),
        numbers_(21),
        digest_(digest) {
    insert(count);
  }

  void insert(std::size_t count) {
    std::vector<Aabb> boxes(count);
    for (Aabb& box : boxes) place(box);
    std::vector<Key> keys(count);
    std::vector<ClientData> data(count);
    std::iota(data.begin(), data.end(), keys_.size());
    note(partition_.insert(boxes, data, keys));
    keys_.insert(keys_.end(), keys.begin(), keys.end());
    boxes_.insert(boxes_.end(), boxes.begin(), boxes.end());
  }

  /// Removes a random object.
  void remove_one() {
    const auto at = static_cast<std::ptrdiff_t>(numbers_.below(keys_.size()));
    note(partition_.remove(keys_[static_cast<std::size_t>(at)]));
    keys_.erase(keys_.begin() + at);
    boxes_.erase(boxes_.begin() + at);
  }

  /// Removes every `stride`-th object, starting from a random one.
  void remove(std::size_t stride) {
    std::vector<Key> gone;
    std::size_t kept = 0;
    const std::size_t first = numbers_.below(stride);
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      if (i % stride == first) {
        gone.push_back(keys_[i]);
        continue;
      }
      keys_[kept] = keys_[i];
      boxes_[kept++] = boxes_[i];
    }
    keys_.resize(kept);
    boxes_.resize(kept);
    note(partition_.remove(gone));
    note(partition_.remove(gone));
    note(partition_.update(gone, {std::span<const Aabb>(boxes_).first(gone.size())}));
  }

  /// Moves every `stride`-th object by up to `way` sixteenths, in the order of the keys or
  /// backwards.
  void move(std::size_t stride, int way, bool backwards = false) {
    std::vector<Key> keys;
    std::vector<Aabb> boxes;
    for (std::size_t n = numbers_.below(stride); n < keys_.size(); n += stride) {
      const std::size_t i = backwards ? keys_.size() - 1 - n : n;
      step(boxes_[i], way);
      keys.push_back(keys_[i]);
      boxes.push_back(boxes_[i]);
    }
    note(partition_.update(keys, boxes));
  }

  void move_one_by_one(std::size_t stride, int way) {
    for (std::size_t i = numbers_.below(stride); i < keys_.size(); i += stride) {
      step(boxes_[i], way);
      note(partition_.update(keys_[i], boxes_[i]));
    }
  }

  /// As move(), but passes all boxes and an IndexSubset that selects the moved ones; the other
  /// boxes are invalid.
  void move_listed(std::size_t stride, int way, bool masked) {
    std::vector<Aabb> boxes = boxes_;
    std::vector<std::uint32_t> list;
    std::vector<std::uint64_t> mask(keys_.size() / 64 + 1);
    const std::size_t first = numbers_.below(stride);
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      if (i % stride != first) {
        boxes[i].min[0] = std::numeric_limits<float>::quiet_NaN();
        continue;
      }
      step(boxes_[i], way);
      boxes[i] = boxes_[i];
      list.push_back(static_cast<std::uint32_t>(i));
      mask[i / 64] |= std::uint64_t{1} << i % 64;
    }
    note(partition_.update(keys_, boxes,
                           masked ? IndexSubset::masked(mask) : IndexSubset::listed(list)));
  }

  /// How the boxes of jittering objects are passed to the partition.
  enum class InputForm { in_order, backwards, in_columns, twice };

  /// Moves each object by up to 2^-12 from its rest position, except every `stride`-th.
  void jitter(InputForm form, std::size_t stride = 5) {
    const std::size_t count = keys_.size();
    std::vector<Key> keys = keys_;
    std::vector<Aabb> boxes = boxes_;
    const std::size_t first = numbers_.below(stride);
    for (std::size_t i = 0; i < count; ++i) {
      if (i % stride != first) shift(boxes[i], 0x1p-12);
    }
    if (form == InputForm::backwards) {
      std::reverse(keys.begin(), keys.end());
      std::reverse(boxes.begin(), boxes.end());
    }
    // Some keys come twice, first with a distant box: the last box of a key counts.
    for (std::size_t i = first; form == InputForm::twice && i < count; i += 97) {
      keys.push_back(keys[i]);
      boxes.push_back(boxes[i]);
      step(boxes[i], 64);
    }
    if (form != InputForm::in_columns) return note(partition_.update(keys, boxes));
    std::vector<float> columns;
    for (int c = 0; c < 6; ++c) {
      for (const Aabb& box : boxes) columns.push_back(c < 3 ? box.min[c] : box.max[c - 3]);
    }
    const auto at = [&](std::size_t c) { return columns.data() + c * count; };
    note(partition_.update(keys, BoxView({at(0), at(1), at(2)}, {at(3), at(4), at(5)}, count)));
  }

  /// Moves `count` consecutive objects, starting from a random one.
  void move_some(std::size_t count, int way) {
    std::vector<Key> keys;
    std::vector<Aabb> boxes;
    const std::size_t first = numbers_.below(keys_.size());
    for (std::size_t n = 0; n < count; ++n) {
      const std::size_t i = (first + n) % keys_.size();
      step(boxes_[i], way);
      keys.push_back(keys_[i]);
      boxes.push_back(boxes_[i]);
    }
    note(partition_.update(keys, boxes));
  }

  void jump_one() {
    const std::size_t i = numbers_.below(keys_.size());
    place(boxes_[i]);
    note(partition_.update(keys_[i], boxes_[i]));
  }

  void jump(std::size_t stride) {
    for (std::size_t i = numbers_.below(stride); i < keys_.size(); i += stride) place(boxes_[i]);
    note(partition_.update(keys_, boxes_));
  }

  /// Makes invalid calls, which must change nothing.
  void query_badly() {
    std::vector<Key> keys(keys_.begin(), keys_.begin() + 3);
    std::vector<Aabb> boxes(boxes_.begin() + 3, boxes_.begin() + 6);
    keys.push_back(keys.front());
    note(partition_.update(keys, boxes));
    note(partition_.remove(keys));
    note(partition_.remove(std::span(keys).first(2).subspan(2)));
    keys.back() = Key{};
    boxes.push_back(boxes.front());
    note(partition_.update(keys, boxes));
    keys.pop_back();
    boxes.pop_back();
    boxes.back().max[1] = -std::numeric_limits<float>::infinity();
    note(partition_.update(keys, boxes));
    note(partition_.set_filter(keys, std::vector<ObjectFilter>(2)));
  }

  /// Sets the filter of every `stride`-th of the first objects.
  void filter(std::size_t stride, const ObjectFilter& filter, std::size_t first = kMaxObjects) {
    std::vector<Key> keys;
    const std::size_t end = std::min(first, keys_.size());
    for (std::size_t i = 0; i < end; i += stride) keys.push_back(keys_[i]);
    note(partition_.set_filter(keys, std::vector<ObjectFilter>(keys.size(), filter)));
  }

  void part(std::uint32_t environments) {
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      const auto environment = static_cast<std::uint32_t>(i) % environments;
      note(partition_.set_filter(keys_[i],
                                 {.layers = ~0U, .mask = ~0U, .environment = environment}));
    }
  }

  void query_pairs(const PairOptions& options = {}) {
    note(partition_.self_pairs(pairs_, options));
    for (const Pair& pair : pairs_) digest_.add(std::uint64_t{pair.first} << 32U | pair.second);
    count();
  }

  /// Queries into an empty buffer, as a new caller does.
  void query_anew() {
    pairs_.clear();
    query_pairs();
  }

  void look() {
    HitBuffer hits;
    OverlapBuffer objects;
    for (int i = 0; i < 8; ++i) {
      Ray ray;
      for (int k = 0; k < 3; ++k) {
        ray.origin[k] = static_cast<float>(numbers_.coordinate(16));
        ray.direction[k] = static_cast<float>(numbers_.coordinate(1));
      }
      note(partition_.all(ray, hits));
      for (const Hit& hit : hits.hits()) digest_.add(std::uint64_t{hit.key.id});
      note(partition_.overlap(Sphere{ray.origin, 3.0F}, objects));
      for (const ObjectId id : objects.ids()) digest_.add(std::uint64_t{id});
      note(partition_.nearest({ray.origin, ray.origin}, 5, 50.0F, hits));
      for (const Hit& hit : hits.hits()) digest_.add(std::uint64_t{hit.key.id});
    }
  }

  void draw() {
    Drawing drawing(digest_);
    note(partition_.debug_draw(drawing, {.objects = true, .structure = true, .labels = true}));
  }

  /// Saves the partition and loads it again.
  void restart() {
    Column<std::byte> saved(std::pmr::get_default_resource());
    note(partition_.save(saved));
    note(partition_.load({saved.data(), saved.size() - 1}));
    note(partition_.load({saved.data(), saved.size()}));
  }

  Partition& partition() { return partition_; }
  void note(Status status) { digest_.add(static_cast<std::uint64_t>(status)); }
  void note(bool answer) { digest_.add(std::uint64_t{answer ? 1U : 0U}); }

  void forget() {
    keys_.clear();
    boxes_.clear();
  }

 private:
  /// Places a cube of one of a few sizes in a flat world.
  void place(Aabb& box) {
    const auto size = static_cast<float>(1U << numbers_.below(3)) * 0.5F;
    for (int k = 0; k < 3; ++k) {
      box.min[k] = static_cast<float>(numbers_.coordinate(k == 2 ? 4 : 16));
      box.max[k] = box.min[k] + size;
    }
    // A few boxes are infinite on one or two sides.
    const std::size_t chance = numbers_.below(300);
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    if (chance < 2 && !bounded_) box.min[chance] = -kInfinity;
    if (chance < 1 && !bounded_) box.max[0] = kInfinity;
  }

  /// Moves a box by up to `way` sixteenths along each axis.
  void step(Aabb& box, int way) { shift(box, way * 0x1p-4); }

  /// Moves a box by up to `most` along each axis. Boxes must be equal in all floating-point modes,
  /// since the results for them are compared.
  void shift(Aabb& box, double most) {
    const FloatModeScope nearest({FE_TONEAREST});
    for (int k = 0; k < 3; ++k) {
      const auto by = static_cast<float>(numbers_.coordinate(1) * most);
      box.min[k] += by;
      box.max[k] += by;
    }
  }

  void count() {
    const Statistics s = partition_.statistics();
    for (const std::size_t number :
         {s.objects, s.regular, s.irregular, s.cells, s.depth, s.levels}) {
      digest_.add(std::uint64_t{number});
    }
    for (const std::uint64_t number : {s.builds, s.planned_builds, s.refits, s.full_queries,
                                       s.incremental_queries, s.last_tests, s.last_pairs}) {
      digest_.add(number);
    }
    const Footprint bytes = partition_.footprint();
    for (const Bytes& part : {bytes.bounds, bytes.keys, bytes.client_data}) {
      digest_.add(std::uint64_t{part.used});
      digest_.add(std::uint64_t{part.reserved});
    }
    Aabb box;
    for (const Key key : keys_) {
      note(partition_.bounds(key).get(box));
      digest_.add(static_cast<double>(box.min[0]));
      digest_.add(static_cast<double>(box.max[2]));
    }
  }

  Partition partition_;
  bool bounded_;  // no box gets infinite ends: volumes other than boxes have none
  Numbers numbers_;
  Digest& digest_;
  std::vector<Key> keys_;
  std::vector<Aabb> boxes_;
  PairBuffer pairs_;
};

/// All objects move a little in every frame, long enough that the order degrades and a rebuild is
/// planned.
void drift(Life& life, int way) {
  for (int frame = 0; frame < 40; ++frame) {
    life.move(1, way, frame % 3 == 2);
    life.query_pairs();
    if (frame == 30) life.jump(6);
    if (frame % 8 == 3) life.look();
  }
}

/// Some objects move, arrive and leave, through every form of the calls.
void churn(Life& life) {
  for (int frame = 0; frame < 24; ++frame) {
    life.move_one_by_one(37, 8);
    life.move(frame % 4 == 0 ? 2 : 19, 4, frame % 2 == 1);
    life.move_listed(frame % 3 == 0 ? 3 : 1, 2, frame % 2 == 0);
    if (frame % 5 == 1) life.remove(frame % 2 == 0 ? 3 : 11);
    if (frame % 5 == 3) life.insert(150);
    if (frame % 7 == 2) life.query_badly();
    if (frame % 10 == 4) life.draw();
    if (frame == 17) life.restart();
    if (frame == 17) life.look();
    if (frame == 19) life.jump(6);
    if (frame == 9) life.jump(2);
    if (frame == 15) life.jump(40);
    if (frame == 20) life.jump(1);
    life.query_pairs({.order = frame % 6 == 5 ? Order::canonical : Order::fast});
    if (frame % 6 == 2) life.look();
  }
}

/// Filters by layers first, then by environments, then not at all.
void sift(Life& life) {
  for (int frame = 0; frame < 16; ++frame) {
    life.move(frame % 2 == 0 ? 1 : 7, 4);
    if (frame == 2) life.filter(3, {.layers = 2U, .mask = 5U, .environment = 0});
    if (frame == 5) life.part(3);
    if (frame == 8) life.insert(200);
    if (frame == 10) life.filter(2, {.layers = 1U, .mask = ~0U, .environment = kAllEnvironments});
    if (frame == 12) life.remove(5);
    if (frame == 13) life.filter(1, {});
    life.query_pairs();
    if (frame % 4 == 3) life.look();
  }
}

/// All objects jitter in place, so that hardly a pair changes, while some move, arrive and leave.
void rest(Life& life) {
  using InputForm = Life::InputForm;
  for (int frame = 0; frame < 90; ++frame) {
    const InputForm form[] = {InputForm::in_order, InputForm::in_order, InputForm::backwards,
                              InputForm::in_columns, InputForm::twice};
    life.jitter(form[frame % 5]);
    if (frame % 11 == 6) life.move_one_by_one(211, 8);
    if (frame % 13 == 7) life.move(97, 8, frame % 2 == 1);
    if (frame % 17 == 8) life.insert(9);
    if (frame % 17 == 12) life.remove(150);
    if (frame == 20) life.filter(180, {.layers = 1U, .mask = 6U, .environment = 0});
    if (frame == 28) life.query_badly();
    if (frame == 32) life.move_listed(80, 8, true);
    if (frame == 45) life.look();
    if (frame == 70) life.move(2, 16);
    if (frame % 9 != 4) life.query_pairs();
  }
}

/// Few objects, then many that all move, then many of which few move, then few again: the automatic
/// structure switches several times.
void turn(Life& life) {
  for (int frame = 0; frame < 120; ++frame) {
    if (frame == 10) life.insert(3000);
    if (frame == 50) life.remove(2);
    if (frame == 95) life.remove(1);
    if (frame == 95) life.insert(40);
    life.move(frame < 60 ? 1 : 40, 3);
    if (frame > 70) life.look();
    life.query_pairs();
  }
}

/// In every frame a few objects jump away from their neighbours.
void jump_away(Life& life) {
  for (int frame = 0; frame < 24; ++frame) {
    life.move(1, 1);
    life.jump(frame % 8 == 7 ? 9 : 60);
    life.query_pairs();
  }
}

/// One object jumps, leaves or arrives in each frame, so that the count reaches each limit exactly.
void trickle(Life& life, std::size_t count) {
  for (std::size_t i = 0; i < count / 2; ++i) {
    life.jump_one();
    life.query_pairs();
  }
  for (std::size_t i = 0; i < count / 2; ++i) {
    life.remove_one();
    life.query_pairs();
  }
  for (std::size_t i = 0; i < count; ++i) {
    life.insert(1);
    if (i % 4 == 3) life.remove_one();
    life.query_pairs();
  }
}

/// Moves a sixth of `count` objects from the first environment to the last, enough that the rows
/// are reordered, while no box moves: the objects of the middle environment get into other blocks.
void regroup(Life& life, std::size_t count) {
  life.part(3);
  life.query_pairs();
  life.filter(3, {.layers = ~0U, .mask = ~0U, .environment = 2}, count / 2);
  life.query_pairs();
  life.query_anew();
}

/// In each frame one object more moves, until all of them move.
void swell(Life& life, std::size_t count) {
  for (std::size_t moving = 1; moving <= count; ++moving) {
    life.move_some(moving, moving % 2 == 0 ? 1 : 8);
    if (moving % 3 == 0) life.jump_one();
    life.query_pairs();
  }
}

/// Removes everything, releases and reserves memory, and switches the structure.
void end(Life& life) {
  Partition& partition = life.partition();
  const StructureKind before = partition.structure();
  for (const StructureKind kind : {linear_bvh(), bounds_n_squared(), flat_grid(), before}) {
    life.note(partition.set_structure(kind));
    life.move(2, 4);
    life.query_pairs();
  }
  partition.release_memory();
  life.query_pairs();
  partition.clear();
  life.forget();
  life.query_pairs();
  life.note(partition.reserve(700));
  life.insert(300);
  life.query_pairs();
  partition.clear();
  life.forget();
  partition.release_memory();
  life.insert(100);
  life.query_pairs();
}

void live(StructureKind structure, PartitionOptions options, const Execution& execution,
          Digest& digest) {
  options.execution = execution;
  const std::size_t count = structure == n_squared() ? 60 : 1200;
  Life drifting(structure, options, count, digest);
  drift(drifting, 4);
  Life life(structure, options, count, digest);
  churn(life);
  sift(life);
  drift(life, 1);
  end(life);
  Life resting(structure, options, count, digest);
  rest(resting);
  jump_away(resting);
  regroup(resting, count);
  const std::size_t few = structure == n_squared() ? 40 : 256;
  Life steady(structure, options, few, digest);
  swell(steady, few);
  trickle(steady, few);
  // The first objects and the later ones get layers that do not collide.
  steady.filter(1, {.layers = 2U, .mask = 2U, .environment = 0});
  steady.filter(1, {.layers = 1U, .mask = 1U, .environment = 0}, few / 2);
  trickle(steady, few);
}

}  // namespace

std::vector<Work> refresh_works() {
  std::vector<Work> works;
  const auto add = [&](StructureKind structure, const char* name, const PartitionOptions& options) {
    works.push_back({"lives/" + std::string(structure.name()) + name,
                     [=](const Execution& execution, Digest& digest) {
                       live(structure, options, execution, digest);
                     }});
  };
  for (const StructureKind structure : all_structures()) {
    add(structure, "", {});
    add(structure, "/planned", {.build_budget = 200});
  }
  for (const bool reserved : {false, true}) {
    works.push_back({std::string("lives/turning") + (reserved ? "/reserved" : ""),
                     [=](const Execution& execution, Digest& digest) {
                       PartitionOptions options;
                       options.execution = execution;
                       options.build_budget = 500;
                       Life life(automatic(), options, 20, digest);
                       if (reserved) life.note(life.partition().reserve(4000));
                       turn(life);
                     }});
  }
  for (const StructureKind structure : {hierarchical_grid(), linear_bvh()}) {
    add(structure, "/margins", {.fat_margin = {.distance = 0.125F, .share = 0.0625F}});
    add(structure, "/spheres", {.volume = Volume::sphere});
    add(structure, "/kdops", {.volume = Volume::kdop18, .fat_margin = {.distance = 0.0625F}});
  }
  return works;
}

}  // namespace winnow::test
