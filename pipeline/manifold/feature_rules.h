#pragma once

// The rules that choose the feature of a shape that supports a contact, and that decide which
// polygons and segments are degenerate. Kernels and the solver apply the same rules, so that their
// manifolds agree. Kernel files include this header, so it defines no functions.

#include <cstdint>

namespace winnow {

/// Cosine and sine of the limits for features that support along a contact normal: a face whose
/// normal is within 14 degrees of the contact normal, else an edge within 14 degrees of
/// perpendicular to it. The limits are this wide because bodies rock.
inline constexpr double kFaceCosine = 0.97;
inline constexpr double kEdgeSine = 0.25;

/// The cap of a cylinder or cone supports up to 45 degrees from the normal, else a line of its side
/// does. A rim is a polygon that begins at +x, so that its corners are fixed in the body while it
/// jitters. Corners of the upper cap are numbered from 0, corners of the lower cap from
/// kRimCorners, and the ends of a side line from kSideLine.
inline constexpr double kCapCosine = 0.7071;
inline constexpr std::uint32_t kRimCorners = 16;
inline constexpr std::uint32_t kSideLine = 2 * kRimCorners;
/// A direction whose sine with the axis is less than this counts as parallel to the axis.
inline constexpr double kAlongAxis = 1e-9;

/// Maximal number of vertices of a patch. If a face has more corners, every second (third, ...)
/// one is used.
inline constexpr std::uint32_t kPatchRoom = 64;

/// A direction that is perpendicular to a normal, and fixed in the body while the body jitters: the
/// first axis of the body whose cosine with the normal is at most kAxisCosine, rotated about the
/// normal by the golden section of a half turn (cosine and sine), away from the axes of all regular
/// polygons.
inline constexpr double kAxisCosine = 0.6;
inline constexpr double kOffAxes[2] = {0.36237489008048024, 0.9320324238132276};

/// For shapes with a support function: the support points of directions that deviate from the
/// normal by the tangent kSampleTilt form a face, if they lie in one plane up to kSampleLevel of
/// their distance.
inline constexpr double kSampleTilt = 0.04;
inline constexpr double kSampleLevel = 1e-6;

/// Two capsules are side by side if the squared sine of the angle between them is less than
/// kBesideSquare, their overlap along the axis is longer than kMinOverlapLength times the sum of
/// their half lengths, and an end of the overlap is less deep than the pair by at most
/// kEndDepthTolerance times the sum of the radii. They then have two contacts instead of one.
inline constexpr double kBesideSquare = 0.01;
inline constexpr double kMinOverlapLength = 1e-3;
inline constexpr double kEndDepthTolerance = 1e-3;

/// A polygon counts as a segment if its area is less than kThin times its size squared, or if the
/// cosine between its normal and the contact normal is less than kSteep.
inline constexpr double kThin = 1e-12;
inline constexpr double kSteep = 1e-6;

/// A segment whose ends are closer to a side of a polygon than this share of the smaller of both
/// sizes counts as a part of that side, inside the polygon.
inline constexpr double kAlongSide = 1.5e-4;

}  // namespace winnow
