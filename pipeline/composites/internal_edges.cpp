// Corrects contacts at internal edges of meshes and height fields, and contacts from behind
// one-sided triangles (mid::correct_internal_edges; mid_phase.h describes the method). Called
// by the scene after the narrow phase and before `reduce_contacts`. In this file, an answer is the
// narrow-phase result of one pair of primitives.

#include <winnow/core/rounding.h>
#include <winnow/pipeline/contact_types.h>
#include "pipeline/composites/composites.h"
#include "pipeline/shapes/extent.h"
#include "pipeline/solver/manifold.h"
#include "pipeline/solver/problem.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <cstdint>
#include <limits>

namespace winnow::mid {
namespace {

/// Kind of a contact with a triangle.
enum class EdgeContact : std::uint8_t {
  /// With the face, or with an active edge or corner: not changed.
  real,
  /// With the face, but the normal differs from the face's by more than rounding of unit vectors.
  nearly_face,
  /// With an internal edge or corner, where a neighbouring triangle continues the surface.
  internal,
};

// Heights of corners along the normal that differ by less than this share of the longest edge count
// as equal.
constexpr double kLevel = 1e-6;
constexpr double kSameNormal = 1e-13;
// A normal whose component towards the back of a triangle is smaller counts as parallel to the
// triangle.
constexpr double kBackNormal = 1e-9;

/// `active`: see PrimitivePairs::active_edges. `away`: unit vector from the triangle to the other
/// shape. Sets `face` to the triangle's unit normal on the side of `away`. Contacts of degenerate
/// triangles are always real.
[[nodiscard]] EdgeContact classify(const TriangleShape& triangle, std::uint8_t active,
                                   const Vec& away, Vec& face) noexcept {
  Vec corner[3];
  for (int i = 0; i < 3; ++i) corner[i] = Eigen::Map<const Vec>(triangle.vertex[i]);
  const Vec edge[3] = {corner[1] - corner[0], corner[2] - corner[1], corner[0] - corner[2]};
  const Vec normal = edge[0].cross(edge[1]);
  const double length = normal.norm();
  // Also false for NaN.
  if (!(length > 0.0 && length < kInfinity)) return EdgeContact::real;
  const double rise = normal.dot(away) / length;
  face = normal / (rise < 0.0 ? -length : length);
  if ((away - face).squaredNorm() <= kSameNormal * kSameNormal) return EdgeContact::real;

  double height[3];
  for (int i = 0; i < 3; ++i) height[i] = corner[i].dot(away);
  const double top = std::max({height[0], height[1], height[2]});
  const double level =
      kLevel *
      std::sqrt(std::max({edge[0].squaredNorm(), edge[1].squaredNorm(), edge[2].squaredNorm()}));
  int highest = 0;
  for (int i = 0; i < 3; ++i) highest += top - height[i] <= level ? 1 : 0;
  if (highest == 3) return EdgeContact::nearly_face;
  for (int i = 0; i < 3; ++i) {
    // The corner is on an active edge of another triangle. Edges of this triangle are tested below.
    const bool is_own = (active >> i & 1U) != 0 || (active >> (i + 2) % 3 & 1U) != 0;
    const bool is_active = (active >> (3 + i) & 1U) != 0;
    if (highest == 1 && top - height[i] <= level && is_active && !is_own) return EdgeContact::real;
  }
  for (int i = 0; i < 3; ++i) {
    const int next = (i + 1) % 3;
    if ((active >> i & 1U) == 0) continue;
    const bool ends[2] = {top - height[i] <= level, top - height[next] <= level};
    // Either both ends of the edge are highest, or one end is the only highest corner.
    if (ends[0] && ends[1]) return EdgeContact::real;
    if (highest != 1 || (!ends[0] && !ends[1])) continue;
    // The contact of one corner belongs to the edge if the other shape is outside the edge. Uses
    // the inward direction, because seen from `away` the corners may be clockwise.
    const Vec inward = corner[(i + 2) % 3] - corner[i];
    const Vec along = edge[i] / edge[i].norm();
    if ((inward - along * along.dot(inward)).dot(away) < 0.0) return EdgeContact::real;
  }
  return EdgeContact::internal;
}

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

/// Contacts along the normal of the triangle's face.
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

/// True if the projection of a point along the triangle's normal is in the triangle.
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

/// Clips the supporting feature of the other shape along `normal` (face normal, from a to b)
/// against the triangle. The depth is at least `least`. Returns false if the deepest point is not
/// over the triangle, where its depth would be meaningless, or is deeper than `most`.
[[nodiscard]] bool clip_to_face(const FacePair& pair, const Vec& normal, double margin,
                                double least, double most, FaceContacts& out) noexcept {
  solver::Problem problem;
  prepare(pair.tables, pair.a, pair.pose_a, pair.b, pair.pose_b, false, problem);
  const solver::SupportingPatch a(problem.a, normal);
  const solver::SupportingPatch b(problem.b, -normal);
  const double reach = std::min(std::ldexp(margin, -problem.exponent), 8.0);
  out.count = contact_patch(a.view(), b.view(), normal.data(), reach, out.points);
  ContactPoint& deepest = out.points[0];
  const solver::Core& triangle = pair.second ? problem.b : problem.a;
  if (!is_over(triangle, normal, deepest.position, problem.size)) return false;
  const double unit = unscaled(problem, 1.0);
  out.depth = static_cast<double>(deepest.depth) * unit;
  if (!(out.depth <= most)) return false;
  out.depth = std::max(out.depth, least);
  out.noise = unscaled(problem, problem.noise()) + kFloatError * out.depth;
  for (std::uint32_t k = 0; k < out.count; ++k) {
    for (float& x : out.points[k].position) x = scaled(x, unit);
    out.points[k].depth = scaled(out.points[k].depth, unit);
  }
  deepest.depth = std::max(deepest.depth, scaled(1.0F, least));
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
class InternalEdgeCorrection {
 public:
  InternalEdgeCorrection(const ShapePool& shapes, const PrimitivePairs& pairs,
                         const PairMargins& margins, NarrowResult& result) noexcept
      : tables_(pairs.tables(shapes)),
        pairs_(pairs),
        margins_(margins),
        result_(result),
        columns_(result.columns()) {}

  void run(const Execution& execution) noexcept;

 private:
  struct Correction {
    EdgeContact contact = EdgeContact::real;
    /// From a to b, along the normal of the triangle.
    Vec normal;
    /// Error of the previous normal, as a length.
    double off = 0.0;
    bool is_deep = false;
    /// The contact comes from behind a one-sided triangle and is dropped.
    bool is_gone = false;
  };
  struct AnswerChunk {
    std::size_t begin;
    std::size_t end;
    /// First contact of this chunk, and the number of contacts written.
    std::size_t base = 0;
    std::size_t used = 0;
    bool has_room = false;
    /// Answers to clip when memory is reserved.
    std::bitset<kAnswersPerTask> is_deep{};
    /// Answers to drop.
    std::bitset<kAnswersPerTask> is_gone{};
    /// For each answer to clip, depth of the deepest answer of the same bodies and kinds.
    std::array<float, kAnswersPerTask> most{};
  };
  /// Answers [first, end) of one pair of bodies and one pair of kinds, and the depth of the deepest
  /// answer before the correction.
  struct AnswerGroup {
    std::size_t first = 0;
    std::size_t end = 0;
    double deepest = 0.0;
  };

  void run_wave(const Execution& execution, std::span<AnswerChunk> wave) noexcept;
  void first_pass(AnswerChunk& chunk) noexcept;
  void find_group(std::size_t i, AnswerGroup& bodies) const noexcept;
  void finish(AnswerChunk& chunk) noexcept;
  void close_gaps(std::span<AnswerChunk> wave, std::size_t from) noexcept;

  [[nodiscard]] Correction find(std::size_t i) const noexcept;
  [[nodiscard]] Vec front_of(std::uint32_t primitive) const noexcept;
  [[nodiscard]] bool turn_to_front(std::size_t i, Correction& found) const noexcept;
  void drop(std::size_t i) noexcept;
  void choose_side(const BodyPair& pair, bool second, Vec& away) const noexcept;
  void set_normal(std::size_t i, const Vec& normal) noexcept;
  void lower_sphere(std::size_t i, const Vec& normal) noexcept;
  void clip(AnswerChunk& chunk, std::size_t i) noexcept;
  void take(AnswerChunk& chunk, std::size_t i, std::span<const ContactPoint> points) noexcept;

  /// True for a triangle that may have internal edges.
  [[nodiscard]] bool is_mesh_triangle(std::uint32_t primitive) const noexcept {
    const ShapeId shape = pairs_.shapes[primitive];
    return shape.kind() == ShapeKind::triangle &&
           pairs_.active_edges[shape.index()] != PrimitivePairs::kAllActive;
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
  /// The group of answers that continues across the end of the last wave.
  AnswerGroup spanning_;
};

void InternalEdgeCorrection::run(const Execution& execution) noexcept {
  const std::size_t size = std::min(result_.size(), pairs_.pairs.size());
  AnswerChunk wave[kTasksPerWave];
  for (std::size_t begin = 0; begin < size;) {
    std::size_t filled = 0;
    for (; filled < kTasksPerWave && begin < size; begin += kAnswersPerTask) {
      wave[filled++] = {begin, std::min(begin + kAnswersPerTask, size)};
    }
    run_wave(execution, {wave, filled});
  }
}

void InternalEdgeCorrection::run_wave(const Execution& execution,
                                      std::span<AnswerChunk> wave) noexcept {
  const std::size_t from = result_.contacts();
  execution.for_each(wave.size(), [&](std::size_t k) { first_pass(wave[k]); });
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
  // Do this before distances change: the group may continue in the next wave.
  if (wave.back().end < result_.size()) find_group(wave.back().end, spanning_);
  execution.for_each(wave.size(), [&](std::size_t k) { finish(wave[k]); });
  if (has_contacts()) close_gaps(wave, from);
}

// First pass: does everything that needs no memory and changes no distance, and counts the contacts
// that the second pass may write.
void InternalEdgeCorrection::first_pass(AnswerChunk& chunk) noexcept {
  AnswerGroup bodies = spanning_;
  for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
    const Correction found = find(i);
    if (found.is_gone) chunk.is_gone.set(i - chunk.begin);
    if (found.contact == EdgeContact::real) continue;
    set_normal(i, found.normal);
    if (found.contact == EdgeContact::nearly_face) {
      columns_.error_bound[i] += found.off;
    } else if (found.is_deep) {
      find_group(i, bodies);
      chunk.is_deep.set(i - chunk.begin);
      chunk.most[i - chunk.begin] = static_cast<float>(bodies.deepest);
      chunk.used += kManifoldPoints;
    } else {
      lower_sphere(i, found.normal);
    }
  }
}

// Finds the answers of the same bodies and kinds as answer i, which are consecutive. Answers of
// other runs are not included, because the order of runs depends on other bodies.
void InternalEdgeCorrection::find_group(std::size_t i, AnswerGroup& bodies) const noexcept {
  if (i >= bodies.first && i < bodies.end) return;
  bodies = {i, i + 1, -columns_.distance[i]};
  const std::uint32_t at = result_.pair_of(i);
  const Column<std::uint32_t>& first = pairs_.first;
  const std::uint32_t* const next = std::upper_bound(first.begin(), first.end(), at);
  if (next == first.begin() || next == first.end()) return;
  const auto take = [&](std::size_t k) {
    const std::uint32_t pair = result_.pair_of(k);
    if (pair < next[-1] || pair >= next[0]) return false;
    bodies.deepest = std::max(bodies.deepest, -columns_.distance[k]);
    return true;
  };
  const std::span<const NarrowRun> runs = result_.runs();
  const auto after = std::ranges::upper_bound(runs, i, {}, &NarrowRun::first);
  const std::size_t begin = after[-1].first;
  const std::size_t end = begin + after[-1].count;
  while (bodies.end < end && take(bodies.end)) ++bodies.end;
  while (bodies.first > begin && take(bodies.first - 1)) --bodies.first;
}

// Second pass: changes distances. No other task reads these distances.
void InternalEdgeCorrection::finish(AnswerChunk& chunk) noexcept {
  if (chunk.is_deep.none() && chunk.is_gone.none()) return;
  for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
    if (chunk.is_gone.test(i - chunk.begin)) drop(i);
    if (chunk.is_deep.test(i - chunk.begin)) clip(chunk, i);
  }
}

void InternalEdgeCorrection::close_gaps(std::span<AnswerChunk> wave, std::size_t from) noexcept {
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

InternalEdgeCorrection::Correction InternalEdgeCorrection::find(std::size_t i) const noexcept {
  Correction found;
  if (!(columns_.distance[i] <= margin(i))) return found;
  if (has_contacts() && columns_.contact_count[i] == 0) return found;
  // Find which of the two is the mesh triangle. All edges of other triangles are active.
  const BodyPair& bodies = pair(i);
  const bool second = is_mesh_triangle(bodies.b);
  const ShapeId triangle = pairs_.shapes[second ? bodies.b : bodies.a];
  const ShapeId other = pairs_.shapes[second ? bodies.a : bodies.b];
  if (other.kind() == ShapeKind::half_space || turn_to_front(i, found)) return found;
  if (is_mesh_triangle(bodies.a) == second) return found;

  Vec away(columns_.normal[0][i], columns_.normal[1][i], columns_.normal[2][i]);
  if (second) away = -away;
  Vec face;
  const TriangleShape& shape = tables_.triangles[triangle.index()];
  found.contact = classify(shape, pairs_.active_edges[triangle.index()], away, face);
  if (found.contact == EdgeContact::real) return found;
  if (found.contact == EdgeContact::internal) {
    const Vec front = front_of(second ? bodies.b : bodies.a);
    if (front.isZero()) {
      choose_side(bodies, second, face);
    } else {
      face = front;
    }
    const double distance = columns_.distance[i];
    found.is_deep = other.kind() != ShapeKind::sphere && distance <= 0.0 &&
                    distance + rounding_of(tables_, other) <= 0.0;
  } else {
    double size = std::abs(columns_.distance[i]);
    for (const auto& corner : shape.vertex) size += Eigen::Map<const Vec>(corner).norm();
    found.off = (face - away).norm() * size;
  }
  found.normal = second ? Vec(-face) : face;
  return found;
}

// Returns the unit normal of the front of a one-sided triangle; zero for any other primitive.
Vec InternalEdgeCorrection::front_of(std::uint32_t primitive) const noexcept {
  const ShapeId shape = pairs_.shapes[primitive];
  if (shape.kind() != ShapeKind::triangle) return Vec::Zero();
  const std::uint8_t bits = pairs_.active_edges[shape.index()];
  if ((bits & PrimitivePairs::kOneSided) == 0) return Vec::Zero();
  const TriangleShape& triangle = tables_.triangles[shape.index()];
  const Vec first = Eigen::Map<const Vec>(triangle.vertex[0]);
  const Vec normal = (Eigen::Map<const Vec>(triangle.vertex[1]) - first)
                         .cross(Eigen::Map<const Vec>(triangle.vertex[2]) - first)
                         .stableNormalized();
  return (bits & PrimitivePairs::kClockwise) != 0 ? Vec(-normal) : normal;
}

// Handles a contact whose normal points to the back of a one-sided triangle; returns false for any
// other. Overlapping shapes are pushed out to the front. There is no contact if the shapes are
// apart, or if the corrected normal would point to the back of the other triangle.
bool InternalEdgeCorrection::turn_to_front(std::size_t i, Correction& found) const noexcept {
  const BodyPair& bodies = pair(i);
  const Vec normal(columns_.normal[0][i], columns_.normal[1][i], columns_.normal[2][i]);
  const Vec front[2] = {front_of(bodies.a), -front_of(bodies.b)};
  const bool first = front[0].dot(normal) < -kBackNormal;
  if (!first && !(front[1].dot(normal) < -kBackNormal)) return false;
  found.normal = front[first ? 0 : 1];
  const double lean = found.normal.dot(front[first ? 1 : 0]);
  found.is_gone = columns_.distance[i] > 0.0 || lean < -kBackNormal;
  if (found.is_gone) return true;
  found.contact = EdgeContact::internal;
  const ShapeKind other = pairs_.shapes[first ? bodies.b : bodies.a].kind();
  found.is_deep = other != ShapeKind::triangle && other != ShapeKind::sphere;
  return true;
}

void InternalEdgeCorrection::drop(std::size_t i) noexcept {
  columns_.distance[i] =
      std::max(columns_.distance[i], std::nextafter(margin(i), std::numeric_limits<double>::max()));
  if (has_contacts()) columns_.contact_count[i] = 0;
}

// Orients `face` to the side of the triangle's plane to which the other shape has the shorter path
// out.
void InternalEdgeCorrection::choose_side(const BodyPair& bodies, bool second,
                                         Vec& face) const noexcept {
  const std::uint32_t triangle = second ? bodies.b : bodies.a;
  const std::uint32_t other = second ? bodies.a : bodies.b;
  const Mat rotation = rotation_of(scale_to_unit_max(pairs_.poses[other].orientation));
  const SupportExtent reach = extent(tables_, pairs_.shapes[other], rotation.transpose() * face);
  const Eigen::Map<const Vec> at(pairs_.poses[other].position);
  const Eigen::Map<const Vec> plane(pairs_.poses[triangle].position);
  const double base = face.dot(at - plane);
  if (-(base + reach.low) > base + reach.high) face = -face;
}

void InternalEdgeCorrection::set_normal(std::size_t i, const Vec& normal) noexcept {
  for (int axis = 0; axis < 3; ++axis) columns_.normal[axis][i] = normal[axis];
}

// Moves the contact to the point of a sphere that is deepest along the normal, so that the contact
// exerts no torque on it.
void InternalEdgeCorrection::lower_sphere(std::size_t i, const Vec& normal) noexcept {
  const BodyPair& bodies = pair(i);
  const double distance = columns_.distance[i];
  Vec on_a;
  if (pairs_.shapes[bodies.a].kind() == ShapeKind::sphere) {
    on_a = tables_.spheres[pairs_.shapes[bodies.a].index()].radius * normal;
  } else if (pairs_.shapes[bodies.b].kind() == ShapeKind::sphere) {
    const Eigen::Map<const Vec> a(pairs_.poses[bodies.a].position);
    const Eigen::Map<const Vec> b(pairs_.poses[bodies.b].position);
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

void InternalEdgeCorrection::clip(AnswerChunk& chunk, std::size_t i) noexcept {
  const BodyPair& bodies = pair(i);
  const Vec normal(columns_.normal[0][i], columns_.normal[1][i], columns_.normal[2][i]);
  const FacePair faces{tables_,
                       pairs_.shapes[bodies.a],
                       pairs_.poses[bodies.a],
                       pairs_.shapes[bodies.b],
                       pairs_.poses[bodies.b],
                       is_mesh_triangle(bodies.b)};
  const double most = kMaxDeeper * static_cast<double>(chunk.most[i - chunk.begin]);
  FaceContacts found;
  if (!clip_to_face(faces, normal, margin(i), -columns_.distance[i], most, found)) return;
  columns_.distance[i] = -found.depth;
  columns_.error_bound[i] += found.noise;
  if (has_contacts()) return take(chunk, i, {found.points, found.count});
  for (int axis = 0; axis < 3; ++axis) {
    columns_.point[axis][i] =
        static_cast<double>(found.points[0].position[axis]) + 0.5 * found.depth * normal[axis];
  }
}

void InternalEdgeCorrection::take(AnswerChunk& chunk, std::size_t i,
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

void correct_internal_edges(const ShapePool& shapes, const PrimitivePairs& pairs,
                            const PairMargins& margins, const Execution& execution,
                            NarrowResult& result) noexcept {
  if (result.level() == ContactLevel::boolean) return;
  InternalEdgeCorrection(shapes, pairs, margins, result).run(execution);
}

}  // namespace winnow::mid
