// Suppresses ghost contacts at seams (internal edges) between fixed bodies whose surfaces are flush
// and form one floor. Collision (collide.cpp) calls drop_ghost_contacts after the narrow phase of
// all pairs.
//
// Each manifold of a dynamic body with a fixed body defines a floor plane: perpendicular to the
// normal, through the point of the fixed surface at which the dynamic body is deepest. Except for
// the penetration depth, the dynamic body is above this plane. A contact with another fixed body is
// a ghost contact if
// - its depth is not larger, and its normal differs,
// - all its points are in the plane or below it, and
// - the other fixed body does not rise above the plane near the contact: the tangent plane of the
//   contact intersects the floor plane in a line, and the other body is below the plane through
//   this line that rises away from the dynamic body, by the largest angle at which two normals
//   count as normals of one surface.
// Walls, kerbs, steps and the feet of slopes rise above the plane where the body touches them, at
// whatever height the points are, so their contacts stay. Flush bodies have the same depth along
// the floor's normal, and the contact with the other body has the least depth in any direction,
// which is not larger. So the contact of lesser depth is dropped. A dropped contact cannot be the
// floor of another contact, so two contacts never drop each other.

#include "core/numbers/rotation.h"
#include "pipeline/narrow/narrow_columns.h"
#include "pipeline/scene/collision.h"
#include "pipeline/shapes/extent.h"
#include "pipeline/shapes/frame.h"

#include <winnow/core/eigen.h>
#include <winnow/core/pose.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace winnow {
namespace {

using mid::Vec;

/// Share of the dynamic body's radius: a point that is above a plane by less than this counts as in
/// the plane.
constexpr double kPlaneShare = 1e-3;
/// Share of the dynamic body's radius: two depths that differ by less than this count as equal, and
/// either contact may be the floor.
constexpr double kEqualShare = 1e-6;
/// Cosine of the largest angle between the two normals: a ceiling is not a seam.
constexpr double kOppositeCosine = -0.5;
/// The sine of the angle whose cosine is kRegionCosine.
constexpr double kRegionSine = 0.08715574274765817;

/// Decides whether a contact of a body is a ghost contact at a seam.
class GhostContactTest {
 public:
  /// `limit`: primitive pairs with at most this distance are in contact.
  GhostContactTest(const SceneState& scene, double radius, double limit) noexcept
      : scene_(scene), radius_(radius), limit_(limit) {}

  /// True if `other` is a ghost contact beside the contact `floor`.
  [[nodiscard]] bool is_ghost_contact(const FloorContact& other,
                                      const FloorContact& floor) const noexcept {
    const Vec up = Vec::Map(floor.normal);
    const double cosine = up.dot(Vec::Map(other.normal));
    if (floor.floor == other.floor || floor.distance > other.distance + kEqualShare * radius_ ||
        cosine >= kRegionCosine || cosine < kOppositeCosine) {
      return false;
    }
    const double plane = up.dot(Vec::Map(floor.point[floor.deepest]));
    const bool is_below = std::all_of(
        other.point, other.point + other.count,
        [&](const double(&p)[3]) { return up.dot(Vec::Map(p)) <= plane + kPlaneShare * radius_; });
    return is_below && !rises(other, up, plane);
  }

 private:
  /// True if the fixed body of a contact rises above the plane up . x = `plane` near the contact.
  [[nodiscard]] bool rises(const FloorContact& contact, const Vec& up,
                           double plane) const noexcept {
    const Vec normal = Vec::Map(contact.normal);
    const double cosine = up.dot(normal);
    const Vec side = normal - cosine * up;
    const double sine = side.norm();
    const Vec steepest = kRegionCosine * up + kRegionSine / sine * side;
    // Offset along `steepest` from the contact point to the line in which the contact's tangent
    // plane intersects the floor plane.
    const Vec point = Vec::Map(contact.point[contact.deepest]);
    const double climb = (kRegionCosine - kRegionSine * cosine / sine) * (plane - up.dot(point));
    return highest(contact, steepest) > steepest.dot(point) + climb + kPlaneShare * radius_;
  }

