// Contact reduction (mid::reduce_contacts): merges the manifolds of each pair of bodies into
// regions of nearly parallel normals, and chooses the points of each region
// (manifold/region_points.h). Called by the scene after `correct_surface_contacts`, unless
// SceneOptions::part_manifolds is set. In this file, an answer is the narrow-phase result of one
// pair of primitives.

#include <winnow/core/volumes.h>
#include "core/numbers/rotation.h"
#include "core/numbers/rounding.h"
#include "core/sort/parallel_ranges.h"
#include "pipeline/composites/composites.h"
#include "pipeline/manifold/region_points.h"
#include "pipeline/narrow/answer_slots.h"
#include "pipeline/solver/manifold.h"
#include "pipeline/solver/problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace winnow::mid {
namespace {

constexpr std::size_t kBodyPairsPerRange = 64;
constexpr std::uint32_t kNoRegion = ~0U;

// Unit normals that differ by less count as equal. Relative distance by which a float position in a
// triangle may be outside of it, or above or below its plane.
constexpr double kSameFace = 1e-9;
constexpr double kBesideSlack = 4e-6;
// A point counts as in the middle of its gap if its distance from the middle, relative to the
// sizes, is at most this. kTiedDepth is included because a point may have been given the depth of
// another point.
constexpr double kGapSlack = kBesideSlack + kTiedDepth;

// Direction for breaking ties between points that are equally far out; not along a symmetry axis of
// regular shapes.
constexpr double kOffCorners[3] = {0.3624, 0.932, 0.65};

/// The mesh triangle of a contact along the normal of its face. Distinguishes contacts with the
/// face from contacts with an internal edge, to which `correct_surface_contacts` gave the same
/// normal. For all other contacts it is default-constructed: then `has` is always true.
class FaceOfMesh {
 public:
  FaceOfMesh() noexcept = default;
  /// `at`: position of the triangle, in the frame of the contacts. `normal`: contact normal,
  /// towards the triangle.
  FaceOfMesh(const TriangleShape& triangle, const Vec& at, const Vec& normal) noexcept
      : normal_(normal) {
    for (int i = 0; i < 3; ++i) corner_[i] = at + as_eigen(triangle.vertex[i]);
    for (int i = 0; i < 3; ++i) side_[i] = corner_[(i + 1) % 3] - corner_[i];
    const Vec face = side_[0].cross(side_[1]).normalized();
    turn_ = face.dot(normal) < 0.0 ? -1.0 : 1.0;
    is_face_ = (face * turn_ - normal).squaredNorm() <= kSameFace * kSameFace;
  }

  [[nodiscard]] bool is_face() const noexcept { return is_face_; }

  /// Returns whether a contact is over the triangle and, if the shapes are apart, at half of its
  /// gap from the plane of the triangle. `from`: origin of its position.
  [[nodiscard]] bool has(const ContactPoint& contact, const double* from) const noexcept {
    if (!is_face_) return true;
    const Vec at = as_eigen(contact.position).cast<double>() + Eigen::Map<const Vec>(from);
    const double gap = -static_cast<double>(contact.depth);
    const double height = normal_.dot(corner_[0] - at);
    return (gap <= 0.0 || std::abs(height - 0.5 * gap) <= kGapSlack * reach(at, 0)) && is_under(at);
  }

  /// True if the projection of a point along the normal is in the triangle.
  [[nodiscard]] bool is_under(const Vec& at) const noexcept {
    for (int i = 0; i < 3; ++i) {
      const double inward = turn_ * normal_.dot(side_[i].cross(at - corner_[i]));
      if (inward < -kBesideSlack * reach(at, i) * side_[i].norm()) return false;
    }
    return true;
  }

 private:
  [[nodiscard]] double reach(const Vec& at, int i) const noexcept {
    return side_[i].norm() + at.norm() + (at - corner_[i]).norm();
  }

