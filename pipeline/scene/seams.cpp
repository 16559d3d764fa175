// Fixed bodies that lie flush are one floor: contacts with the seams between them are left out.
//
// A manifold of a body with a fixed one has a plane: through the point of the fixed surface in
// which the body is deepest, across the normal. The body lies above that plane, but for the depth.
// A contact with another fixed body is one with a side or an edge of a seam if
// - it is no deeper, and along another normal,
// - all its points lie in the plane or below it, and
// - the other body does not rise above the plane there: the tangent plane of the contact cuts the
//   plane in a line, and the other body lies below the plane through that line that rises, away
//   from the body, by the angle by which normals of one surface may differ.
// A wall, a kerb, a step and the foot of a slope rise above the plane where the body touches them,
// however high above it the points are. Flush bodies are as deep along the first one's normal, and
// the shortest way out of the other is no longer, so that it is the less deep one that goes, and no
// two put each other out.

#include "pipeline/scene/collision.h"
#include "pipeline/shapes/extent.h"
#include "pipeline/shapes/frame.h"

#include <winnow/core/eigen.h>
#include <winnow/core/rotation.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace winnow {
namespace {

using mid::Vec;

/// A share of the body's radius: what rises so far above a plane is in it.
constexpr double kPlaneShare = 1e-3;
/// A share of the radius: of two that are equally deep but for this, either may be the floor.
constexpr double kEqualShare = 1e-6;
/// The cosine of the angle between two normals: a ceiling is no seam.
constexpr double kOppositeCosine = -0.5;
/// The sine of the angle that kRegionCosine is the cosine of.
constexpr double kRegionSine = 0.08715574274765817;

[[nodiscard]] bool is_floor_pair(const SceneState& scene, const BodyPair& pair) noexcept {
  return scene.motion[pair.a] == Motion::fixed || scene.motion[pair.b] == Motion::fixed;
}

/// Whether a contact of a body is one with a seam.
class SeamJudge {
 public:
  /// `limit`: answers about parts that are no farther apart are contacts.
  SeamJudge(const SceneState& scene, double radius, double limit) noexcept
      : scene_(scene), radius_(radius), limit_(limit) {}

  /// True if `other` holds the body where `floor` holds it already.
  [[nodiscard]] bool is_seam(const FloorContact& other, const FloorContact& floor) const noexcept {
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
  /// True if the body of a contact rises above the plane up . x = `plane` where it is touched.
  [[nodiscard]] bool rises(const FloorContact& contact, const Vec& up,
                           double plane) const noexcept {
    const Vec normal = Vec::Map(contact.normal);
    const double cosine = up.dot(normal);
    const Vec side = normal - cosine * up;
    const double sine = side.norm();
    const Vec steepest = kRegionCosine * up + kRegionSine / sine * side;
    // From the point of contact up its tangent plane to the other plane.
    const Vec point = Vec::Map(contact.point[contact.deepest]);
    const double climb = (kRegionCosine - kRegionSine * cosine / sine) * (plane - up.dot(point));
    return highest(contact, steepest) > steepest.dot(point) + climb + kPlaneShare * radius_;
  }

  /// How far the fixed body of a contact, or those of its parts that are touched, reaches along a
  /// unit direction, as seen from the dynamic body's position.
  [[nodiscard]] double highest(const FloorContact& contact, const Vec& along) const noexcept {
    const Vec apart = Vec::Map(scene_.pose[contact.floor].position) -
                      Vec::Map(scene_.pose[contact.body].position);
    double most = -mid::kInfinity;
    if (contact.source == FloorContact::Source::convex) {
      Pose pose = scene_.pose[contact.floor];
      Vec::Map(pose.position) = apart;
      most = highest(scene_.shapes.tables(), scene_.shape[contact.floor], pose, along);
    } else {
      const bool floor_is_a = scene_.composite[contact.pair].a == contact.floor;
      most = highest_of_parts(contact, along, floor_is_a);
      if (floor_is_a) most += along.dot(apart);
    }
    // Surfaces that have moved out, or in: corners that move in go farther than sides do.
    const double rest = scene_.offsets_of(contact.floor).rest;
    return most + (rest < 0.0 ? rest * (kRegionCosine + kRegionSine) : rest);
  }

  /// The same from the position of body a of the pair.
  [[nodiscard]] double highest_of_parts(const FloorContact& contact, const Vec& along,
                                        bool floor_is_a) const noexcept {
    const PrimitivePairs& parts = scene_.parts->pairs;
    const NarrowResult& answers = scene_.parts->answers;
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
      const std::uint32_t at = scene_.parts->slot[k];
      const Vec own(answers.normal(0)[at], answers.normal(1)[at], answers.normal(2)[at]);
      const bool is_in_region =
          answers.distance()[at] <= limit_ && own.dot(normal) >= kRegionCosine;
      if (is_in_region) most = std::max(most, highest_of(k));
    }
    return most;
  }

