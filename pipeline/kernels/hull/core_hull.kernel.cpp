// The kernels of hulls with spheres, capsules, boxes and triangles. The simple shapes are
// represented as hulls, so that hull_answers.wide.h can answer all these pairs.

#include "pipeline/kernels/hull/hull_answers.wide.h"

namespace winnow {
namespace WINNOW_ISA_NAME::hull {
/// Faces, edges and neighbours of boxes. Vertex i is at the positive end of axis k if bit k is set.
/// Face 2 k + 1 is the positive face of axis k, face 2 k the negative one. Edge 4 k + j is parallel
/// to axis k; bits 0 and 1 of j are set if it is at the positive ends of the two other axes.
/// flat_box_feature uses the same numbers.
struct BoxTopology {
  std::uint32_t loop[24];
  std::uint32_t loop_edge[24];
  HullEdge edges[12];
  HullFace faces[6];
  std::uint32_t neighbour_first[9];
  std::uint32_t neighbour[24];
};

/// The two other axes, in order.
constexpr std::uint32_t lower_other(std::uint32_t axis) {
  return axis == 0 ? 1 : 0;
}
constexpr std::uint32_t upper_other(std::uint32_t axis) {
  return axis == 2 ? 1 : 2;
}

constexpr std::uint32_t box_edge(std::uint32_t v, std::uint32_t w) {
  const std::uint32_t axis = (v ^ w) >> 1U;
  const std::uint32_t low = v & w;
  return 4 * axis + (low >> lower_other(axis) & 1U) + 2 * (low >> upper_other(axis) & 1U);
}

constexpr BoxTopology make_box_topology() {
  BoxTopology t{};
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    const std::uint32_t u = 1U << (axis + 1) % 3;
    const std::uint32_t v = 1U << (axis + 2) % 3;
    for (std::uint32_t side = 0; side < 2; ++side) {
      const std::uint32_t face = 2 * axis + side;
      const std::uint32_t base = side << axis;
      const std::uint32_t corner[4] = {base, base + (side == 1 ? u : v), base + u + v,
                                       base + (side == 1 ? v : u)};
      t.faces[face].normal[axis] = side == 1 ? 1.0 : -1.0;
      t.faces[face].first = 4 * face;
      t.faces[face].count = 4;
      for (std::uint32_t i = 0; i < 4; ++i) {
        t.loop[4 * face + i] = corner[i];
        t.loop_edge[4 * face + i] = box_edge(corner[i], corner[(i + 1) % 4]);
      }
    }
    for (std::uint32_t j = 0; j < 4; ++j) {
      const std::uint32_t p = lower_other(axis);
      const std::uint32_t q = upper_other(axis);
      const std::uint32_t low = (j & 1U) << p | (j >> 1U) << q;
      t.edges[4 * axis + j] = {{low, low + (1U << axis)}, {2 * p + (j & 1U), 2 * q + (j >> 1U)}};
    }
  }
  for (std::uint32_t v = 0; v < 8; ++v) {
    t.neighbour_first[v + 1] = 3 * (v + 1);
    for (std::uint32_t k = 0; k < 3; ++k) t.neighbour[3 * v + k] = v ^ 1U << k;
  }
  return t;
}

inline constexpr BoxTopology kBoxTopology = make_box_topology();

/// Factor that makes a computed length an upper bound of the exact one.
inline constexpr double kOverRoundings = 1.0 + 1e-15;

/// The two sides of a triangle; they share all edges.
inline constexpr std::uint32_t kTriangleLoop[6] = {0, 1, 2, 0, 2, 1};
inline constexpr std::uint32_t kTriangleLoopEdge[6] = {0, 1, 2, 2, 1, 0};
inline constexpr HullEdge kTriangleEdges[3] = {
    {{0, 1}, {0, 1}}, {{1, 2}, {0, 1}}, {{2, 0}, {0, 1}}};
inline constexpr std::uint32_t kTriangleNeighbourFirst[4] = {0, 2, 4, 6};
inline constexpr std::uint32_t kTriangleNeighbours[6] = {1, 2, 0, 2, 0, 1};
inline constexpr HullEdge kSegmentEdge[1] = {{{0, 1}, {~0U, ~0U}}};
inline constexpr std::uint32_t kSegmentNeighbourFirst[3] = {0, 1, 2};
inline constexpr std::uint32_t kSegmentNeighbours[2] = {1, 0};

/// A hull of up to eight vertices and six faces, with storage for everything that it points to;
/// must not be moved. Its faces have no planes until complete() is called: many pairs are decided
/// without them.
class CoreHull {
 public:
  /// Uninitialized, because a small job uses few of the slots.
  CoreHull() {}
  CoreHull(const CoreHull&) = delete;
  CoreHull& operator=(const CoreHull&) = delete;