  Vec corner_[3];
  Vec side_[3];
  Vec normal_;
  double turn_ = 1.0;
  bool is_face_ = false;
};

/// Vertices of the supporting feature of a primitive along the normal of a region.
class SupportCorners {
 public:
  [[nodiscard]] bool is_of(std::uint32_t primitive) const noexcept {
    return primitive == primitive_;
  }
  /// `unit` and `from`: scale and origin of the patch.
  void set(std::uint32_t primitive, const SupportingFeature& patch, double unit,
           const double* from) noexcept {
    primitive_ = primitive;
    count_ = patch.count;
    for (std::uint32_t i = 0; i < count_; ++i) {
      corner_[i] = Eigen::Map<const Vec>(patch.vertex[i]) * unit + Eigen::Map<const Vec>(from);
    }
  }
  [[nodiscard]] bool any_over(const FaceOfMesh& face) const noexcept {
    return std::any_of(corner_, corner_ + count_, [&](const Vec& at) { return face.is_under(at); });
  }

 private:
  std::uint32_t primitive_ = ~0U;
  std::uint32_t count_ = 0;
  Vec corner_[solver::SupportingPatch::kRoom];
};

class ManifoldReduction {
 public:
  ManifoldReduction(const ShapePool& shapes, const PrimitivePairs& pairs,
                    const NarrowResult& answers, const PairMargins& margins,
                    ContactRegions& out) noexcept
      : tables_(pairs.tables(shapes)),
        pairs_(pairs),
        answers_(answers),
        margins_(margins),
        out_(out) {}

  [[nodiscard]] Status run(const Execution& execution) noexcept;

 private:
  /// Answers of one pair of bodies that are within the margin, and the region of each.
  struct Members {
    std::span<std::uint32_t> answer;
    std::span<std::uint32_t> region;
    /// Contact margin of the pair of bodies.
    double margin;
  };

  void find_members(std::size_t bodies) noexcept;
  void reduce_bodies(std::size_t bodies) noexcept;
  [[nodiscard]] double tie_of(const Members& members) const noexcept;
  [[nodiscard]] std::size_t leader_of(const Members& members, double tie) const noexcept;
  [[nodiscard]] std::size_t gather(const Members& members, std::size_t leader, std::uint32_t number,
                                   ContactRegion& region) const noexcept;
  void keep_all(std::uint32_t answer, ContactRegion& region) const noexcept;
  void choose(const Members& members, std::uint32_t number, double tie,
              ContactRegion& region) const noexcept;
  [[nodiscard]] Vec direction_of(const Members& members, std::uint32_t number) const noexcept;
  void add_contacts(std::uint32_t answer, double margin, const ContactRegion& region,
                    SupportCorners& corners, RegionPoints& points) const noexcept;
  [[nodiscard]] bool has_corner_over(std::uint32_t answer, const FaceOfMesh& face,
                                     const ContactRegion& region,
                                     SupportCorners& corners) const noexcept;
  void add_corners(std::uint32_t answer, double margin, const FaceOfMesh& face,
                   RegionPoints& points) const noexcept;
  [[nodiscard]] FaceOfMesh face_of(std::uint32_t answer) const noexcept;
  [[nodiscard]] solver::Problem problem_of(std::uint32_t answer) const noexcept;

  [[nodiscard]] const BodyPair& primitives(std::uint32_t answer) const noexcept {
    return pairs_.pairs[answers_.pair_of(answer)];
  }
  [[nodiscard]] const double* offset(std::uint32_t answer) const noexcept {
    return pairs_.poses[primitives(answer).a].position.data();
  }
  [[nodiscard]] Vec normal(std::uint32_t answer) const noexcept {
    return {answers_.normal(0)[answer], answers_.normal(1)[answer], answers_.normal(2)[answer]};
  }
  /// Calls visit(contact) for every contact of an answer.
  template <typename Visit>
  void visit_contacts(std::uint32_t answer, Visit&& visit) const noexcept {
    const std::uint32_t first = answers_.contact_first()[answer];
    for (std::uint32_t i = 0; i < answers_.contact_count()[answer]; ++i) {
      visit(answers_.contact(first + i));
    }
  }
  [[nodiscard]] std::uint32_t* column(std::size_t which) const noexcept {
    return out_.scratch.data() + which * pairs_.pairs.size();
  }