  [[nodiscard]] static double highest(const ShapeTables& tables, ShapeId shape, const Pose& pose,
                                      const Vec& along) noexcept {
    const Vec own = as_eigen(rotation_of(tame(pose.orientation))).transpose() * along;
    return along.dot(Vec::Map(pose.position)) + mid::extent(tables, shape, own).high;
  }

  const SceneState& scene_;
  double radius_;
  double limit_;
};

/// Contacts of one body by their normals. Most are with the same plane, of which none is a seam of
/// another: a plate on n tiles takes O(n).
class FloorGroups {
 public:
  /// `order`: room for a number for each contact.
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
    // Each began where the one before ended.
    for (std::size_t g = 0; g < count_; ++g) {
      end_[g] = g + 1 < count_ ? end_[g + 1] : static_cast<std::uint32_t>(contacts_.size());
    }
  }

  /// Whether one of the others that were not dropped is a floor to it.
  [[nodiscard]] bool is_seam_of_any(const FloorContact& one,
                                    const SeamJudge& judge) const noexcept {
    std::uint32_t at = 0;
    for (std::size_t g = 0; g < count_; at = end_[g++]) {
      if (!may_be_floor(g, Vec::Map(one.normal))) continue;
      for (std::uint32_t i = at; i < end_[g]; ++i) {
        const FloorContact& floor = contacts_[order_[i]];
        if (floor.source != FloorContact::Source::dropped && judge.is_seam(one, floor)) {
          return true;
        }
      }
    }
    return false;
  }

 private:
  /// The last group takes what no other does.
  static constexpr std::size_t kMostGroups = 32;
  /// Lengths of differences between unit normals of one group, and more than what a cosine with one
  /// of them may be off by.
  static constexpr double kSameNormal = 1e-3;
  static constexpr double kCosineSlack = 1.001e-3;

  [[nodiscard]] std::uint8_t group_of(const Vec& normal) noexcept {
    std::size_t g = 0;
    for (; g < count_ && g + 1 < kMostGroups; ++g) {
      if ((normal - normal_[g]).squaredNorm() <= kSameNormal * kSameNormal) break;
    }
    if (g == count_) normal_[count_++] = normal;
    return static_cast<std::uint8_t>(g);
  }

  [[nodiscard]] bool may_be_floor(std::size_t group, const Vec& normal) const noexcept {
    if (group + 1 == kMostGroups) return true;
    const double cosine = normal_[group].dot(normal);
    return cosine < kRegionCosine + kCosineSlack && cosine >= kOppositeCosine - kCosineSlack;
  }

  std::span<FloorContact> contacts_;
  std::uint32_t* order_;
  std::size_t count_ = 0;
  Vec normal_[kMostGroups];
  std::uint32_t end_[kMostGroups] = {};
};

}  // namespace

/// Takes the points of manifolds, to a point on the fixed body's surface each.
class Collision::FloorWriter {
 public:
  /// Of pair `index` in its list.
  FloorWriter(const SceneState& scene, const BodyPair& pair, std::uint32_t index) noexcept
      : floor_is_a_(scene.motion[pair.a] == Motion::fixed) {
    contact_.pair = index;
    contact_.body = floor_is_a_ ? pair.b : pair.a;
    contact_.floor = floor_is_a_ ? pair.a : pair.b;
    const Vec from = Vec::Map(scene.pose[pair.a].position);
    from_ = floor_is_a_ ? Vec(from - Vec::Map(scene.pose[pair.b].position)) : Vec(Vec::Zero());
  }