  /// Support of the fixed body along a unit direction, relative to the dynamic body's position; for
  /// composite shapes, only of the primitives that are in contact.
  [[nodiscard]] double highest(const FloorContact& contact, const Vec& along) const noexcept {
    const Vec apart = as_eigen(scene_.pose[contact.floor].position) -
                      as_eigen(scene_.pose[contact.body].position);
    double most = -mid::kInfinity;
    if (contact.source == FloorContact::Source::convex) {
      Pose pose = scene_.pose[contact.floor];
      as_eigen(pose.position) = apart;
      most = highest(scene_.shapes.tables(), scene_.shape[contact.floor], pose, along);
    } else {
      const bool floor_is_a = scene_.batch.composite[contact.pair].a == contact.floor;
      most = highest_of_parts(contact, along, floor_is_a);
      if (floor_is_a) most += along.dot(apart);
    }
    // Rest offsets move the surface out or in. If it moves in, corners move farther than faces do.
    const double rest = scene_.offsets.of(contact.floor).rest;
    return most + (rest < 0.0 ? rest * (kRegionCosine + kRegionSine) : rest);
  }

  /// As `highest`, relative to the position of body a of the pair.
  [[nodiscard]] double highest_of_parts(const FloorContact& contact, const Vec& along,
                                        bool floor_is_a) const noexcept {
    const PrimitivePairs& parts = scene_.batch.parts->pairs;
    const NarrowResult& answers = scene_.batch.parts->answers;
    const ShapeTables tables = parts.tables(scene_.shapes);
    const auto highest_of = [&](std::uint32_t k) {
      const std::uint32_t primitive = floor_is_a ? parts.pairs[k].a : parts.pairs[k].b;
      return highest(tables, parts.shapes[primitive], parts.poses[primitive], along);
    };
    if (contact.source == FloorContact::Source::part) {
      return highest_of(answers.pair_of(contact.answer));
    }
    double most = -mid::kInfinity;
    const Vec normal = floor_is_a ? Vec(Vec::Map(contact.normal)) : Vec(-Vec::Map(contact.normal));
    for (std::uint32_t k = parts.first[contact.pair]; k < parts.first[contact.pair + 1]; ++k) {
      const std::uint32_t at = scene_.batch.parts->slot[k];
      const Vec own(answers.normal(0)[at], answers.normal(1)[at], answers.normal(2)[at]);
      const bool is_in_region =
          answers.distance()[at] <= limit_ && own.dot(normal) >= kRegionCosine;
      if (is_in_region) most = std::max(most, highest_of(k));
    }
    return most;
  }

  [[nodiscard]] static double highest(const ShapeTables& tables, ShapeId shape, const Pose& pose,
                                      const Vec& along) noexcept {
    const Vec own = as_eigen(rotation_of(scale_to_unit_max(pose.orientation))).transpose() * along;
    return along.dot(as_eigen(pose.position)) + mid::extent(tables, shape, own).high;
  }

  const SceneState& scene_;
  double radius_;
  double limit_;
};

/// Groups the contacts of one body by their normals. Contacts that have the same normal are never
/// seams of each other, so a plate on n tiles takes O(n).
class FloorGroups {
 public:
  /// `order`: scratch, one number for each contact.
  FloorGroups(std::span<FloorContact> contacts, std::uint32_t* order) noexcept
      : contacts_(contacts), order_(order) {
    for (FloorContact& contact : contacts_) {
      contact.group = group_of(Vec::Map(contact.normal));
      ++end_[contact.group];
    }
    for (std::size_t g = 1; g < count_; ++g) end_[g] += end_[g - 1];
    for (std::size_t i = contacts_.size(); i-- > 0;) {
      order_[--end_[contacts_[i].group]] = static_cast<std::uint32_t>(i);
    }
    // end_[g] was decremented to the start of group g: set it to the start of the next group.
    for (std::size_t g = 0; g < count_; ++g) {
      end_[g] = g + 1 < count_ ? end_[g + 1] : static_cast<std::uint32_t>(contacts_.size());
    }
  }

  /// True if another contact, which was not dropped, is a floor for `one`.
  [[nodiscard]] bool is_seam_of_any(const FloorContact& one,
                                    const GhostContactTest& judge) const noexcept {
    std::uint32_t at = 0;
    for (std::size_t g = 0; g < count_; at = end_[g++]) {
      if (!may_be_floor(g, Vec::Map(one.normal))) continue;
      for (std::uint32_t i = at; i < end_[g]; ++i) {
        const FloorContact& floor = contacts_[order_[i]];
        if (floor.source != FloorContact::Source::dropped && judge.is_ghost_contact(one, floor)) {
          return true;
        }
      }
    }
    return false;
  }

