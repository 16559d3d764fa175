#pragma once

#include "pipeline/mesh/height_pyramid.h"
#include "pipeline/mesh/mesh_view.h"

namespace winnow {

// What HeightField::overlap, sweep and near do.

void height_overlap(const HeightGrid& grid, const double min[3], const double max[3],
                    SlotSink& out) noexcept;
void height_sweep(const HeightGrid& grid, const double min[3], const double max[3],
                  const double direction[3], double limit, const SlotVisitor& visitor) noexcept;
void height_near(const HeightGrid& grid, const double min[3], const double max[3], double limit,
                 const SlotVisitor& visitor) noexcept;

}  // namespace winnow