  const HullShape& of(const SphereShape& sphere) {
    const double origin[1][3] = {{0.0, 0.0, 0.0}};
    begin(origin, 1, 0, sphere.radius);
    return hull_;
  }

  const HullShape& of(const CapsuleShape& capsule) {
    const double h = capsule.half_length;
    const double ends[2][3] = {{0.0, 0.0, -h}, {0.0, 0.0, h}};
    begin(ends, 2, 1, capsule.radius);
    hull_.radius = h;
    hull_.edge_count = 1;
    hull_.edges = kSegmentEdge;
    hull_.neighbour_first = kSegmentNeighbourFirst;
    hull_.neighbour = kSegmentNeighbours;
    return hull_;
  }

  const HullShape& of(const BoxShape& box) {
    double corner[8][3];
    double least = box.half[0];
    double square = 0.0;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const double h = box.half[k];
      least = h < least ? h : least;
      square += h * h;
      for (std::uint32_t i = 0; i < 8; ++i) corner[i][k] = (i >> k & 1U) != 0 ? h : -h;
    }
    begin(corner, 8, 3, box.rounding);
    hull_.radius = __builtin_sqrt(square) * kOverRoundings;
    hull_.inner_radius = least;
    hull_.face_count = 6;
    hull_.edge_count = 12;
    hull_.faces = kBoxTopology.faces;
    hull_.edges = kBoxTopology.edges;
    hull_.loop = kBoxTopology.loop;
    hull_.loop_edge = kBoxTopology.loop_edge;
    hull_.neighbour_first = kBoxTopology.neighbour_first;
    hull_.neighbour = kBoxTopology.neighbour;
    return hull_;
  }

  const HullShape& of(const TriangleShape& triangle) {
    begin(triangle.vertex, 3, 2, triangle.rounding);
    const auto& v = triangle.vertex;
    for (int k = 0; k < 3; ++k) hull_.center[k] = (v[0][k] + v[1][k] + v[2][k]) / 3.0;
    double most = 0.0;
    for (const Vec3d& x : v) {
      const double d[3] = {x[0] - hull_.center[0], x[1] - hull_.center[1], x[2] - hull_.center[2]};
      const double square = dot3(d, d);
      most = square > most ? square : most;
    }
    hull_.radius = __builtin_sqrt(most) * kOverRoundings;
    hull_.edge_count = 3;
    hull_.edges = kTriangleEdges;
    hull_.loop = kTriangleLoop;
    hull_.loop_edge = kTriangleLoopEdge;
    hull_.neighbour_first = kTriangleNeighbourFirst;
    hull_.neighbour = kTriangleNeighbours;
    hull_.face_count = 2;
    hull_.faces = face_;
    return hull_;
  }

  /// Computes the planes of the faces; returns false if they are not reliable.
  bool complete() {
    if (hull_.dimension == 2) return complete_triangle();
    for (std::uint32_t face = 0; face < hull_.face_count; ++face) {
      // The last vertex of a box is at the positive end of every axis.
      set_plane(face, hull_.faces[face].normal.data(), vertex_[face / 2][7]);
    }
    return true;
  }

 private:
  template <typename Point>
  void begin(const Point* vertex, std::uint32_t count, std::uint32_t dimension, double rounding) {
    hull_ = HullShape{};
    for (auto& column : plane_) {
      for (float& x : column) x = 0.0F;
    }
    hull_.vertex_count = count;
    hull_.dimension = dimension;
    hull_.rounding = rounding;
    for (int k = 0; k < 3; ++k) {
      for (std::uint32_t i = 0; i < kRow; ++i) vertex_[k][i] = vertex[i < count ? i : 0][k];
      for (std::uint32_t i = 0; i < kLanes; ++i) {
        vertex_float_[k][i] = static_cast<float>(vertex_[k][i < count ? i : 0]);
      }
      hull_.vertex[k] = vertex_[k];
      hull_.vertex_float[k] = vertex_float_[k];
    }
    for (int k = 0; k < 4; ++k) hull_.plane_float[k] = plane_[k];
  }

