#pragma once

#include <winnow/pipeline/mid_phase.h>

namespace winnow::mid {

/// See MidPhase::smooth.
///
/// A contact of a triangle is one with an edge or a corner if that is what lies farthest along the
/// contact's normal. Where a neighbour continues the surface beyond, the surface as a whole has no
/// edge there, and only the face's normal makes sense. Then:
/// - shapes that are apart keep their distance, its bound and their points, and get the normal;
/// - so do shapes that only their rounding lets touch, with the point of a sphere moved below its
///   centre, so that it does not turn;
/// - others are clipped against the triangle along the normal, and the depth is that of the
///   clipped points, at least what it was. It is as it was where nothing is left of them, and where
///   it would be several times what it is for any contact of the same bodies: they are beside the
///   surface then, not above it.
/// No contact is lost: the distance to a face's plane is never more than that to the face. Contacts
/// of triangles of two meshes stay as they are: which face's normal is meant is not known. Which
/// edges are active is known for the front of a surface only; on its back concave edges, which look
/// convex from there, are taken for inner ones too, so that a floor is flat whichever way its
/// triangles are wound.
void smooth(const ShapePool& shapes, const PrimitivePairs& pairs, const Execution& execution,
            NarrowResult& result) noexcept;

}  // namespace winnow::mid
