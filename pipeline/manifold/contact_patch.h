#pragma once

// The features of two shapes across a contact normal, and the contact points in which they meet.
// Kernel files include this, so nothing here is inline.

#include <winnow/pipeline/contact_types.h>

#include <cstdint>

namespace winnow {

/// What lies across a contact normal, since bodies rock over it: a face whose normal is within 14
/// degrees of it, else an edge within as many of perpendicular to it. The cosine and the sine.
inline constexpr double kFaceCosine = 0.97;
inline constexpr double kEdgeSine = 0.25;

/// Caps of cylinders and cones count up to 45 degrees off, else a line of the side does. A rim is a
/// polygon that begins at +x, so that its corners stay where they are in a body that trembles.
/// Corners of the upper cap are numbered from 0, of the lower from kRimCorners, the ends of a line
/// of the side from kSideLine.
inline constexpr double kCapCosine = 0.7071;
inline constexpr std::uint32_t kRimCorners = 16;
inline constexpr std::uint32_t kSideLine = 2 * kRimCorners;
/// A polygon whose area is this much smaller than its size squared, or whose plane is so close to
/// the normal, looks like a segment.
inline constexpr double kThin = 1e-12;
inline constexpr double kSteep = 1e-6;

/// What a feature id says about its number: the upper two of 32 bits.
enum class FeatureKind : std::uint32_t { vertex = 0, edge = 1, face = 2 };
inline constexpr std::uint32_t kFeatureKindShift = 30;
/// Directions whose sine with the axis is less are along it.
inline constexpr double kAlongAxis = 1e-9;

/// Of faces with more corners than that every second (third, ...) is a corner of their patch.
inline constexpr std::uint32_t kPatchRoom = 64;

/// A direction across a normal that stays in the body while that trembles: of its axes the first
/// that is no closer to the normal than this cosine, turned about the normal by the golden part of
/// a half turn (cosine and sine), far from the axes of all regular polygons.
inline constexpr double kAxisCosine = 0.6;
inline constexpr double kOffAxes[2] = {0.36237489008048024, 0.9320324238132276};

/// Of sets that are known by their farthest points: those in directions that are off by less than
/// this tangent lie across a normal, if they are in one plane but for this share of their distance.
inline constexpr double kSampleTilt = 0.04;
inline constexpr double kSampleLevel = 1e-6;

/// A capsule lies beside another if the square of the sine of the angle between them is less than
/// the first, the stretch over which it does is longer than the second, as a share of both half
/// lengths, and an end of it is hardly less deep than the pair, by the third, as a share of the
/// radii: two contacts then say more than one.
inline constexpr double kBesideSquare = 0.01;
inline constexpr double kLeastBeside = 1e-3;
inline constexpr double kHardlyLess = 1e-3;

/// The feature of a core that lies farthest along (for a) or against (for b) the contact normal:
/// one vertex, an edge, or a convex polygon in order around its boundary (either way). Vertices are
/// relative to the position of body a, in the axes of the world.
struct Patch {
  const double (*vertex)[3];
  /// What each vertex is called in its shape, and each edge from vertex i to the next. The two
  /// number spaces may overlap.
  const std::uint32_t* vertex_feature;
  const std::uint32_t* edge_feature;
  std::uint32_t count;
  /// The number of the face or edge itself.
  std::uint32_t feature;
  double rounding;
};

/// The points in which two patches meet, seen along the normal: the one that faces it better is the
/// reference, the other is clipped by its sides. The deepest point comes first, always, or one that
/// is hardly less deep (kTiedDepth) with its depth, then of those that are no farther apart than
/// `margin` at most three more, which span the largest area with it. Of equals those are kept that
/// lie farther along a direction fixed in one of the bodies. Depths are measured along `normal`
/// (unit, from a to b). Features are a vertex's number, an edge's plus 2^30 or a face's plus 2^31.
/// Patches that do not meet give the one point where they come closest. Writes to `out` (room for
/// kManifoldPoints), returns the number of points, 0 only for a patch without vertices.
/// Deterministic; needs no memory for patches of up to 16 vertices, and thins larger ones to 16 of
/// their vertices, the outermost and the deepest. All numbers are finite and no product of four
/// lengths overflows.
std::uint32_t contact_patch(const Patch& a, const Patch& b, const double normal[3], double margin,
                            ContactPoint* out) noexcept;

/// As a share of how far a patch reaches: depths that differ by less are equal. Of points that are
/// equally deep some are kept that stay the same while bodies tremble, by some ten-thousandths of a
/// radian; the first has the depth of the deepest.
inline constexpr double kTiedDepth = 6e-5;
/// The same as a depth: of points of contact by how far they are from the first.
double tied_depth(const ContactPoint* points, std::uint32_t count) noexcept;

/// The numbers of a patch's corners that contact_patch keeps of it on an endless face, of those no
/// higher than `highest` along `up`, the normal of the face: at most kManifoldPoints, the lowest
/// first.
std::uint32_t standing_corners(const Patch& patch, const double up[3], double highest,
                               std::uint32_t* corner) noexcept;

/// A segment whose ends are closer to a side of a polygon than this share of the smaller one's size
/// lies along it, inside.
inline constexpr double kAlongSide = 1.5e-4;

/// At most so many corners has what two patches share.
inline constexpr std::uint32_t kSharedCorners = 32;
/// The same before the points are thinned: all corners of what the patches share that are no
/// farther apart than `margin`, the deepest first. Room for kSharedCorners.
std::uint32_t shared_corners(const Patch& a, const Patch& b, const double normal[3], double margin,
                             ContactPoint* out) noexcept;

// From boxes and triangles in the axes of the world to patches: one pair at a time, in double.

/// A box where it stands, relative to the position of body a.
struct BoxFrame {
  /// Unit vectors.
  double axis[3][3];
  double half[3];
  double center[3];
  double rounding;
};

/// A triangle where it stands, likewise.
struct TriangleFrame {
  double vertex[3][3];
  double rounding;
};

/// Up to four vertices with their numbers.
struct FlatPatch {
  double vertex[4][3];
  std::uint32_t vertex_feature[4];
  std::uint32_t edge_feature[4];
  std::uint32_t count;
  std::uint32_t feature;
  double rounding;
};

/// The face of a box that looks along `normal`. Vertices are numbered by the bits x > 0, y > 0,
/// z > 0, edges by 4 x their axis and the bits of the others, faces by 2 x their axis and the sign.
[[nodiscard]] FlatPatch box_patch(const BoxFrame& box, const double normal[3]) noexcept;
/// The triangle: vertices 0 to 2, edge i from vertex i to the next, face 0.
[[nodiscard]] FlatPatch triangle_patch(const TriangleFrame& triangle) noexcept;

/// contact_patch of two of them.
std::uint32_t flat_contacts(const FlatPatch& a, const FlatPatch& b, const double normal[3],
                            double margin, ContactPoint* out) noexcept;

/// Faces of boxes by number, and the triangle, as kernels see them.
inline constexpr std::uint32_t kTriangleFace = 6;

/// Two faces seen along their normal, of one of many pairs: what the outlines of box_patch or
/// triangle_patch are, but for names, neither of them thin or steep. A number stands in each of the
/// rows from `rows` on, `kStride` apart.
struct SeenFaces {
  static constexpr std::uint32_t kStride = 8;
  /// Rows of a face. Coordinates of corner i are i rows on.
  enum Row : std::uint8_t {
    kX = 0,
    kY = 4,
    kH = 8,
    kSize = 12,
    kSlope = 13,
    kCosine = 15,
    kFaceRows = 16
  };
  /// Rows of the pair: the axes along which they are seen, then both faces.
  static constexpr std::uint32_t kFaces = 9;
  static constexpr std::uint32_t kRows = kFaces + 2 * kFaceRows;

  const double* rows;
  /// Numbers of faces, or kTriangleFace.
  std::uint32_t face[2];
  /// Corners are clockwise.
  bool clockwise[2];
  double rounding[2];
};

/// contact_patch of them.
std::uint32_t seen_contacts(const SeenFaces& faces, double margin, ContactPoint* out) noexcept;

/// The point of a where two patches meet deepest along the normal; returns how deep the cores are
/// there. Patches, which have vertices, that do not meet give the point where they come closest,
/// and minus infinity.
double deepest_point(const Patch& a, const Patch& b, const double normal[3],
                     double point[3]) noexcept;
double deepest_point(const FlatPatch& a, const FlatPatch& b, const double normal[3],
                     double point[3]) noexcept;

}  // namespace winnow
