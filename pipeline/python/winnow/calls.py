"""Calls that make the objects they need."""

from typing import Any

import numpy
from numpy.typing import ArrayLike, NDArray

from winnow._core import Partition, Scene, Shapes
from winnow.tables import SceneDistances
from winnow.types import Keys, Structure, Words

__all__ = ["ids_of", "mesh_distance", "pairs"]


def ids_of(keys: Keys) -> NDArray[Any]:
    """Returns ids of objects, uint32 in the shape of `keys`: a view of the lower halves."""
    if keys.dtype != numpy.uint64:
        raise TypeError("keys: expected uint64, not " + str(keys.dtype))
    return keys.view(numpy.dtype({"names": ["id"], "formats": ["<u4"], "itemsize": 8}))["id"]


def pairs(lower: ArrayLike, upper: ArrayLike, structure: Structure = "LinearBvh") -> Words:
    """Returns the pairs of boxes that overlap, (m, 2) indices: first < second, sorted.

    `lower` and `upper` are (n, 3) corners. For boxes that move, keep a `Partition`.
    """
    partition = Partition(structure)
    partition.insert(lower, upper)
    return partition.self_pairs(order="canonical")


def mesh_distance(
    points_a: ArrayLike,
    triangles_a: ArrayLike,
    points_b: ArrayLike,
    triangles_b: ArrayLike,
    pose_a: ArrayLike = (0, 0, 0),
    pose_b: ArrayLike = (0, 0, 0),
) -> SceneDistances:
    """Returns the closest points of two triangle meshes, and their distance: one row.

    Points are (n, 3), triangles (m, 3) indices; a pose is a position, or seven numbers: x, y, z and
    a quaternion w, x, y, z. If the meshes overlap, the distance is minus the depth of the deepest
    pair of triangles. For many queries, keep a `Scene`.
    """
    shapes = Shapes()
    scene = Scene(shapes)
    a = scene.add(shapes.add_mesh(points_a, triangles_a), pose_a)
    b = scene.add(shapes.add_mesh(points_b, triangles_b), pose_b)
    scene.refresh()
    return scene.distance(a, b)
