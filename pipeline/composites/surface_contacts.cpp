// Corrects the contacts of surfaces of triangles (mid::correct_surface_contacts; mid_phase.h
// describes the method): contacts along directions that are not in the normal cones of the surface,
// and contacts from behind one-sided triangles. Called by the scene after the narrow phase and
// before `reduce_contacts`. In this file, an answer is the narrow-phase result of one pair of
// primitives.

#include <winnow/core/volumes.h>
#include <winnow/pipeline/contact_types.h>
#include "core/numbers/rotation.h"
#include "core/numbers/rounding.h"
#include "pipeline/composites/composites.h"
#include "pipeline/composites/patch_contact.h"
#include "pipeline/composites/surface_cones.h"
#include "pipeline/narrow/narrow_columns.h"
#include "pipeline/shapes/extent.h"
#include "pipeline/solver/manifold.h"
#include "pipeline/solver/problem.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace winnow::mid {
namespace {

/// The change of an answer.
enum class Change : std::uint8_t {
  /// None; the answer is within the margin, and its normal is in the normal cones.
  none,
  /// None; the answer is not within the margin.
  apart,
  /// None; the normal is not in the normal cones, but no better one is known.
  doubtful,
  /// The normal is set to the normal of the face, from which it differs by little.
  straighten,
  /// The normal is set to the normal of the face; the distance and its bound stay.
  turn,
  /// As `turn`; then the other shape is clipped against the face.
  clip,
  /// The other shape is clipped along the new normal; without points over the face, the contact is
  /// dropped.
  clip_or_drop,
  /// The normal and the depth are those of the convex patch around the triangle, which contains the
  /// touched point of the patch.
  follow_patch,
  /// As `follow_patch`, for another triangle of the patch: without points over the face, the
  /// contact
  /// is dropped.
  reach_patch,
  /// Found to have no points over the face.
  beside,
  drop,
};

constexpr double kSameNormal = 1e-13;
// A normal whose component towards the back of a triangle is smaller counts as parallel to the
// triangle.
constexpr double kBackNormal = 1e-9;

/// An overlapping pair of a mesh triangle and another shape.
struct FacePair {
  const ShapeTables& tables;
  ShapeId a;
  const Pose& pose_a;
  ShapeId b;
  const Pose& pose_b;
  /// True if the mesh triangle is b.
  bool second;
};

/// Contacts of a triangle along the normal of an answer.
struct FaceContacts {
  ContactPoint points[kManifoldPoints];
  std::uint32_t count = 0;
  /// Depth of the first, deepest, point, and its rounding error.
  double depth = 0.0;
  double noise = 0.0;
};

// Relative error of a float depth, and relative distance by which a float position in a triangle
// may be outside of it.
constexpr double kFloatError = 1.2e-7;
constexpr double kFloatSlack = 1e-6;

/// True if the projection of a point along a normal is in the triangle.
[[nodiscard]] bool is_over(const solver::Core& triangle, const Vec& normal, const float* point,
                           double size) noexcept {
  const Vec at = Eigen::Map<const Eigen::Vector3f>(point).cast<double>() - triangle.center;
  double least = 0.0;
  double most = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double beside = triangle.side[k].cross(at - triangle.corner[k]).dot(normal);
    least = std::min(least, beside);
    most = std::max(most, beside);
  }
  // Inside: on the same side of all edges, for either winding.
  return std::min(-least, most) <= kFloatSlack * size;
}

/// Converts to the caller's units, limited to the largest float.
[[nodiscard]] float scaled(float x, double unit) noexcept {
  return finite_float(static_cast<double>(x) * unit);
}

/// The points of a clipped feature that are kept.
enum class Kept : std::uint8_t {
  /// All; the deepest point may be beside the triangle.
  all,
  /// All, if the deepest point is over the triangle: its depth would be meaningless elsewhere.
  deepest_over,
  /// Those over the triangle.
  over,
};

/// Removes points that are not over the triangle, and puts the deepest first.
void keep_over(const solver::Core& triangle, const Vec& normal, double size,
               FaceContacts& found) noexcept {
  const auto is_beside = [&](const ContactPoint& point) {
    return !is_over(triangle, normal, point.position.data(), size);
  };
  ContactPoint* const end = std::remove_if(found.points, found.points + found.count, is_beside);
  found.count = static_cast<std::uint32_t>(end - found.points);
  if (found.count == 0) return;
  std::iter_swap(found.points,
                 std::max_element(found.points, end,
                                  [](const auto& p, const auto& q) { return p.depth < q.depth; }));
}

