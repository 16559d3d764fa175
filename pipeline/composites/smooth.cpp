#include "pipeline/composites/smooth.h"
#include "pipeline/composites/edge_contact.h"
#include "pipeline/composites/face_clip.h"
#include "pipeline/shapes/extent.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>

namespace winnow::mid {
namespace {

constexpr std::size_t kChunk = 256;
constexpr std::size_t kWave = 16;

// Times as deep as any contact of the same bodies is before smoothing: a point on a seam may be,
// since the shortest way out of each triangle is over the seam.
constexpr double kMostDeeper = 4.0;

}  // namespace

/// Writes to a NarrowResult, in waves of chunks: room for the contacts of a wave is made before its
/// tasks run, and what they do not need of it is taken back.
class Smoothing {
 public:
  Smoothing(const ShapePool& shapes, const PrimitivePairs& pairs, NarrowResult& result) noexcept
      : tables_(pairs.tables(shapes)), pairs_(pairs), result_(result) {}

  void run(const Execution& execution) noexcept;

 private:
  struct Found {
    EdgeContact contact = EdgeContact::real;
    /// From a to b, along the triangle's normal.
    Vec normal;
    /// How far the normal was off.
    double off = 0.0;
    bool is_deep = false;
  };
  struct Chunk {
    std::size_t begin;
    std::size_t end;
    /// Contacts from there on; how many were written.
    std::size_t base = 0;
    std::size_t used = 0;
    bool has_room = false;
    /// What is left to be clipped once there is room.
    std::bitset<kChunk> is_deep{};
    /// How deep they may become.
    std::array<float, kChunk> most{};
  };
  /// Primitive pairs of one pair of bodies, and how deep the deepest of them is.
  struct Together {
    std::uint32_t first = 0;
    std::uint32_t end = 0;
    double deepest = 0.0;
  };

  void run_wave(const Execution& execution, std::span<Chunk> wave) noexcept;
  void look(Chunk& chunk) noexcept;
  void meet(std::size_t i, Together& bodies) const noexcept;
  void clip_all(Chunk& chunk) noexcept;
  void close_gaps(std::span<Chunk> wave, std::size_t from) noexcept;

  [[nodiscard]] Found find(std::size_t i) const noexcept;
  void choose_side(const BodyPair& pair, bool second, Vec& away) const noexcept;
  void set_normal(std::size_t i, const Vec& normal) noexcept;
  void lower_sphere(std::size_t i, const Vec& normal) noexcept;
  void clip(Chunk& chunk, std::size_t i) noexcept;
  void take(Chunk& chunk, std::size_t i, std::span<const ContactPoint> points) noexcept;

  /// One that may have inner edges.
  [[nodiscard]] bool is_mesh_triangle(std::uint32_t primitive) const noexcept {
    const ShapeId shape = pairs_.shapes[primitive];
    return shape.kind() == ShapeKind::triangle && pairs_.active_edges[shape.index()] != kAllActive;
  }
  [[nodiscard]] bool has_contacts() const noexcept {
    return result_.level_ == NarrowLevel::manifold;
  }
  [[nodiscard]] const BodyPair& pair(std::size_t i) const noexcept {
    return pairs_.pairs[result_.order_[i]];
  }

  ShapeTables tables_;
  const PrimitivePairs& pairs_;
  NarrowResult& result_;
};

void Smoothing::run(const Execution& execution) noexcept {
  const std::size_t size = std::min(result_.size(), pairs_.pairs.size());
  Chunk wave[kWave];
  for (std::size_t begin = 0; begin < size;) {
    std::size_t filled = 0;
    for (; filled < kWave && begin < size; begin += kChunk) {
      wave[filled++] = {begin, std::min(begin + kChunk, size)};
    }
    run_wave(execution, {wave, filled});
  }
}

void Smoothing::run_wave(const Execution& execution, std::span<Chunk> wave) noexcept {
  const std::size_t from = result_.contacts();
  execution.for_each(wave.size(), [&](std::size_t k) { look(wave[k]); });
  if (has_contacts()) {
    std::size_t room = from;
    for (Chunk& chunk : wave) {
      chunk.base = room;
      room += chunk.used;
      chunk.used = 0;
    }
    const bool has_room = room == from || result_.contacts_.grow(room);
    for (Chunk& chunk : wave) chunk.has_room = has_room;
  }
  execution.for_each(wave.size(), [&](std::size_t k) { clip_all(wave[k]); });
  if (has_contacts()) close_gaps(wave, from);
}

// Everything that needs no room, and how much the rest needs.
void Smoothing::look(Chunk& chunk) noexcept {
  Together bodies;
  for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
    const Found found = find(i);
    if (found.contact == EdgeContact::real) continue;
    set_normal(i, found.normal);
    if (found.contact == EdgeContact::nearly_face) {
      result_.error_bound_[i] += found.off;
    } else if (found.is_deep) {
      meet(i, bodies);
      chunk.is_deep.set(i - chunk.begin);
      chunk.most[i - chunk.begin] = static_cast<float>(bodies.deepest);
      chunk.used += kManifoldPoints;
    } else {
      lower_sphere(i, found.normal);
    }
  }
}

