#pragma once

#include "pipeline/composites/side.h"

namespace winnow::mid {

/// True if one well-chosen axis shows that a part is farther from a triangle than `margin`: always
/// the right one for spheres and half-spaces. False proves nothing.
[[nodiscard]] bool is_apart(const ShapeTables& tables, const Part& part, const Corners& triangle,
                            double margin) noexcept;
/// The same of two triangles, by their boxes and by both planes.
[[nodiscard]] bool is_apart(const Corners& a, const Corners& b, double margin) noexcept;

/// Slots of a mesh that may reach below normal . x <= offset, in the mesh's own units, ascending.
void mesh_below(const MeshView& mesh, const Vec& normal, double offset, SlotSink& out) noexcept;

}  // namespace winnow::mid
