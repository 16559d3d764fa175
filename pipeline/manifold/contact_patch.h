#pragma once

// Contact manifolds by clipping: the supporting features of two shapes, projected along the contact
// normal, and the contact points in which they overlap. Called by the kernels and by
// solver/manifold.cpp. Kernel files include this header, so it defines no inline functions.

#include <winnow/pipeline/contact_types.h>

#include <cstdint>

namespace winnow {

/// Kind of a feature: the upper two bits of its 32-bit id.
enum class FeatureKind : std::uint32_t { vertex = 0, edge = 1, face = 2 };
inline constexpr std::uint32_t kFeatureKindShift = 30;

/// Supporting feature of a core: the feature farthest along (for a) or against (for b) the contact
/// normal. One vertex, an edge, or a convex polygon in order around its boundary, of either
/// winding. Vertices are relative to the position of body a, in world axes.
struct SupportingFeature {
  const double (*vertex)[3];
  /// Feature numbers of the vertices, and of the edges from vertex i to the next. The two number
  /// spaces may overlap.
  const std::uint32_t* vertex_feature;
  const std::uint32_t* edge_feature;
  std::uint32_t count;
  /// Feature number of the face or edge itself.
  std::uint32_t feature;
  double rounding;
};

/// Computes the contact points of two patches. The patches are projected along the normal; the one
/// that faces the normal better is the reference, and the other one is clipped against its sides.
/// The first point is the deepest one, or a point of nearly the same depth (kTiedDepth), which gets
/// the depth of the deepest. Up to three more points within `margin` follow, which span the largest
/// area with it. Ties are broken by a direction that is fixed in one of the bodies. Depths are
/// measured along `normal` (unit, from a to b). A feature id is the number of a vertex, of an edge
/// plus 2^30, or of a face plus 2^31. If the projections do not overlap, the only point is where
/// they are closest. Writes to `out` (room for kManifoldPoints) and returns the number of points; 0
/// only for a patch without vertices. Deterministic. Uses at most 16 vertices per patch: larger
/// patches are reduced to their outermost vertices and the deepest one. All numbers must be finite,
/// and no product of four lengths may overflow.
std::uint32_t contact_patch(const SupportingFeature& a, const SupportingFeature& b,
                            const double normal[3], double margin, ContactPoint* out) noexcept;

/// Depths that differ by less than this share of the extent of a patch count as equal. Among points
/// of equal depth, the choice is stable while bodies jitter by some 1e-4 radians; the first point
/// gets the depth of the deepest.
inline constexpr double kTiedDepth = 6e-5;
/// Returns kTiedDepth times the largest distance of a contact point from the first one.
double tied_depth(const ContactPoint* points, std::uint32_t count) noexcept;

/// Chooses the corners of a patch that touch an unbounded plane with normal `up`, as contact_patch
/// would: among corners no higher than `highest` along `up`. Writes the numbers of at most
/// kManifoldPoints corners, the lowest first, and returns how many.
std::uint32_t corners_on_plane(const SupportingFeature& patch, const double up[3], double highest,
                               std::uint32_t* corner) noexcept;

/// Maximal number of corners of the intersection of two patches.
inline constexpr std::uint32_t kMaxIntersectionCorners = 32;
/// As contact_patch, but returns all corners of the intersection that are within `margin`, the
/// deepest first. `out` has room for kMaxIntersectionCorners.
std::uint32_t intersection_corners(const SupportingFeature& a, const SupportingFeature& b,
                                   const double normal[3], double margin,
                                   ContactPoint* out) noexcept;

// Patches of boxes and triangles, one pair at a time, in double.

/// A box at its pose, relative to the position of body a, in world axes.
struct BoxFrame {
  /// Unit vectors.
  double axis[3][3];
  double half[3];
  double center[3];
  double rounding;
};

/// A triangle at its pose, likewise.
struct TriangleFrame {
  double vertex[3][3];
  double rounding;
};

/// A patch that stores up to four vertices with their feature numbers.
struct FlatFeature {
  double vertex[4][3];
  std::uint32_t vertex_feature[4];
  std::uint32_t edge_feature[4];
  std::uint32_t count;
  std::uint32_t feature;
  double rounding;
};

/// Returns the face of a box that faces `normal`. Vertices are numbered by the bits x > 0, y > 0, z
/// > 0; edges by 4 x their axis plus the bits of the other axes; faces by 2 x their axis plus the
/// sign.
[[nodiscard]] FlatFeature flat_box_feature(const BoxFrame& box, const double normal[3]) noexcept;
/// Returns the triangle: vertices 0 to 2, edge i from vertex i to the next, face 0.
[[nodiscard]] FlatFeature flat_triangle_feature(const TriangleFrame& triangle) noexcept;

/// contact_patch of two such patches.
std::uint32_t flat_contacts(const FlatFeature& a, const FlatFeature& b, const double normal[3],
                            double margin, ContactPoint* out) noexcept;

/// Face number of a triangle in kernels; a box has faces 0 to 5.
inline constexpr std::uint32_t kTriangleFace = 6;

/// Two faces projected along their normal, one of several pairs that a kernel computed: the
/// outlines of flat_box_feature or flat_triangle_feature without feature ids, neither thin nor
/// steep. Each number is in one of the rows from `rows` on, which are `kStride` apart.
struct ProjectedFaces {
  static constexpr std::uint32_t kStride = 8;
  /// Rows of a face. The coordinates of corner i are i rows further.
  enum Row : std::uint8_t {
    kX = 0,
    kY = 4,
    kH = 8,
    kSize = 12,
    kSlope = 13,
    kCosine = 15,
    kFaceRows = 16
  };
  /// Rows of the pair: the three axes of the projection, then both faces.
  static constexpr std::uint32_t kFaces = 9;
  static constexpr std::uint32_t kRows = kFaces + 2 * kFaceRows;

  const double* rows;
  /// Face numbers; kTriangleFace for a triangle.
  std::uint32_t face[2];
  /// True if the corners are clockwise.
  bool clockwise[2];
  double rounding[2];
};

/// contact_patch of these faces.
std::uint32_t projected_contacts(const ProjectedFaces& faces, double margin,
                                 ContactPoint* out) noexcept;

/// Finds the point of a where two patches overlap deepest along the normal, and returns the depth
/// of the cores there, without rounding. If the projections do not overlap, finds the point where
/// they are closest, and returns minus infinity. Both patches must have vertices.
double deepest_point(const SupportingFeature& a, const SupportingFeature& b, const double normal[3],
                     double point[3]) noexcept;
double deepest_point(const FlatFeature& a, const FlatFeature& b, const double normal[3],
                     double point[3]) noexcept;

}  // namespace winnow