/// Clips the supporting feature of the other shape along `normal` (from a to b) against the
/// triangle. The depth is at least `least`, unless only points over the triangle are kept. Returns
/// false if no points are kept, if the depth is more than `most`, or if the gap is above the
/// margin.
[[nodiscard]] bool clip_to_face(const FacePair& pair, const Vec& normal, double margin,
                                double least, double most, Kept kept, FaceContacts& out) noexcept {
  solver::Problem problem;
  prepare(pair.tables, pair.a, pair.pose_a, pair.b, pair.pose_b, false, problem);
  const solver::SupportingPatch a(problem.a, normal);
  const solver::SupportingPatch b(problem.b, -normal);
  const double reach = std::min(std::ldexp(margin, -problem.exponent), 8.0);
  out.count = contact_patch(a.view(), b.view(), normal.data(), reach, out.points);
  ContactPoint& deepest = out.points[0];
  const solver::Core& triangle = pair.second ? problem.b : problem.a;
  if (kept == Kept::over) {
    keep_over(triangle, normal, problem.size, out);
    if (out.count == 0) return false;
  } else if (kept == Kept::deepest_over &&
             !is_over(triangle, normal, deepest.position.data(), problem.size)) {
    return false;
  }
  const double unit = unscaled(problem, 1.0);
  out.depth = static_cast<double>(deepest.depth) * unit;
  if (!(out.depth <= most) || -out.depth > margin) return false;
  out.noise = unscaled(problem, problem.noise()) + kFloatError * std::abs(out.depth);
  for (std::uint32_t k = 0; k < out.count; ++k) {
    for (float& x : out.points[k].position) x = scaled(x, unit);
    out.points[k].depth = scaled(out.points[k].depth, unit);
  }
  if (kept != Kept::over && out.depth < least) {
    out.depth = least;
    deepest.depth = std::max(deepest.depth, scaled(1.0F, least));
  }
  return true;
}

constexpr std::size_t kAnswersPerTask = 256;
constexpr std::size_t kTasksPerWave = 16;

// Limit of the new depth, relative to the deepest contact of the same bodies and kinds before the
// correction. A point on a seam may get deeper: its previous depth was measured along the shortest
// path out of a triangle, which leads across the seam.
constexpr double kMaxDeeper = 4.0;

/// Corrects the contacts of a NarrowResult in waves of chunks. Memory for the contacts of a wave is
/// reserved before its tasks write; unused memory is reclaimed after the wave.
class SurfaceContacts {
 public:
  /// `changes` has one entry per answer.
  SurfaceContacts(const CollidedPairs& collided, const PrimitivePairs& pairs,
                  const PairMargins& margins, NarrowResult& result, Change* changes) noexcept
      : tables_(pairs.tables(collided.shapes)),
        pairs_(pairs),
        margins_(margins),
        result_(result),
        columns_(NarrowColumns::of(result)),
        cones_(collided, tables_, pairs, result),
        changes_(changes) {}

  void run(const Execution& execution) noexcept;

 private:
  /// The groups that begin in a range of answers.
  struct AnswerChunk {
    std::size_t begin;
    std::size_t end;
    /// First contact of this chunk, and the number of contacts written.
    std::size_t base = 0;
    std::size_t used = 0;
    bool has_room = false;
  };

  void run_wave(const Execution& execution, std::span<AnswerChunk> wave) noexcept;
  void align(AnswerChunk& chunk) const noexcept;
  [[nodiscard]] AnswerGroup group_from(std::size_t i) const noexcept;
  [[nodiscard]] bool continues_group(std::size_t i) const noexcept;
  void choose_changes(AnswerChunk& chunk) noexcept;
  void choose_changes(const AnswerGroup& group) noexcept;
  void apply_changes(AnswerChunk& chunk) noexcept;
  void close_gaps(std::span<AnswerChunk> wave, std::size_t from) noexcept;