  bool complete_triangle() {
    double v[3][3];
    double e[3];
    double f[3];
    double n[3];
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < 3; ++i) v[i][k] = vertex_[k][i];
      e[k] = v[1][k] - v[0][k];
      f[k] = v[2][k] - v[0][k];
    }
    cross3(e, f, n);
    const double area = __builtin_sqrt(dot3(n, n));
    // Slivers are left to the solver.
    if (!(area > 1e-6 * (dot3(e, e) + dot3(f, f)))) return false;
    for (int k = 0; k < 3; ++k) {
      face_[0].normal[k] = n[k] / area;
      face_[1].normal[k] = -face_[0].normal[k];
    }
    for (std::uint32_t side = 0; side < 2; ++side) {
      face_[side].offset = dot3(face_[side].normal.data(), v[0]);
      face_[side].first = 3 * side;
      face_[side].count = 3;
      set_plane(side, face_[side].normal.data(), face_[side].offset);
    }
    return true;
  }

  void set_plane(std::uint32_t face, const double* normal, double offset) {
    for (int k = 0; k < 3; ++k) plane_[k][face] = static_cast<float>(normal[k]);
    plane_[3][face] = static_cast<float>(offset);
  }

  static constexpr std::uint32_t kRow = Doubles::kCount;
  static_assert(kRow >= 8);

  union {
    HullShape hull_;
  };
  HullFace face_[2];
  alignas(64) double vertex_[3][kRow];
  alignas(64) float vertex_float_[3][kLanes];
  /// Rows beyond the number of faces are not read as faces.
  alignas(64) float plane_[4][kLanes];
};

/// Selects the class that computes a shape's supports.
template <typename Shape>
struct SecondsOf;
template <>
struct SecondsOf<SphereShape> {
  using Type = CenteredSeconds<0>;
};
template <>
struct SecondsOf<CapsuleShape> {
  using Type = CenteredSeconds<1>;
};
template <>
struct SecondsOf<BoxShape> {
  using Type = CenteredSeconds<3>;
};
template <>
struct SecondsOf<TriangleShape> {
  using Type = TriangleSeconds;
};

static inline const SphereShape* table_of(const ShapeTables& t, const SphereShape*) {
  return t.spheres;
}
static inline const CapsuleShape* table_of(const ShapeTables& t, const CapsuleShape*) {
  return t.capsules;
}
static inline const BoxShape* table_of(const ShapeTables& t, const BoxShape*) {
  return t.boxes;
}
static inline const TriangleShape* table_of(const ShapeTables& t, const TriangleShape*) {
  return t.triangles;
}

/// A simple shape and a hull. The hull is the first of the HullPair; the simple shape is on body a
/// if `Before`.
template <typename Shape, bool Before>
class CoreAndHull {
 public:
  static constexpr std::uint32_t kRoom = 64;
  static constexpr bool kSimpleSecond = true;
  static constexpr bool kPointSecond = __is_same(Shape, SphereShape);
  using Seconds = typename SecondsOf<Shape>::Type;

  bool place(const NarrowJob& job, BodyPair bodies, std::uint32_t slot, HullPair& pair) {
    const std::uint32_t simple = Before ? bodies.a : bodies.b;
    const std::uint32_t body = Before ? bodies.b : bodies.a;
    const Shape& shape =
        table_of(*job.tables, static_cast<const Shape*>(nullptr))[job.shapes[simple].index()];
    const HullShape& hull = job.tables->hulls[job.shapes[body].index()];
    const HullShape& core = core_[slot].of(shape);
    const HullShape& a = Before ? core : hull;
    const HullShape& b = Before ? hull : core;
    return place_hulls<kPointSecond>(a, b, job.poses[bodies.a], job.poses[bodies.b], Before, pair);
  }

  bool complete(std::uint32_t slot) { return core_[slot].complete(); }

 private:
  CoreHull core_[kRoom];
};

}  // namespace WINNOW_ISA_NAME::hull

extern const NarrowKernels WINNOW_KERNEL_TABLE(sphere_hull_kernels) =
    WINNOW_ISA_NAME::hull::kHullKernels<WINNOW_ISA_NAME::hull::CoreAndHull<SphereShape, true>>;
extern const NarrowKernels WINNOW_KERNEL_TABLE(capsule_hull_kernels) =
    WINNOW_ISA_NAME::hull::kHullKernels<WINNOW_ISA_NAME::hull::CoreAndHull<CapsuleShape, true>>;
extern const NarrowKernels WINNOW_KERNEL_TABLE(box_hull_kernels) =
    WINNOW_ISA_NAME::hull::kHullKernels<WINNOW_ISA_NAME::hull::CoreAndHull<BoxShape, true>>;
extern const NarrowKernels WINNOW_KERNEL_TABLE(hull_triangle_kernels) =
    WINNOW_ISA_NAME::hull::kHullKernels<WINNOW_ISA_NAME::hull::CoreAndHull<TriangleShape, false>>;

}  // namespace winnow
