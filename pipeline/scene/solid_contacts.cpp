// Contacts of solids that are not convex (solid_contacts.h). FreshContacts calls this.

#include "pipeline/scene/solid_contacts.h"

#include "pipeline/composites/solid_depth.h"
#include "pipeline/narrow/narrow_columns.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow {
namespace {

using mid::Vec;

/// The contacts of a pair of bodies that replace those of its primitives.
struct SolidContact {
  bool is_needed = false;
  ShapeDistance depth;
  ContactPoint points[kManifoldPoints];
  std::uint32_t count = 0;
};

/// The pair of bodies, with the first one at the origin, and its answers.
class SolidPair {
 public:
  SolidPair(const SceneState& scene, const PartAnswers& found, std::span<const std::uint32_t> slots,
            const BodyPair& bodies) noexcept
      : parts_(scene.shapes, scene.options.composites),
        found_(found),
        slots_(slots),
        pair_({scene.shape[bodies.a], scene.pose[bodies.a]},
              {scene.shape[bodies.b], scene.pose[bodies.b]}) {
    pair_.base[0] = pair_.base[1] = pair_.base[2] = 0.0;
  }

  [[nodiscard]] bool has_solid() const noexcept {
    return !slots_.empty() && has_solid_depth(parts_, pair_);
  }
  [[nodiscard]] bool overlaps_at(const Vec& by) const noexcept {
    return do_overlap_at(parts_, pair_, by);
  }
  [[nodiscard]] SolidContact find_contact() const noexcept;

 private:
  [[nodiscard]] Vec way_out() const noexcept;
  void find_points(SolidContact& contact) const noexcept;
  [[nodiscard]] bool touch_plane(const SolidContact& contact, PairAnswer& answer) const noexcept;

  SubShapeQuery parts_;
  const PartAnswers& found_;
  std::span<const std::uint32_t> slots_;
  Pairing pair_;
};

// Returns the least translation of b that leaves all contacts, by projected Gauss-Seidel; too short
// a one if contacts oppose each other.
Vec SolidPair::way_out() const noexcept {
  constexpr int kRounds = 30;
  const NarrowResult& answers = found_.answers;
  Vec way = Vec::Zero();
  for (int round = 0; round < kRounds; ++round) {
    for (const std::uint32_t slot : slots_) {
      const double depth = -answers.distance()[slot];
      if (!(depth > 0.0)) continue;
      const Vec normal(answers.normal(0)[slot], answers.normal(1)[slot], answers.normal(2)[slot]);
      way += std::max(depth - way.dot(normal), 0.0) * normal;
    }
  }
  return way;
}

SolidContact SolidPair::find_contact() const noexcept {
  constexpr double kFarther = 1e-7;
  const double size = parts_.radius(pair_.a.shape) + parts_.radius(pair_.b.shape);
  const Vec way = way_out();
  SolidContact contact;
  contact.is_needed = overlaps_at(way + kFarther * size * way.stableNormalized());
  if (!contact.is_needed) return contact;
  contact.is_needed = find_solid_depth(parts_, pair_, contact.depth);
  if (contact.is_needed) find_points(contact);
  return contact;
}

void SolidPair::find_points(SolidContact& contact) const noexcept {
  PairAnswer answer;
  if (touch_plane(contact, answer)) {
    // Points of the other body that are outside the solid touch nothing.
    const PlacedShape& solid = parts_.has_solids(pair_.a.shape) ? pair_.a : pair_.b;
    for (const ContactPoint& point : std::span(answer.contacts, answer.contact_count)) {
      const Vec3d at(point.position[0], point.position[1], point.position[2]);
      if (parts_.solid_contains(solid, at)) contact.points[contact.count++] = point;
    }
    if (contact.count != 0) return;
  }
  contact.count = 1;
  for (int axis = 0; axis < 3; ++axis) {
    contact.points[0].position[axis] =
        static_cast<float>(0.5 * (contact.depth.point_a[axis] + contact.depth.point_b[axis]));
  }
  contact.points[0].depth = static_cast<float>(-contact.depth.distance);
  contact.points[0].feature = 0;
}

// Computes the contacts of a convex body with a half-space whose boundary is where the solid ends
// along the normal. Returns false unless one body is convex, and as deep in the half-space as in
// the solid.
bool SolidPair::touch_plane(const SolidContact& contact, PairAnswer& answer) const noexcept {
  constexpr double kSameDepth = 1e-6;
  const bool first = !pair_.a.shape.is_composite();
  if (!first && pair_.b.shape.is_composite()) return false;
  ShapeTables tables = parts_.shapes().tables();
  const double sign = first ? -1.0 : 1.0;
  HalfSpaceShape plane;
  for (int axis = 0; axis < 3; ++axis) plane.normal[axis] = sign * contact.depth.normal[axis];
  tables.half_spaces = &plane;
  tables.count[static_cast<std::size_t>(ShapeKind::half_space)] = 1;
  const ShapeId id = ShapeId::of(ShapeKind::half_space, 0);
  const Pose at{first ? contact.depth.point_b : contact.depth.point_a, {1.0, 0.0, 0.0, 0.0}};
  const NarrowOptions options{.level = ContactLevel::manifold};
  const Status status = first
                            ? collide(tables, pair_.a.shape, pair_.a.pose, id, at, options, answer)
                            : collide(tables, id, at, pair_.b.shape, pair_.b.pose, options, answer);
  const double depth = contact.depth.distance;
  if (status != Status::ok || std::abs(answer.distance - depth) > -kSameDepth * depth) return false;
  // Positions are relative to the position of the half-space if it is the first shape.
  for (ContactPoint& point : answer.contacts) {
    for (int axis = 0; axis < 3 && !first; ++axis) {
      point.position[axis] += static_cast<float>(at.position[axis]);
    }
  }
  return true;
}

/// Replaces the answers of one pair.
class SolidAnswers {
 public:
  SolidAnswers(PartAnswers& found, std::span<const std::uint32_t> slots, double margin) noexcept
      : found_(found), columns_(NarrowColumns::of(found.answers)), slots_(slots), margin_(margin) {}