  void begin(FloorContact::Source source, std::uint32_t answer, double distance,
             const Vec& normal) noexcept {
    contact_.source = source;
    contact_.answer = answer;
    contact_.distance = distance;
    contact_.count = contact_.deepest = 0;
    Vec::Map(contact_.normal) = floor_is_a_ ? normal : Vec(-normal);
  }
  /// Halfway between the surfaces, from the position of body a.
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

bool Collision::is_carried_over(const BodyPair& pair) const noexcept {
  return !scene_.options.seamless_floors || !is_floor_pair(scene_, pair);
}

bool Collision::list_floor_answer(const NarrowResult& answers, FloorContact::Source source,
                                  std::uint32_t at, const double* offset, FloorWriter& writer) {
  const double distance = answers.distance()[at];
  if (!(distance <= limit_)) return true;
  const Vec normal(answers.normal(0)[at], answers.normal(1)[at], answers.normal(2)[at]);
  const Vec from = offset != nullptr ? Vec(Vec::Map(offset)) : Vec(Vec::Zero());
  writer.begin(source, at, distance, normal);
  if (level_ == ContactLevel::distance) {
    const Vec on_a(answers.point(0)[at], answers.point(1)[at], answers.point(2)[at]);
    writer.add(from + on_a + 0.5 * distance * normal, -distance);
  } else {
    for (std::uint32_t i = 0; i < answers.contact_count()[at]; ++i) {
      const ContactPoint point = answers.contact(answers.contact_first()[at] + i);
      writer.add(from + Vec(Eigen::Map<const Eigen::Vector3f>(point.position).cast<double>()),
                 static_cast<double>(point.depth));
    }
  }
  return scene_.floor_contacts.push_back(writer.contact());
}

bool Collision::list_floor_contacts() {
  scene_.floor_contacts.clear();
  for (std::uint32_t i = 0; i < scene_.convex.size(); ++i) {
    if (!is_floor_pair(scene_, scene_.convex[i])) continue;
    FloorWriter writer(scene_, scene_.convex[i], i);
    if (!list_floor_answer(scene_.answers, FloorContact::Source::convex, i, nullptr, writer)) {
      return false;
    }
  }
  for (std::uint32_t i = 0; i < scene_.composite.size(); ++i) {
    if (!is_floor_pair(scene_, scene_.composite[i])) continue;
    FloorWriter writer(scene_, scene_.composite[i], i);
    if (reduces_ ? !list_floor_regions(i, writer) : !list_floor_parts(i, writer)) return false;
  }
  return true;
}

bool Collision::list_floor_parts(std::uint32_t pair, FloorWriter& writer) {
  const PrimitivePairs& parts = scene_.parts->pairs;
  for (std::uint32_t k = parts.first[pair]; k < parts.first[pair + 1]; ++k) {
    if (!list_floor_answer(scene_.parts->answers, FloorContact::Source::part, scene_.parts->slot[k],
                           parts.poses[parts.pairs[k].a].position, writer)) {
      return false;
    }
  }
  return true;
}

bool Collision::list_floor_regions(std::uint32_t pair, FloorWriter& writer) {
  const std::uint32_t first = scene_.parts->regions.first[pair];
  for (std::uint32_t k = first; k < first + scene_.parts->regions.count[pair]; ++k) {
    const ContactRegion& region = scene_.parts->regions.regions[k];
    writer.begin(FloorContact::Source::region, k, region.distance, Vec::Map(region.normal));
    for (const ContactPoint& point : std::span(region.point, region.count)) {
      writer.add(Eigen::Map<const Eigen::Vector3f>(point.position).cast<double>(),
                 static_cast<double>(point.depth));
    }
    if (!scene_.floor_contacts.push_back(writer.contact())) return false;
  }
  return true;
}

void Collision::drop(const FloorContact& seam) noexcept {
  const double beyond = std::nextafter(limit_, std::numeric_limits<double>::max());
  if (seam.source == FloorContact::Source::convex) {
    scene_.answers.columns().distance[seam.answer] = beyond;
  } else if (seam.source == FloorContact::Source::part) {
    scene_.parts->answers.columns().distance[seam.answer] = beyond;
  } else {
    scene_.parts->regions.regions[seam.answer].count = 0;
  }
}

bool Collision::drop_seams() {
  if (!scene_.options.seamless_floors || level_ < ContactLevel::distance) return true;
  if (!list_floor_contacts()) return false;
  Column<FloorContact>& all = scene_.floor_contacts;
  if (!scene_.floor_order.resize(all.size())) return false;
  // Of a body next to each other, as they were listed.
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
    drop_seams_of(first, end);
    first = end;
  }
  close_regions();
  return true;
}

// Of one body.
void Collision::drop_seams_of(FloorContact* first, FloorContact* end) noexcept {
  const double radius = scene_.radius(first->body);
  if (end - first < 2 || !std::isfinite(radius)) return;
  const FloorGroups groups({first, end}, scene_.floor_order.data());
  const SeamJudge judge(scene_, radius, limit_);
  for (FloorContact* one = first; one != end; ++one) {
    if (!groups.is_seam_of_any(*one, judge)) continue;
    drop(*one);
    one->source = FloorContact::Source::dropped;
  }
}

// Regions that were dropped have no points.
void Collision::close_regions() noexcept {
  if (!reduces_ || scene_.composite.empty()) return;
  ContactRegions& all = scene_.parts->regions;
  for (std::uint32_t i = 0; i < scene_.composite.size(); ++i) {
    ContactRegion* const first = all.regions.data() + all.first[i];
    const ContactRegion* const end = std::remove_if(
        first, first + all.count[i], [](const ContactRegion& region) { return region.count == 0; });
    all.count[i] = static_cast<std::uint32_t>(end - first);
  }
}

}  // namespace winnow