// Finds the deepest of the answers about the same bodies and kinds, which are next to each other.
// Smoothing makes none deeper, so that it does not matter which have been smoothed already.
void Smoothing::meet(std::size_t i, Together& bodies) const noexcept {
  const std::uint32_t at = result_.order_[i];
  if (at >= bodies.first && at < bodies.end) return;
  const Column<std::uint32_t>& first = pairs_.first;
  const std::uint32_t* const next = std::upper_bound(first.begin(), first.end(), at);
  bodies = {at, at + 1, -result_.distance_[i]};
  if (next == first.begin() || next == first.end()) return;
  bodies.first = next[-1];
  bodies.end = next[0];
  const auto is_of = [&](std::size_t k) {
    return result_.order_[k] >= bodies.first && result_.order_[k] < bodies.end;
  };
  for (std::size_t k = i; k < result_.size() && is_of(k); ++k) {
    bodies.deepest = std::max(bodies.deepest, -result_.distance_[k]);
  }
  for (std::size_t k = i; k-- > 0 && is_of(k);) {
    bodies.deepest = std::max(bodies.deepest, -result_.distance_[k]);
  }
}

void Smoothing::clip_all(Chunk& chunk) noexcept {
  if (chunk.is_deep.none()) return;
  for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
    if (!chunk.is_deep.test(i - chunk.begin)) continue;
    clip(chunk, i);
  }
}

void Smoothing::close_gaps(std::span<Chunk> wave, std::size_t from) noexcept {
  std::size_t to = from;
  for (const Chunk& chunk : wave) {
    const std::size_t gap = chunk.base - to;
    if (chunk.used != 0 && gap != 0) {
      ContactColumns& all = result_.contacts_;
      for (Column<float>& x : all.position) {
        std::copy_n(x.data() + chunk.base, chunk.used, x.data() + to);
      }
      std::copy_n(all.depth.data() + chunk.base, chunk.used, all.depth.data() + to);
      std::copy_n(all.feature.data() + chunk.base, chunk.used, all.feature.data() + to);
      for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
        std::uint32_t& first = result_.contact_first_[i];
        if (first >= from) first -= static_cast<std::uint32_t>(gap);
      }
    }
    to += chunk.used;
  }
  result_.contacts_.set_size(to);
}

Smoothing::Found Smoothing::find(std::size_t i) const noexcept {
  Found found;
  if (!(result_.distance_[i] <= pairs_.margin)) return found;
  if (has_contacts() && result_.contact_count_[i] == 0) return found;
  // Which of the two is the triangle of a mesh. Edges of other triangles are all active.
  const BodyPair& bodies = pair(i);
  const bool second = is_mesh_triangle(bodies.b);
  if (is_mesh_triangle(bodies.a) == second) return found;
  const ShapeId triangle = pairs_.shapes[second ? bodies.b : bodies.a];
  const ShapeId other = pairs_.shapes[second ? bodies.a : bodies.b];
  if (other.kind() == ShapeKind::half_space) return found;

  Vec away(result_.normal_[0][i], result_.normal_[1][i], result_.normal_[2][i]);
  if (second) away = -away;
  Vec face;
  const TriangleShape& shape = tables_.triangles[triangle.index()];
  found.contact = classify(shape, pairs_.active_edges[triangle.index()], away, face);
  if (found.contact == EdgeContact::real) return found;
  if (found.contact == EdgeContact::inner) {
    choose_side(bodies, second, face);
    const double distance = result_.distance_[i];
    found.is_deep = other.kind() != ShapeKind::sphere && distance <= 0.0 &&
                    distance + rounding_of(tables_, other) <= 0.0;
  } else {
    double size = std::abs(result_.distance_[i]);
    for (const auto& corner : shape.vertex) size += Eigen::Map<const Vec>(corner).norm();
    found.off = (face - away).norm() * size;
  }
  found.normal = second ? Vec(-face) : face;
  return found;
}

