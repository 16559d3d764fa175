"""Collision detection: pairs that may touch, pairs that do, and their contacts.

All calls take numpy arrays of many objects and return arrays; they release the GIL during work.

    import winnow
    partition = winnow.Partition("LinearBvh")
    keys = partition.insert(lower, upper)      # (n, 3) each, float or double, any strides
    pairs = partition.self_pairs()             # (m, 2) uint32 of ids
    ids = winnow.ids_of(keys)

A failed call raises a `StatusError` with the status, and changes nothing. Arrays that are returned
keep their data alive, and the data do not change.
"""

from typing import Any, Optional

import numpy
import numpy.typing

from winnow._core import (
    DYNAMIC,
    EVERY_ENVIRONMENT,
    FIXED,
    NO_CONTACT,
    NO_IMPACT,
    NO_OBJECT,
    NULL_KEY,
    REST_COLOUR,
    SLEEPING,
    WHOLE_SHAPE,
    Cluster,
    ClusterScene,
    ContactGroups,
    Contacts,
    DeformableMesh,
    Drawing,
    Filter,
    HitLists,
    Hits,
    Impacts,
    MeshImpacts,
    MeshProximities,
    MeshShapeImpacts,
    NarrowPhase,
    NarrowResult,
    Overlaps,
    PairEvents,
    Partition,
    RayHits,
    Recorder,
    Scene,
    SceneDistances,
    SceneHitLists,
    SceneHits,
    SceneImpacts,
    SceneOverlaps,
    Sensed,
    Sensors,
    Shapes,
    StatusError,
    __version__,
    available_isas,
    boxes_address,
    feature_impacts,
    frusta_of,
    isa_name,
    kdop_directions,
    motions_between,
    motions_by_velocities,
    outward,
    perspective,
    poses_at,
    replay,
    set_isa,
    set_log_hook,
    set_stage_hook,
    structures,
    time_of_impact,
)
from winnow.advice import Advice, Advised, advise

__all__ = [
    "DYNAMIC",
    "EVERY_ENVIRONMENT",
    "FIXED",
    "NO_CONTACT",
    "NO_IMPACT",
    "NO_OBJECT",
    "NULL_KEY",
    "REST_COLOUR",
    "SLEEPING",
    "WHOLE_SHAPE",
    "__version__",
    "Advice",
    "Advised",
    "Cluster",
    "ClusterScene",
    "ContactGroups",
    "Contacts",
    "DeformableMesh",
    "Drawing",
    "Filter",
    "HitLists",
    "Hits",
    "Impacts",
    "MeshImpacts",
    "MeshProximities",
    "MeshShapeImpacts",
    "NarrowPhase",
    "NarrowResult",
    "Overlaps",
    "PairEvents",
    "Partition",
    "RayHits",
    "Recorder",
    "Scene",
    "SceneDistances",
    "SceneHitLists",
    "SceneHits",
    "SceneImpacts",
    "SceneOverlaps",
    "Sensed",
    "Sensors",
    "Shapes",
    "StatusError",
    "advise",
    "available_isas",
    "boxes_address",
    "feature_impacts",
    "frusta_of",
    "ids_of",
    "isa_name",
    "kdop_directions",
    "mesh_distance",
    "motions_between",
    "motions_by_velocities",
    "outward",
    "pairs",
    "perspective",
    "poses_at",
    "replay",
    "set_isa",
    "set_log_hook",
    "set_stage_hook",
    "structures",
    "time_of_impact",
]


def ids_of(keys: "numpy.typing.NDArray[numpy.uint64]") -> "numpy.typing.NDArray[Any]":
    """Returns ids of objects, uint32 in the shape of `keys`: a view of the lower halves."""
    if keys.dtype != numpy.uint64:
        raise TypeError("keys: expected uint64, not " + str(keys.dtype))
    return keys.view(numpy.dtype({"names": ["id"], "formats": ["<u4"], "itemsize": 8}))["id"]


def pairs(
    lower: "numpy.typing.ArrayLike", upper: "numpy.typing.ArrayLike", structure: str = "LinearBvh"
) -> "numpy.typing.NDArray[numpy.uint32]":
    """Returns the pairs of boxes that overlap, (m, 2) indices: first < second, sorted.

    `lower` and `upper` are (n, 3) corners. For boxes that move, keep a `Partition`.
    """
    partition = Partition(structure)
    partition.insert(lower, upper)
    return partition.self_pairs(order="canonical")


def mesh_distance(
    points_a: "numpy.typing.ArrayLike",
    triangles_a: "numpy.typing.ArrayLike",
    points_b: "numpy.typing.ArrayLike",
    triangles_b: "numpy.typing.ArrayLike",
    pose_a: "Optional[numpy.typing.ArrayLike]" = None,
    pose_b: "Optional[numpy.typing.ArrayLike]" = None,
) -> SceneDistances:
    """Returns the closest points of two triangle meshes, and their distance: one row.

    Points are (n, 3), triangles (m, 3) indices; a pose is a position, or seven numbers: x, y, z and
    a quaternion w, x, y, z. If the meshes overlap, the distance is minus the depth of the deepest
    pair of triangles. For many queries, keep a `Scene`.
    """
    shapes = Shapes()
    meshes = [shapes.add_mesh(points_a, triangles_a), shapes.add_mesh(points_b, triangles_b)]
    scene = Scene(shapes)
    origin = numpy.zeros(3)
    a, b = (
        scene.add([mesh], numpy.asarray(origin if pose is None else pose, float)[None])
        for mesh, pose in zip(meshes, (pose_a, pose_b))
    )
    scene.refresh()
    return scene.distance(a, b)
