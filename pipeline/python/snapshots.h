#pragma once

#include "pipeline/python/partition.h"
#include "pipeline/python/shared_scene.h"
#include "pipeline/python/shared_shapes.h"

namespace winnow::python {

// Each adds `save` and `load`.
void add_partition_snapshots(PartitionClass& partition);
void add_shape_snapshots(ShapesClass& shapes);
void add_scene_snapshots(SceneClass& scene);

}  // namespace winnow::python