  void set_overlap() noexcept { columns_.overlap[slots_[0]] = 1; }
  /// Returns false if memory is refused.
  [[nodiscard]] bool replace(const SolidContact& contact) noexcept {
    const bool has_points = found_.answers.level() == ContactLevel::manifold;
    if (has_points && !put_points(contact)) return false;
    for (const std::uint32_t slot : slots_.subspan(1)) {
      columns_.distance[slot] = std::nextafter(margin_, std::numeric_limits<double>::max());
      if (has_points) columns_.contact_count[slot] = 0;
    }
    const std::uint32_t slot = slots_[0];
    columns_.distance[slot] = contact.depth.distance;
    columns_.error_bound[slot] = contact.depth.error_bound;
    for (int axis = 0; axis < 3; ++axis) {
      columns_.normal[axis][slot] = contact.depth.normal[axis];
      if (!has_points) columns_.point[axis][slot] = contact.depth.point_a[axis];
    }
    const BodyPair& primitives = found_.pairs.pairs[found_.answers.pair_of(slot)];
    found_.pairs.part[primitives.a] = contact.depth.part_a;
    found_.pairs.part[primitives.b] = contact.depth.part;
    return true;
  }

 private:
  [[nodiscard]] bool put_points(const SolidContact& contact) noexcept {
    ContactColumns& all = columns_.contacts;
    const std::size_t first = all.size();
    if (!all.grow(first + contact.count)) return false;
    all.set_size(first + contact.count);
    for (std::uint32_t k = 0; k < contact.count; ++k) {
      const ContactPoint& point = contact.points[k];
      for (int axis = 0; axis < 3; ++axis) all.position[axis][first + k] = point.position[axis];
      all.depth[first + k] = point.depth;
      all.feature[first + k] = point.feature;
    }
    columns_.contact_first[slots_[0]] = static_cast<std::uint32_t>(first);
    columns_.contact_count[slots_[0]] = contact.count;
    return true;
  }

  PartAnswers& found_;
  NarrowColumns columns_;
  std::span<const std::uint32_t> slots_;
  double margin_;
};

/// Corrects the contacts of all pairs, a few in parallel at a time.
class SolidContacts {
 public:
  SolidContacts(const SceneState& scene, const Column<BodyPair>& pairs, const PairMargins& margins,
                PartAnswers& found) noexcept
      : scene_(scene), pairs_(pairs), margins_(margins), found_(found) {}

  [[nodiscard]] Status run() {
    std::size_t count = 0;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      if (!pair(i).has_solid()) continue;
      number_[count++] = i;
      if (count < kPairsAtOnce) continue;
      if (!correct(count)) return Status::out_of_memory;
      count = 0;
    }
    return correct(count) ? Status::ok : Status::out_of_memory;
  }

 private:
  static constexpr std::size_t kPairsAtOnce = 32;

  /// Returns the answers of a pair of bodies.
  [[nodiscard]] std::span<const std::uint32_t> slots(std::size_t i) const noexcept {
    const Column<std::uint32_t>& first = found_.pairs.first;
    return {found_.slot.data() + first[i], first[i + 1] - first[i]};
  }
  [[nodiscard]] SolidPair pair(std::size_t i) const noexcept {
    return {scene_, found_, slots(i), pairs_[i]};
  }
  /// Returns false if memory is refused.
  [[nodiscard]] bool correct(std::size_t count) {
    const bool is_boolean = found_.answers.level() == ContactLevel::boolean;
    scene_.options.execution.for_each(count, [&](std::size_t k) {
      const SolidPair own = pair(number_[k]);
      if (is_boolean) {
        contact_[k].is_needed = own.overlaps_at(Vec::Zero());
      } else {
        contact_[k] = own.find_contact();
      }
    });
    for (std::size_t k = 0; k < count; ++k) {
      if (!contact_[k].is_needed) continue;
      const std::size_t i = number_[k];
      SolidAnswers answers(found_, slots(i), margins_.of(found_.pairs.first[i]));
      if (is_boolean) {
        answers.set_overlap();
      } else if (!answers.replace(contact_[k])) {
        return false;
      }
    }
    return true;
  }

  const SceneState& scene_;
  const Column<BodyPair>& pairs_;
  const PairMargins& margins_;
  PartAnswers& found_;
  std::size_t number_[kPairsAtOnce];
  SolidContact contact_[kPairsAtOnce];
};

}  // namespace

Status correct_solid_contacts(const SceneState& scene, const Column<BodyPair>& pairs,
                              const PairMargins& margins, PartAnswers& found) {
  return SolidContacts(scene, pairs, margins, found).run();
}

}  // namespace winnow