 private:
  /// The last group takes all normals that fit no other group.
  static constexpr std::size_t kMaxGroups = 32;
  /// Largest difference of a contact's normal from its group's normal, and an upper bound on the
  /// error of a cosine that is computed with the group's normal.
  static constexpr double kSameNormal = 1e-3;
  static constexpr double kCosineSlack = 1.001e-3;

  [[nodiscard]] std::uint8_t group_of(const Vec& normal) noexcept {
    std::size_t g = 0;
    for (; g < count_ && g + 1 < kMaxGroups; ++g) {
      if ((normal - normal_[g]).squaredNorm() <= kSameNormal * kSameNormal) break;
    }
    if (g == count_) normal_[count_++] = normal;
    return static_cast<std::uint8_t>(g);
  }

  [[nodiscard]] bool may_be_floor(std::size_t group, const Vec& normal) const noexcept {
    if (group + 1 == kMaxGroups) return true;
    const double cosine = normal_[group].dot(normal);
    return cosine < kRegionCosine + kCosineSlack && cosine >= kOppositeCosine - kCosineSlack;
  }

  std::span<FloorContact> contacts_;
  std::uint32_t* order_;
  std::size_t count_ = 0;
  Vec normal_[kMaxGroups];
  std::uint32_t end_[kMaxGroups] = {};
};

}  // namespace

/// Converts the points of manifolds to points on the fixed body's surface.
class ContactFilters::FloorWriter {
 public:
  /// `index`: of the pair in its list.
  FloorWriter(const SceneState& scene, const BodyPair& pair, std::uint32_t index) noexcept
      : floor_is_a_(scene.body_state[pair.a] == BodyState::fixed) {
    contact_.pair = index;
    contact_.body = floor_is_a_ ? pair.b : pair.a;
    contact_.floor = floor_is_a_ ? pair.a : pair.b;
    const Vec from = as_eigen(scene.pose[pair.a].position);
    from_ = floor_is_a_ ? Vec(from - as_eigen(scene.pose[pair.b].position)) : Vec(Vec::Zero());
  }

  void begin(FloorContact::Source source, std::uint32_t answer, double distance,
             const Vec& normal) noexcept {
    contact_.source = source;
    contact_.answer = answer;
    contact_.distance = distance;
    contact_.count = contact_.deepest = 0;
    Vec::Map(contact_.normal) = floor_is_a_ ? normal : Vec(-normal);
  }
  /// Adds a point that is halfway between the surfaces, relative to the position of body a.
  void add(const Vec& halfway, double depth) noexcept {
    if (contact_.count == 0 || depth > most_) contact_.deepest = contact_.count;
    if (contact_.count == 0 || depth > most_) most_ = depth;
    Vec::Map(contact_.point[contact_.count++]) =
        from_ + halfway + 0.5 * depth * Vec::Map(contact_.normal);
  }
  [[nodiscard]] const FloorContact& contact() const noexcept { return contact_; }

 private:
  bool floor_is_a_;
  Vec from_;
  FloorContact contact_{};
  double most_ = 0.0;
};

bool ContactFilters::list_floor_answer(const NarrowResult& answers, FloorContact::Source source,
                                       std::uint32_t at, const double* offset,
                                       FloorWriter& writer) {
  const double distance = answers.distance()[at];
  if (!(distance <= call_.limit)) return true;
  const Vec normal(answers.normal(0)[at], answers.normal(1)[at], answers.normal(2)[at]);
  const Vec from = offset != nullptr ? Vec(Vec::Map(offset)) : Vec(Vec::Zero());
  writer.begin(source, at, distance, normal);
  if (call_.level == ContactLevel::distance) {
    const Vec on_a(answers.point(0)[at], answers.point(1)[at], answers.point(2)[at]);
    writer.add(from + on_a + 0.5 * distance * normal, -distance);
  } else {
    for (std::uint32_t i = 0; i < answers.contact_count()[at]; ++i) {
      const ContactPoint point = answers.contact(answers.contact_first()[at] + i);
      writer.add(from + Vec(as_eigen(point.position).cast<double>()),
                 static_cast<double>(point.depth));
    }
  }
  return scene_.batch.floor_contacts.push_back(writer.contact());
}

bool ContactFilters::list_floor_contacts() {
  scene_.batch.floor_contacts.clear();
  for (std::uint32_t i = 0; i < scene_.batch.convex.size(); ++i) {
    if (!call_.is_floor_pair(scene_.batch.convex[i])) continue;
    FloorWriter writer(scene_, scene_.batch.convex[i], i);
    if (!list_floor_answer(scene_.batch.answers, FloorContact::Source::convex, i, nullptr,
                           writer)) {
      return false;
    }
  }
  for (std::uint32_t i = 0; i < scene_.batch.composite.size(); ++i) {
    if (!call_.is_floor_pair(scene_.batch.composite[i])) continue;
    FloorWriter writer(scene_, scene_.batch.composite[i], i);
    if (call_.reduces ? !list_floor_regions(i, writer) : !list_floor_parts(i, writer)) return false;
  }
  return true;
}