  [[nodiscard]] Change first_choice(std::size_t i, const AnswerGroup& group) const noexcept;
  void correct_all(const AnswerGroup& group) noexcept;
  [[nodiscard]] bool follow_valid(std::size_t i, const AnswerGroup& group) noexcept;
  [[nodiscard]] bool follow_patch(std::size_t i, const AnswerGroup& group,
                                  PatchContact& patch) noexcept;
  void solve_patch(std::size_t i, const AnswerGroup& group, PatchContact& patch) const noexcept;
  [[nodiscard]] bool is_backside(std::size_t i, const AnswerGroup& group) const noexcept;
  [[nodiscard]] bool is_level_with(std::size_t i, std::size_t s) const noexcept;
  [[nodiscard]] bool points_back(std::size_t i, Vec& front) const noexcept;
  [[nodiscard]] Vec front_of(std::uint32_t primitive) const noexcept;
  [[nodiscard]] Vec face_normal(std::size_t i, const AnswerGroup& group) const noexcept;
  [[nodiscard]] Vec outward_of(std::size_t i, bool second, const AnswerGroup& group) const noexcept;
  void straighten(std::size_t i) noexcept;
  void apply(AnswerChunk& chunk, std::size_t i, double most) noexcept;
  void drop_beside(const AnswerGroup& group, bool has_contact) noexcept;
  void drop(std::size_t i) noexcept;
  void set_normal(std::size_t i, const Vec& normal) noexcept;
  void lower_sphere(std::size_t i, const Vec& normal) noexcept;
  [[nodiscard]] bool clip(AnswerChunk& chunk, std::size_t i, double most, Kept kept) noexcept;
  void take(AnswerChunk& chunk, std::size_t i, std::span<const ContactPoint> points) noexcept;

  /// True for a triangle of a composite shape.
  [[nodiscard]] bool is_facet(std::uint32_t primitive) const noexcept {
    return cones_.is_triangle(primitive) && pairs_.part[primitive] != kWholeShape;
  }
  /// The triangle of a surface; of two surfaces, that of b.
  [[nodiscard]] Facet facet_of(std::size_t i) const noexcept {
    return cones_.facet(is_facet(pair(i).b) ? pair(i).b : pair(i).a);
  }
  [[nodiscard]] bool is_of_two_surfaces(std::size_t i) const noexcept {
    return is_facet(pair(i).a) == is_facet(pair(i).b);
  }
  [[nodiscard]] bool is_deep(std::size_t i) const noexcept;
  /// True if the normal is in the normal cones.
  [[nodiscard]] bool is_valid(std::size_t i) const noexcept {
    return changes_[i] == Change::none || changes_[i] == Change::straighten ||
           changes_[i] == Change::follow_patch || changes_[i] == Change::reach_patch;
  }
  /// True for a contact that remains.
  [[nodiscard]] static bool is_applied(Change change) noexcept {
    return change != Change::apart && change != Change::beside && change != Change::drop;
  }
  [[nodiscard]] static bool is_clipped(Change change) noexcept {
    return change == Change::clip || change == Change::clip_or_drop ||
           change == Change::follow_patch || change == Change::reach_patch;
  }
  [[nodiscard]] bool has_contacts() const noexcept {
    return result_.level() == ContactLevel::manifold;
  }
  [[nodiscard]] const BodyPair& pair(std::size_t i) const noexcept {
    return pairs_.pairs[result_.pair_of(i)];
  }
  [[nodiscard]] double margin(std::size_t i) const noexcept {
    return margins_.of(result_.pair_of(i));
  }

  ShapeTables tables_;
  const PrimitivePairs& pairs_;
  const PairMargins& margins_;
  const NarrowResult& result_;
  NarrowColumns columns_;
  SurfaceCones cones_;
  Change* changes_;
};

void SurfaceContacts::run(const Execution& execution) noexcept {
  const std::size_t size = result_.size();
  AnswerChunk wave[kTasksPerWave];
  for (std::size_t begin = 0; begin < size;) {
    std::size_t filled = 0;
    for (; filled < kTasksPerWave && begin < size; begin += kAnswersPerTask) {
      wave[filled++] = {begin, std::min(begin + kAnswersPerTask, size)};
    }
    run_wave(execution, {wave, filled});
  }
}

void SurfaceContacts::run_wave(const Execution& execution, std::span<AnswerChunk> wave) noexcept {
  const std::size_t from = result_.contacts();
  execution.for_each(wave.size(), [&](std::size_t k) { choose_changes(wave[k]); });
  if (has_contacts()) {
    std::size_t room = from;
    for (AnswerChunk& chunk : wave) {
      chunk.base = room;
      room += chunk.used;
      chunk.used = 0;
    }
    const bool has_room = room == from || columns_.contacts.grow(room);
    for (AnswerChunk& chunk : wave) chunk.has_room = has_room;
  }
  execution.for_each(wave.size(), [&](std::size_t k) { apply_changes(wave[k]); });
  if (has_contacts()) close_gaps(wave, from);
}