  ShapeTables tables_;
  const PrimitivePairs& pairs_;
  const NarrowResult& answers_;
  const PairMargins& margins_;
  ContactRegions& out_;
};

Status ManifoldReduction::run(const Execution& execution) noexcept {
  const std::size_t bodies = pairs_.first.empty() ? 0 : pairs_.first.size() - 1;
  if (!out_.scratch.resize(3 * pairs_.pairs.size()) || !out_.first.resize(bodies + 1) ||
      !out_.count.resize(bodies)) {
    return Status::out_of_memory;
  }
  find_slots(answers_, execution, column(0));
  for_each_range(execution, bodies, kBodyPairsPerRange, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) find_members(i);
  });
  out_.first[0] = 0;
  for (std::size_t i = 0; i < bodies; ++i) out_.first[i + 1] = out_.first[i] + out_.count[i];
  if (!out_.regions.resize(out_.first[bodies])) return Status::out_of_memory;
  for_each_range(execution, bodies, kBodyPairsPerRange, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) reduce_bodies(i);
  });
  return Status::ok;
}

void ManifoldReduction::find_members(std::size_t bodies) noexcept {
  const std::uint32_t* const slot = column(0);
  std::uint32_t* const member = column(1) + pairs_.first[bodies];
  const double margin = margins_.of(bodies);
  std::uint32_t count = 0;
  for (std::uint32_t i = pairs_.first[bodies]; i < pairs_.first[bodies + 1]; ++i) {
    if (answers_.distance()[slot[i]] <= margin) member[count++] = slot[i];
  }
  out_.count[bodies] = count;
}

void ManifoldReduction::reduce_bodies(std::size_t bodies) noexcept {
  const std::size_t at = pairs_.first[bodies];
  const std::size_t count = out_.count[bodies];
  const Members members{{column(1) + at, count}, {column(2) + at, count}, margins_.of(bodies)};
  std::fill(members.region.begin(), members.region.end(), kNoRegion);
  const double tie = tie_of(members);
  ContactRegion* const regions = out_.regions.data() + out_.first[bodies];
  std::uint32_t number = 0;
  for (std::size_t left = count; left != 0; ++number) {
    const std::size_t leader = leader_of(members, tie);
    const std::size_t gathered = gather(members, leader, number, regions[number]);
    if (gathered == 1) {
      keep_all(members.answer[leader], regions[number]);
    } else {
      choose(members, number, tie, regions[number]);
    }
    left -= gathered;
  }
  out_.count[bodies] = number;
}

double ManifoldReduction::tie_of(const Members& members) const noexcept {
  double reach = 0.0;
  for (const std::uint32_t answer : members.answer) {
    const double* const from = offset(answer);
    visit_contacts(answer, [&](const ContactPoint& contact) {
      for (int k = 0; k < 3; ++k) {
        reach = std::max(reach, std::abs(static_cast<double>(contact.position[k]) + from[k]));
      }
    });
  }
  return kRegionTie * reach;
}

// Returns the deepest answer without a region. Among answers whose distances exceed the least by at
// most `tie`, it returns the first one, so that rounding does not choose the normal of a resting
// face.
std::size_t ManifoldReduction::leader_of(const Members& members, double tie) const noexcept {
  double least = kInfinity;
  for (std::size_t i = 0; i < members.answer.size(); ++i) {
    if (members.region[i] != kNoRegion) continue;
    least = std::min(least, answers_.distance()[members.answer[i]]);
  }
  std::size_t leader = 0;
  while (members.region[leader] != kNoRegion ||
         answers_.distance()[members.answer[leader]] > least + tie) {
    ++leader;
  }
  return leader;
}