bool ContactFilters::list_floor_parts(std::uint32_t pair, FloorWriter& writer) {
  const PrimitivePairs& parts = scene_.batch.parts->pairs;
  for (std::uint32_t k = parts.first[pair]; k < parts.first[pair + 1]; ++k) {
    if (!list_floor_answer(scene_.batch.parts->answers, FloorContact::Source::part,
                           scene_.batch.parts->slot[k],
                           parts.poses[parts.pairs[k].a].position.data(), writer)) {
      return false;
    }
  }
  return true;
}

bool ContactFilters::list_floor_regions(std::uint32_t pair, FloorWriter& writer) {
  const std::uint32_t first = scene_.batch.parts->regions.first[pair];
  for (std::uint32_t k = first; k < first + scene_.batch.parts->regions.count[pair]; ++k) {
    const ContactRegion& region = scene_.batch.parts->regions.regions[k];
    writer.begin(FloorContact::Source::region, k, region.distance, Vec::Map(region.normal));
    for (const ContactPoint& point : std::span(region.point, region.count)) {
      writer.add(as_eigen(point.position).cast<double>(), static_cast<double>(point.depth));
    }
    if (!scene_.batch.floor_contacts.push_back(writer.contact())) return false;
  }
  return true;
}

void ContactFilters::drop(const FloorContact& contact) noexcept {
  const double beyond = std::nextafter(call_.limit, std::numeric_limits<double>::max());
  if (contact.source == FloorContact::Source::convex) {
    NarrowColumns::of(scene_.batch.answers).distance[contact.answer] = beyond;
  } else if (contact.source == FloorContact::Source::part) {
    NarrowColumns::of(scene_.batch.parts->answers).distance[contact.answer] = beyond;
  } else {
    scene_.batch.parts->regions.regions[contact.answer].count = 0;
  }
}

bool ContactFilters::drop_ghost_contacts() {
  if (!scene_.options.suppress_ghost_contacts || call_.level < ContactLevel::distance) return true;
  if (!list_floor_contacts()) return false;
  Column<FloorContact>& all = scene_.batch.floor_contacts;
  if (!scene_.batch.floor_order.resize(all.size())) return false;
  // Groups contacts by body, in the order in which they were listed.
  const auto is_before = [](const FloorContact& one, const FloorContact& other) {
    return std::tuple(one.body, one.source, one.answer) <
           std::tuple(other.body, other.source, other.answer);
  };
  if (!std::is_sorted(all.begin(), all.end(), is_before)) {
    std::sort(all.begin(), all.end(), is_before);
  }
  for (FloorContact* first = all.begin(); first != all.end();) {
    FloorContact* const end = std::find_if(
        first, all.end(), [&](const FloorContact& other) { return other.body != first->body; });
    drop_ghost_contacts_of(first, end);
    first = end;
  }
  close_regions();
  return true;
}

// Drops the seams of one body.
void ContactFilters::drop_ghost_contacts_of(FloorContact* first, FloorContact* end) noexcept {
  const double radius = scene_.radius(first->body);
  if (end - first < 2 || !std::isfinite(radius)) return;
  const FloorGroups groups({first, end}, scene_.batch.floor_order.data());
  const GhostContactTest judge(scene_, radius, call_.limit);
  for (FloorContact* one = first; one != end; ++one) {
    if (!groups.is_seam_of_any(*one, judge)) continue;
    drop(*one);
    one->source = FloorContact::Source::dropped;
  }
}

// Removes regions that were dropped, which have no points.
void ContactFilters::close_regions() noexcept {
  if (!call_.reduces || scene_.batch.composite.empty()) return;
  ContactRegions& all = scene_.batch.parts->regions;
  for (std::uint32_t i = 0; i < scene_.batch.composite.size(); ++i) {
    ContactRegion* const first = all.regions.data() + all.first[i];
    const ContactRegion* const end = std::remove_if(
        first, first + all.count[i], [](const ContactRegion& region) { return region.count == 0; });
    all.count[i] = static_cast<std::uint32_t>(end - first);
  }
}

}  // namespace winnow