// True if answer i belongs to the group of the answer before it. Answers of other runs are not
// included in a group, because the order of runs depends on other bodies.
bool SurfaceContacts::continues_group(std::size_t i) const noexcept {
  if (i == 0 || i >= result_.size()) return false;
  const auto run = std::ranges::upper_bound(result_.runs(), i, {}, &NarrowRun::first);
  if (run[-1].first == i) return false;
  const Column<std::uint32_t>& first = pairs_.first;
  const std::uint32_t* const next =
      std::upper_bound(first.begin(), first.end(), result_.pair_of(i));
  return result_.pair_of(i - 1) >= next[-1];
}

// Returns the answers from i to the end of its group. O(log n).
AnswerGroup SurfaceContacts::group_from(std::size_t i) const noexcept {
  const auto run = std::ranges::upper_bound(result_.runs(), i, {}, &NarrowRun::first);
  const std::span<const std::uint32_t> rest =
      result_.order().subspan(i, run[-1].first + run[-1].count - i);
  const Column<std::uint32_t>& first = pairs_.first;
  const std::uint32_t* const next = std::upper_bound(first.begin(), first.end(), rest[0]);
  const auto end = std::lower_bound(rest.begin(), rest.end(), *next);
  return {i, i + static_cast<std::size_t>(end - rest.begin()),
          static_cast<std::size_t>(next - first.begin()) - 1};
}

// Moves both ends of the chunk to the next begin of a group.
void SurfaceContacts::align(AnswerChunk& chunk) const noexcept {
  if (continues_group(chunk.begin)) chunk.begin = group_from(chunk.begin).end;
  if (continues_group(chunk.end)) chunk.end = group_from(chunk.end).end;
}

// First pass: sets normals and does everything that needs no memory and changes no distance; counts
// the contacts that the second pass may write.
void SurfaceContacts::choose_changes(AnswerChunk& chunk) noexcept {
  align(chunk);
  for (std::size_t i = chunk.begin; i < chunk.end;) {
    const AnswerGroup group = group_from(i);
    choose_changes(group);
    for (; i < group.end; ++i) {
      if (is_clipped(changes_[i])) chunk.used += kManifoldPoints;
    }
  }
}

void SurfaceContacts::choose_changes(const AnswerGroup& group) noexcept {
  bool all_valid = true;
  bool one_region = true;
  std::size_t leader = group.end;
  for (std::size_t i = group.first; i < group.end; ++i) {
    changes_[i] = first_choice(i, group);
    if (changes_[i] == Change::apart) continue;
    if (leader == group.end) leader = i;
    all_valid = all_valid && is_valid(i);
    one_region = one_region && cones_.normal(i).dot(cones_.normal(leader)) >= kRegionCosine;
  }
  if (!all_valid) correct_all(group);
  for (std::size_t i = group.first; i < group.end && !one_region; ++i) {
    if (is_valid(i) && is_backside(i, group)) changes_[i] = Change::drop;
  }
  for (std::size_t i = group.first; i < group.end; ++i) {
    if (changes_[i] == Change::straighten) straighten(i);
  }
}

// Tests the answer on its own: Change::turn if its normal is not in the normal cones, or points to
// the back of a one-sided triangle.
Change SurfaceContacts::first_choice(std::size_t i, const AnswerGroup& group) const noexcept {
  if (!(columns_.distance[i] <= margin(i))) return Change::apart;
  if (has_contacts() && columns_.contact_count[i] == 0) return Change::apart;
  const BodyPair& bodies = pair(i);
  // The normal of a half-space is valid for every surface.
  if (pairs_.shapes[bodies.a].kind() == ShapeKind::half_space ||
      pairs_.shapes[bodies.b].kind() == ShapeKind::half_space) {
    return Change::none;
  }
  Vec front;
  if (points_back(i, front)) {
    // The shapes touch only through the back, or another triangle's back would be in front.
    if (columns_.distance[i] > 0.0 || front.isZero()) return Change::drop;
    return Change::turn;
  }
  if (!is_of_two_surfaces(i)) {
    // Most contacts are with faces.
    const Facet face = facet_of(i);
    const double off = face.normal.cross(cones_.normal(i)).norm();
    const bool has_area = !face.normal.isZero();
    if (has_area && off <= kNearlyFace) {
      return off > kSameNormal ? Change::straighten : Change::none;
    }
  }
  return cones_.has_normal(i, group) ? Change::none : Change::turn;
}