// Adds to the leader's region all answers without a region whose normals are within the angle of
// kRegionCosine of its normal. Returns their number, including the leader.
std::size_t ManifoldReduction::gather(const Members& members, std::size_t leader,
                                      std::uint32_t number, ContactRegion& region) const noexcept {
  const std::uint32_t lead = members.answer[leader];
  const Vec along = normal(lead);
  for (int k = 0; k < 3; ++k) region.normal[k] = along[k];
  region.part[0] = pairs_.part[primitives(lead).a];
  region.part[1] = pairs_.part[primitives(lead).b];
  region.distance = answers_.distance()[lead];
  region.error_bound = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < members.answer.size(); ++i) {
    const std::uint32_t answer = members.answer[i];
    if (members.region[i] != kNoRegion) continue;
    if (i != leader && !(normal(answer).dot(along) >= kRegionCosine)) continue;
    members.region[i] = number;
    region.distance = std::min(region.distance, answers_.distance()[answer]);
    region.error_bound = std::max(region.error_bound, answers_.error_bound()[answer]);
    ++count;
  }
  return count;
}

void ManifoldReduction::keep_all(std::uint32_t answer, ContactRegion& region) const noexcept {
  const double* const from = offset(answer);
  region.count = 0;
  visit_contacts(answer, [&](const ContactPoint& contact) {
    ContactPoint& point = region.point[region.count++];
    point = contact;
    for (int k = 0; k < 3; ++k) {
      point.position[k] = static_cast<float>(static_cast<double>(contact.position[k]) + from[k]);
    }
    point.feature = feature_among_parts(contact.feature, region.part);
    if (point.depth > region.point[0].depth) std::swap(point, region.point[0]);
  });
}

void ManifoldReduction::choose(const Members& members, std::uint32_t number, double tie,
                               ContactRegion& region) const noexcept {
  RegionPoints points(region.normal, direction_of(members, number).data(), tie);
  SupportCorners corners;
  for (std::size_t i = 0; i < members.answer.size(); ++i) {
    if (members.region[i] != number) continue;
    add_contacts(members.answer[i], members.margin, region, corners, points);
  }
  region.count = points.choose(region.point);
}

// Direction for breaking ties. If all pairs of the region share one primitive, it is fixed in the
// frame of that primitive, else in the world.
Vec ManifoldReduction::direction_of(const Members& members, std::uint32_t number) const noexcept {
  const Vec off = Eigen::Map<const Vec>(kOffCorners);
  const BodyPair* first = nullptr;
  bool is_one[2] = {true, true};
  for (std::size_t i = 0; i < members.answer.size(); ++i) {
    if (members.region[i] != number) continue;
    const BodyPair& of = primitives(members.answer[i]);
    first = first == nullptr ? &of : first;
    is_one[0] = is_one[0] && of.a == first->a;
    is_one[1] = is_one[1] && of.b == first->b;
  }
  if (!is_one[0] && !is_one[1]) return off;
  const std::uint32_t one = is_one[0] ? first->a : first->b;
  const Mat turned = rotation_of(scale_to_unit_max(pairs_.poses[one].orientation));
  return turned * off;
}

FaceOfMesh ManifoldReduction::face_of(std::uint32_t answer) const noexcept {
  const BodyPair& of = primitives(answer);
  for (const std::uint32_t primitive : {of.b, of.a}) {
    const ShapeId shape = pairs_.shapes[primitive];
    if (shape.kind() != ShapeKind::triangle ||
        pairs_.active_edges[shape.index()] == PrimitivePairs::kAllActive) {
      continue;
    }
    return {tables_.triangles[shape.index()], as_eigen(pairs_.poses[primitive].position),
            primitive == of.b ? normal(answer) : Vec(-normal(answer))};
  }
  return {};
}

solver::Problem ManifoldReduction::problem_of(std::uint32_t answer) const noexcept {
  const BodyPair& of = primitives(answer);
  solver::Problem problem;
  prepare(tables_, pairs_.shapes[of.a], pairs_.poses[of.a], pairs_.shapes[of.b], pairs_.poses[of.b],
          false, problem);
  return problem;
}

