#pragma once

#include "pipeline/scene/scene_state.h"

namespace winnow {

/// Corrects the contacts of solids that are not convex, whose surfaces have contacts like other
/// meshes. Call it after mid::correct_surface_contacts.
///
/// The contacts of a pair stay if moving b by the least translation that leaves all of them parts
/// the bodies. Else they contradict the solid: a triangle that another body has passed by more than
/// half pushes it farther in, and a body within a solid touches no triangle. Then one manifold with
/// the depth of the solid (find_solid_depth) replaces them. If the other body is convex, its points
/// are those over a plane at the end of the way out. At level boolean, the pair overlaps.
///
/// `pairs` are the pairs of bodies of the primitive pairs. O(overlap test of the bodies) for each
/// pair with a solid, and O(depth) if the contacts are replaced. `out_of_memory` leaves some pairs
/// as they were.
[[nodiscard]] Status correct_solid_contacts(const SceneState& scene, const Column<BodyPair>& pairs,
                                            const PairMargins& margins, PartAnswers& found);

}  // namespace winnow