// Corrects the answers whose normals are not valid: first by valid contacts and by patches, then,
// with the contacts of patches as further valid ones, the rest.
void SurfaceContacts::correct_all(const AnswerGroup& group) noexcept {
  PatchContact patch;
  for (std::size_t i = group.first; i < group.end; ++i) {
    if (changes_[i] != Change::turn || follow_valid(i, group) || !is_deep(i)) continue;
    static_cast<void>(follow_patch(i, group, patch));
  }
  for (std::size_t i = group.first; i < group.end; ++i) {
    if (changes_[i] != Change::turn || follow_valid(i, group)) continue;
    const Vec face = face_normal(i, group);
    if (face.isZero()) {
      changes_[i] = Change::doubtful;
      continue;
    }
    set_normal(i, face);
    if (is_deep(i) && !is_of_two_surfaces(i)) changes_[i] = Change::clip;
  }
}

// Drops an answer whose shapes a valid contact parts, or clips the shape against a face in the
// plane of that contact. Returns false if no valid contact parts the shapes.
bool SurfaceContacts::follow_valid(std::size_t i, const AnswerGroup& group) noexcept {
  bool is_parted = false;
  for (std::size_t s = group.first; s < group.end; ++s) {
    if (!is_valid(s) || !cones_.parts(s, i)) continue;
    is_parted = true;
    if (is_of_two_surfaces(i) || !is_level_with(i, s)) continue;
    changes_[i] = Change::clip_or_drop;
    set_normal(i, cones_.normal(s));
    return true;
  }
  if (is_parted) changes_[i] = Change::drop;
  return is_parted;
}

// True if the shapes overlap by more than their rounding.
bool SurfaceContacts::is_deep(std::size_t i) const noexcept {
  const BodyPair& bodies = pair(i);
  const double rounding =
      rounding_of(tables_, pairs_.shapes[bodies.a]) + rounding_of(tables_, pairs_.shapes[bodies.b]);
  return columns_.distance[i] <= 0.0 && columns_.distance[i] + rounding <= 0.0;
}

// Gives an answer the normal and depth of the convex patches around its triangles, if their normal
// is in the normal cones. A triangle that does not reach the plane of the contact is dropped.
bool SurfaceContacts::follow_patch(std::size_t i, const AnswerGroup& group,
                                   PatchContact& patch) noexcept {
  const BodyPair& bodies = pair(i);
  if (!is_facet(bodies.a) && !is_facet(bodies.b)) return false;
  if (!patch.is_of(bodies)) solve_patch(i, group, patch);
  if (!patch.is_valid) return false;
  bool is_touched = true;
  bool reaches = true;
  for (const bool second : {false, true}) {
    const std::size_t k = second ? 1 : 0;
    const ConvexPatch& own = patch.side[k];
    if (own.is_empty()) continue;
    const Vec outward = second ? Vec(-patch.normal) : patch.normal;
    const Facet facet = cones_.facet(second ? bodies.b : bodies.a);
    is_touched = is_touched && facet.contains(patch.touched[k], kPatchSlack * own.size());
    reaches = reaches && facet.top(outward) >= own.top(outward) - kFlatSine * facet.size;
  }
  const bool is_back = front_of(bodies.a).dot(patch.normal) < -kBackNormal ||
                       front_of(bodies.b).dot(patch.normal) > kBackNormal;
  if (reaches && is_back) return false;
  changes_[i] = is_touched ? Change::follow_patch : reaches ? Change::reach_patch : Change::drop;
  if (changes_[i] == Change::drop) return true;
  set_normal(i, patch.normal);
  columns_.distance[i] = patch.distance;
  columns_.error_bound[i] += patch.error;
  return true;
}

