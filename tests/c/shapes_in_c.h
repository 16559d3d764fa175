#pragma once

/* Shapes of every kind, for worlds that are built in C. */

#include "tests/c/trace.h"

#include <winnow/c/winnow.h>

enum { kConvex = 12, kComposite = 4 };

void make_shapes(const trace* t, winnow_shape_pool* pool, winnow_shape_id* ids);
void make_composites(const trace* t, winnow_composite_pool* pool, const winnow_shape_id* convex,
                     winnow_shape_id* ids);