// The side of the triangle's plane on which less of the other shape is in the way.
void Smoothing::choose_side(const BodyPair& bodies, bool second, Vec& face) const noexcept {
  const std::uint32_t triangle = second ? bodies.b : bodies.a;
  const std::uint32_t other = second ? bodies.a : bodies.b;
  const Mat rotation = rotation_of(tame(pairs_.poses[other].orientation));
  const Extent reach = extent(tables_, pairs_.shapes[other], rotation.transpose() * face);
  const Eigen::Map<const Vec> at(pairs_.poses[other].position);
  const Eigen::Map<const Vec> plane(pairs_.poses[triangle].position);
  const double base = face.dot(at - plane);
  if (-(base + reach.low) > base + reach.high) face = -face;
}

void Smoothing::set_normal(std::size_t i, const Vec& normal) noexcept {
  for (int axis = 0; axis < 3; ++axis) result_.normal_[axis][i] = normal[axis];
}

// The point of a sphere that is its deepest along the normal, so that the contact does not turn it.
void Smoothing::lower_sphere(std::size_t i, const Vec& normal) noexcept {
  const BodyPair& bodies = pair(i);
  const double distance = result_.distance_[i];
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
    for (int axis = 0; axis < 3; ++axis) result_.point_[axis][i] = on_a[axis];
    return;
  }
  const Vec middle = on_a + 0.5 * distance * normal;
  const std::uint32_t point = result_.contact_first_[i];
  for (int axis = 0; axis < 3; ++axis) {
    result_.contacts_.position[axis][point] = static_cast<float>(middle[axis]);
  }
}

void Smoothing::clip(Chunk& chunk, std::size_t i) noexcept {
  const BodyPair& bodies = pair(i);
  const Vec normal(result_.normal_[0][i], result_.normal_[1][i], result_.normal_[2][i]);
  const FacePair faces{tables_,
                       pairs_.shapes[bodies.a],
                       pairs_.poses[bodies.a],
                       pairs_.shapes[bodies.b],
                       pairs_.poses[bodies.b],
                       is_mesh_triangle(bodies.b)};
  const double most = kMostDeeper * static_cast<double>(chunk.most[i - chunk.begin]);
  FaceContacts found;
  if (!clip_to_face(faces, normal, pairs_.margin, -result_.distance_[i], most, found)) return;
  result_.distance_[i] = -found.depth;
  result_.error_bound_[i] += found.noise;
  if (has_contacts()) return take(chunk, i, {found.points, found.count});
  for (int axis = 0; axis < 3; ++axis) {
    result_.point_[axis][i] =
        static_cast<double>(found.points[0].position[axis]) + 0.5 * found.depth * normal[axis];
  }
}

void Smoothing::take(Chunk& chunk, std::size_t i, std::span<const ContactPoint> points) noexcept {
  // Where memory was refused, as many as there were.
  std::size_t at = result_.contact_first_[i];
  std::size_t count = std::min<std::size_t>(points.size(), result_.contact_count_[i]);
  if (chunk.has_room) {
    at = chunk.base + chunk.used;
    count = points.size();
    chunk.used += count;
  }
  ContactColumns& all = result_.contacts_;
  for (std::size_t k = 0; k < count; ++k) {
    for (int axis = 0; axis < 3; ++axis) all.position[axis][at + k] = points[k].position[axis];
    all.depth[at + k] = points[k].depth;
    all.feature[at + k] = points[k].feature;
  }
  result_.contact_first_[i] = static_cast<std::uint32_t>(at);
  result_.contact_count_[i] = static_cast<std::uint32_t>(count);
}

void smooth(const ShapePool& shapes, const PrimitivePairs& pairs, const Execution& execution,
            NarrowResult& result) noexcept {
  if (result.level() != NarrowLevel::boolean) Smoothing(shapes, pairs, result).run(execution);
}

}  // namespace winnow::mid