void SurfaceContacts::solve_patch(std::size_t i, const AnswerGroup& group,
                                  PatchContact& patch) const noexcept {
  const BodyPair& bodies = pair(i);
  patch.other[0] = bodies.a;
  patch.other[1] = bodies.b;
  for (const bool second : {false, true}) {
    ConvexPatch& own = patch.side[second ? 1 : 0];
    own.clear();
    const std::uint32_t start = second ? bodies.b : bodies.a;
    if (is_facet(start)) own.grow(cones_, group, start, second, outward_of(i, second, group));
  }
  PatchSolver(tables_, pairs_, cones_).solve(group, patch);
}

// Returns the normal of a triangle towards its front; else to the side to which the other body, as
// far as it is in the group, has the shorter path out.
Vec SurfaceContacts::outward_of(std::size_t i, bool second,
                                const AnswerGroup& group) const noexcept {
  const BodyPair& bodies = pair(i);
  const std::uint32_t own = second ? bodies.b : bodies.a;
  const Vec front = front_of(own);
  if (!front.isZero()) return front;
  const Facet facet = cones_.facet(own);
  const double plane = facet.normal.dot(facet.corner[0]);
  double low = kInfinity;
  double high = -kInfinity;
  if (is_facet(second ? bodies.a : bodies.b)) {
    for (std::size_t k = group.first; k < group.end; ++k) {
      const Facet other = cones_.facet(cones_.primitive(k, !second));
      high = std::max(high, other.top(facet.normal));
      low = std::min(low, -other.top(-facet.normal));
    }
  } else {
    const std::uint32_t other = second ? bodies.a : bodies.b;
    const Mat rotation = rotation_of(scale_to_unit_max(pairs_.poses[other].orientation));
    const SupportExtent reach =
        extent(tables_, pairs_.shapes[other], rotation.transpose() * facet.normal);
    const double at = facet.normal.dot(as_eigen(pairs_.poses[other].position));
    low = at + reach.low;
    high = at + reach.high;
  }
  return plane - low > high - plane ? Vec(-facet.normal) : facet.normal;
}

// True if the face of a triangle is nearly normal to the normal of answer s.
bool SurfaceContacts::is_level_with(std::size_t i, std::size_t s) const noexcept {
  const Facet face = facet_of(i);
  return std::abs(face.normal.dot(cones_.normal(s))) >= kRegionCosine;
}

// True if a triangle is touched from behind: a contact of its neighbour parts the bodies, and its
// own does not. If the shapes are apart, any contact of overlapping shapes that parts them will do.
bool SurfaceContacts::is_backside(std::size_t i, const AnswerGroup& group) const noexcept {
  for (std::size_t s = group.first; s < group.end; ++s) {
    if (s == i || !is_valid(s) || cones_.normal(i).dot(cones_.normal(s)) >= kRegionCosine) continue;
    if (!cones_.parts(s, i)) continue;
    if (columns_.distance[i] > 0.0 && columns_.distance[s] <= 0.0) return true;
    if (cones_.are_neighbours(s, i) && !cones_.parts(i, s)) return true;
  }
  return false;
}

// Returns the unit normal of the front of a one-sided triangle; zero for any other primitive.
Vec SurfaceContacts::front_of(std::uint32_t primitive) const noexcept {
  const ShapeId shape = pairs_.shapes[primitive];
  if (shape.kind() != ShapeKind::triangle) return Vec::Zero();
  const std::uint8_t bits = pairs_.active_edges[shape.index()];
  if ((bits & PrimitivePairs::kOneSided) == 0) return Vec::Zero();
  const TriangleShape& triangle = tables_.triangles[shape.index()];
  const Vec first = as_eigen(triangle.vertex[0]);
  const Vec normal = (as_eigen(triangle.vertex[1]) - first)
                         .cross(as_eigen(triangle.vertex[2]) - first)
                         .stableNormalized();
  return (bits & PrimitivePairs::kClockwise) != 0 ? Vec(-normal) : normal;
}

// Returns whether the normal points to the back of a one-sided triangle. Sets `front` to the normal
// towards the front, or to zero if that would point to the back of the other triangle.
bool SurfaceContacts::points_back(std::size_t i, Vec& front) const noexcept {
  const BodyPair& bodies = pair(i);
  const Vec normal = cones_.normal(i);
  const Vec fronts[2] = {front_of(bodies.a), -front_of(bodies.b)};
  const bool first = fronts[0].dot(normal) < -kBackNormal;
  if (!first && !(fronts[1].dot(normal) < -kBackNormal)) return false;
  front = fronts[first ? 0 : 1];
  if (front.dot(fronts[first ? 1 : 0]) < -kBackNormal) front = Vec::Zero();
  return true;
}