// A full manifold may have dropped corners that, with other manifolds, span the largest area. A
// manifold of shapes that are apart has only the points near the closest edge. In these cases add
// all corners. A contact beside its triangle is closer to a neighbouring triangle: add_beside keeps
// it only if it is deeper than all contacts over the triangles of the region.
void ManifoldReduction::add_contacts(std::uint32_t answer, double margin,
                                     const ContactRegion& region, SupportCorners& corners,
                                     RegionPoints& points) const noexcept {
  const BodyPair& of = primitives(answer);
  const std::uint32_t part[2] = {pairs_.part[of.a], pairs_.part[of.b]};
  const double* const from = offset(answer);
  const FaceOfMesh face = face_of(answer);
  const bool is_full = answers_.contact_count()[answer] == kManifoldPoints;
  visit_contacts(answer, [&](const ContactPoint& contact) {
    if (face.has(contact, from)) return points.add(contact, from, part);
    points.add_beside(contact, from, part);
  });
  const bool is_apart = face.is_face() && answers_.distance()[answer] > 0.0;
  if (is_full || (is_apart && has_corner_over(answer, face, region, corners))) {
    add_corners(answer, margin, face, points);
  }
}

// True if a supporting vertex of the other primitive is over the triangle.
bool ManifoldReduction::has_corner_over(std::uint32_t answer, const FaceOfMesh& face,
                                        const ContactRegion& region,
                                        SupportCorners& corners) const noexcept {
  const BodyPair& of = primitives(answer);
  const bool second = pairs_.shapes[of.b].kind() == ShapeKind::triangle;
  const std::uint32_t other = second ? of.a : of.b;
  if (!corners.is_of(other)) {
    const solver::Problem problem = problem_of(answer);
    const Vec along = Eigen::Map<const Vec>(region.normal);
    const solver::SupportingPatch patch = second ? solver::SupportingPatch(problem.a, along)
                                                 : solver::SupportingPatch(problem.b, Vec(-along));
    corners.set(other, patch.view(), unscaled(problem, 1.0), offset(answer));
  }
  return corners.any_over(face);
}

// Adds all corners of the intersection of the two supporting features, seen along the normal of the
// manifold. None gets deeper than the manifold.
void ManifoldReduction::add_corners(std::uint32_t answer, double margin, const FaceOfMesh& face,
                                    RegionPoints& points) const noexcept {
  const BodyPair& of = primitives(answer);
  const solver::Problem problem = problem_of(answer);
  ContactPoint corners[kMaxIntersectionCorners];
  const double reach = std::min(std::ldexp(margin, -problem.exponent), 8.0);
  const std::uint32_t count = intersection_corners(problem, normal(answer), reach, corners);
  float deepest = -std::numeric_limits<float>::infinity();
  visit_contacts(answer,
                 [&](const ContactPoint& contact) { deepest = std::max(deepest, contact.depth); });
  const auto scaled = [&](float x) {
    return finite_float(unscaled(problem, static_cast<double>(x)));
  };
  // If the features overlap deeper than the manifold, the manifold belongs to other features.
  const double slack = kBesideSlack * unscaled(problem, problem.size);
  if (count == 0 || static_cast<double>(scaled(corners[0].depth) - deepest) > slack) return;
  const std::uint32_t part[2] = {pairs_.part[of.a], pairs_.part[of.b]};
  for (ContactPoint& corner : std::span(corners, count)) {
    for (float& x : corner.position) x = scaled(x);
    corner.depth = std::min(scaled(corner.depth), deepest);
    const bool is_near = static_cast<double>(corner.depth) >= -margin;
    if (is_near && face.has(corner, offset(answer))) points.add(corner, offset(answer), part);
  }
}

}  // namespace

Status reduce_contacts(const ShapePool& shapes, const PrimitivePairs& pairs,
                       const NarrowResult& answers, const PairMargins& margins,
                       const Execution& execution, ContactRegions& out) {
  out.clear();
  if (answers.size() != 0 && answers.level() != ContactLevel::manifold) {
    return Status::invalid_argument;
  }
  const Status status = answers.size() == pairs.pairs.size()
                            ? ManifoldReduction(shapes, pairs, answers, margins, out).run(execution)
                            : Status::invalid_argument;
  if (status != Status::ok) out.clear();
  return status;
}

}  // namespace winnow::mid