// Returns the normal of the triangle's face, from a to b, towards its front or else to the nearer
// side. Zero for two surfaces, unless the normal points to the back of one: it is unknown whose
// face to use.
Vec SurfaceContacts::face_normal(std::size_t i, const AnswerGroup& group) const noexcept {
  Vec front;
  if (points_back(i, front)) return front;
  if (is_of_two_surfaces(i)) return Vec::Zero();
  const bool second = is_facet(pair(i).b);
  const Vec outward = outward_of(i, second, group);
  return second ? Vec(-outward) : outward;
}

// Sets the normal to that of the face, on the same side.
void SurfaceContacts::straighten(std::size_t i) noexcept {
  const Facet face = facet_of(i);
  const Vec normal = cones_.normal(i);
  const Vec straight = face.normal.dot(normal) < 0.0 ? Vec(-face.normal) : face.normal;
  double size = std::abs(columns_.distance[i]);
  for (const Vec& corner : face.corner) size += (corner - face.corner[0]).norm();
  columns_.error_bound[i] += (straight - normal).norm() * size;
  set_normal(i, straight);
}

// Second pass: changes distances. Only the task of a group reads its distances.
void SurfaceContacts::apply_changes(AnswerChunk& chunk) noexcept {
  for (std::size_t i = chunk.begin; i < chunk.end;) {
    const AnswerGroup group = group_from(i);
    double deepest = 0.0;
    for (std::size_t k = i; k < group.end; ++k) {
      deepest = std::max(deepest, -columns_.distance[k]);
    }
    bool has_contact = false;
    for (; i < group.end; ++i) {
      apply(chunk, i, kMaxDeeper * deepest);
      has_contact = has_contact || is_applied(changes_[i]);
    }
    drop_beside(group, has_contact);
  }
}

// Clips and turns; answers without points over their triangles become `beside`.
void SurfaceContacts::apply(AnswerChunk& chunk, std::size_t i, double most) noexcept {
  switch (changes_[i]) {
    case Change::turn:
      lower_sphere(i, cones_.normal(i));
      break;
    case Change::clip:
      static_cast<void>(clip(chunk, i, most, Kept::deepest_over));
      break;
    case Change::clip_or_drop:
      if (!clip(chunk, i, most, Kept::over)) changes_[i] = Change::beside;
      break;
    case Change::follow_patch:
      if (!clip(chunk, i, kInfinity, Kept::all)) changes_[i] = Change::beside;
      break;
    case Change::reach_patch: {
      const Kept kept = is_level_with(i, i) ? Kept::over : Kept::all;
      if (!clip(chunk, i, kInfinity, kept)) changes_[i] = Change::beside;
      break;
    }
    case Change::drop:
      drop(i);
      break;
    default:
      break;
  }
}

// Drops the answers that touch beside their triangles; keeps one if the group has no other contact.
void SurfaceContacts::drop_beside(const AnswerGroup& group, bool has_contact) noexcept {
  for (std::size_t i = group.first; i < group.end; ++i) {
    if (changes_[i] != Change::beside) continue;
    if (has_contact) {
      drop(i);
    } else if (has_contacts()) {
      columns_.distance[i] =
          -static_cast<double>(columns_.contacts.depth[columns_.contact_first[i]]);
    }
    has_contact = true;
  }
}

void SurfaceContacts::close_gaps(std::span<AnswerChunk> wave, std::size_t from) noexcept {
  std::size_t to = from;
  for (const AnswerChunk& chunk : wave) {
    const std::size_t gap = chunk.base - to;
    if (chunk.used != 0 && gap != 0) {
      ContactColumns& all = columns_.contacts;
      for (Column<float>& x : all.position) {
        std::copy_n(x.data() + chunk.base, chunk.used, x.data() + to);
      }
      std::copy_n(all.depth.data() + chunk.base, chunk.used, all.depth.data() + to);
      std::copy_n(all.feature.data() + chunk.base, chunk.used, all.feature.data() + to);
      for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
        std::uint32_t& first = columns_.contact_first[i];
        if (first >= from) first -= static_cast<std::uint32_t>(gap);
      }
    }
    to += chunk.used;
  }
  columns_.contacts.set_size(to);
}

void SurfaceContacts::drop(std::size_t i) noexcept {
  columns_.distance[i] =
      std::max(columns_.distance[i], std::nextafter(margin(i), std::numeric_limits<double>::max()));
  if (has_contacts()) columns_.contact_count[i] = 0;
}

void SurfaceContacts::set_normal(std::size_t i, const Vec& normal) noexcept {
  for (int axis = 0; axis < 3; ++axis) columns_.normal[axis][i] = normal[axis];
}

// Moves the contact to the point of a sphere that is deepest along the normal, so that the contact
// exerts no torque on it.
void SurfaceContacts::lower_sphere(std::size_t i, const Vec& normal) noexcept {
  const BodyPair& bodies = pair(i);
  const double distance = columns_.distance[i];
  Vec on_a;
  if (pairs_.shapes[bodies.a].kind() == ShapeKind::sphere) {
    on_a = tables_.spheres[pairs_.shapes[bodies.a].index()].radius * normal;
  } else if (pairs_.shapes[bodies.b].kind() == ShapeKind::sphere) {
    const auto a = as_eigen(pairs_.poses[bodies.a].position);
    const auto b = as_eigen(pairs_.poses[bodies.b].position);
    const double radius = tables_.spheres[pairs_.shapes[bodies.b].index()].radius;
    on_a = b - a - (radius + distance) * normal;
  } else {
    return;
  }
  if (!has_contacts()) {
    for (int axis = 0; axis < 3; ++axis) columns_.point[axis][i] = on_a[axis];
    return;
  }
  const Vec middle = on_a + 0.5 * distance * normal;
  const std::uint32_t point = columns_.contact_first[i];
  for (int axis = 0; axis < 3; ++axis) {
    columns_.contacts.position[axis][point] = static_cast<float>(middle[axis]);
  }
}

bool SurfaceContacts::clip(AnswerChunk& chunk, std::size_t i, double most, Kept kept) noexcept {
  const BodyPair& bodies = pair(i);
  const Vec normal = cones_.normal(i);
  const FacePair faces{tables_,
                       pairs_.shapes[bodies.a],
                       pairs_.poses[bodies.a],
                       pairs_.shapes[bodies.b],
                       pairs_.poses[bodies.b],
                       is_facet(bodies.b)};
  FaceContacts found;
  if (!clip_to_face(faces, normal, margin(i), -columns_.distance[i], most, kept, found)) {
    return false;
  }
  columns_.distance[i] = -found.depth;
  columns_.error_bound[i] += found.noise;
  if (has_contacts()) {
    take(chunk, i, {found.points, found.count});
    return true;
  }
  for (int axis = 0; axis < 3; ++axis) {
    columns_.point[axis][i] =
        static_cast<double>(found.points[0].position[axis]) + 0.5 * found.depth * normal[axis];
  }
  return true;
}

void SurfaceContacts::take(AnswerChunk& chunk, std::size_t i,
                           std::span<const ContactPoint> points) noexcept {
  // If memory was refused, keep at most as many contacts as there were.
  std::size_t at = columns_.contact_first[i];
  std::size_t count = std::min<std::size_t>(points.size(), columns_.contact_count[i]);
  if (chunk.has_room) {
    at = chunk.base + chunk.used;
    count = points.size();
    chunk.used += count;
  }
  ContactColumns& all = columns_.contacts;
  for (std::size_t k = 0; k < count; ++k) {
    for (int axis = 0; axis < 3; ++axis) all.position[axis][at + k] = points[k].position[axis];
    all.depth[at + k] = points[k].depth;
    all.feature[at + k] = points[k].feature;
  }
  columns_.contact_first[i] = static_cast<std::uint32_t>(at);
  columns_.contact_count[i] = static_cast<std::uint32_t>(count);
}

}  // namespace

Status correct_surface_contacts(const CollidedPairs& collided, PrimitivePairs& pairs,
                                const PairMargins& margins, const Execution& execution,
                                NarrowResult& result) noexcept {
  if (result.level() == ContactLevel::boolean || result.size() == 0) return Status::ok;
  // The memory in which the pairs were found is free again.
  if (!pairs.scratch.resize(result.size() / sizeof(std::uint32_t) + 1)) {
    return Status::out_of_memory;
  }
  auto* const changes = reinterpret_cast<Change*>(pairs.scratch.data());
  SurfaceContacts(collided, pairs, margins, result, changes).run(execution);
  return Status::ok;
}

}  // namespace winnow::mid
