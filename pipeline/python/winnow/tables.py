"""Tables: results of calls as columns."""

from typing import Annotated, Any, ClassVar, List, Tuple

import numpy

from winnow.types import Bools, Bytes, Doubles, Floats, Keys, Longs, Words

__all__ = [
    "ContactGroups", "Drawing", "HitLists", "Hits", "Impacts", "MeshImpacts", "MeshProximities",
    "MeshShapeImpacts", "Overlaps", "RayHits", "SceneCrossings", "SceneDistances", "SceneHitLists", "SceneHits",
    "SceneImpacts", "SceneOverlaps", "Sensed",
]  # fmt: skip


def shown(value: Any) -> str:
    """Returns a value as `repr` shows it; an array as its type and shape."""
    if isinstance(value, numpy.ndarray):
        return str(value.dtype) + str(list(value.shape))
    return repr(value)


class Table:
    """Columns: arrays of equal length, or with indices into each other. A table does not change."""

    _names: ClassVar[Tuple[str, ...]] = ()

    def __init_subclass__(cls) -> None:
        columns = cls.__annotations__
        cls._names += tuple(columns)
        rows = ["%s: %s" % (name, kind.__metadata__[0]) for name, kind in columns.items()]
        cls.__doc__ = "\n".join([(cls.__doc__ or "").strip(), "", *rows])

    def __init__(self, *columns: Any) -> None:
        if len(columns) != len(self._names):
            raise TypeError("%s: expected %d columns" % (type(self).__name__, len(self._names)))
        self.__dict__.update(zip(self._names, columns))

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError("%s: columns of %s do not change" % (name, type(self).__name__))

    def __repr__(self) -> str:
        columns = ("%s=%s" % (name, shown(getattr(self, name))) for name in self._names)
        return "%s(%s)" % (type(self).__name__, ", ".join(columns))


class Hits(Table):
    """One hit for each query; NULL_KEY, 0 and infinity if there is none."""

    key: Annotated[Keys, "Keys, uint64."]
    data: Annotated[Longs, "Client data, uint64."]
    t: Annotated[Floats, "The t at which the cast first touches the object's box, in units of its "
        "direction, or the distance: float32."]


class HitLists(Hits):
    """Hits of each query: the hits of query i are first[i] to first[i + 1]."""

    first: Annotated[Longs, "(n + 1,) uint64."]


class Overlaps(Table):
    """Objects that overlap each region: ids[first[i]:crossing[i]] are entirely inside region i,
    ids[crossing[i]:first[i + 1]] cross its boundary.
    """

    first: Annotated[Longs, "(n + 1,) uint64."]
    crossing: Annotated[Longs, "(n,) uint64."]
    ids: Annotated[Words, "Ids of objects, (m,) uint32."]


class Drawing(Table):
    """What `debug_draw` shows, as arrays."""

    boxes: Annotated[Floats, "Lower and upper corners, (n, 6) float32."]
    box_colours: Annotated[Bytes, "Red, green, blue and opacity of each, (n, 4) uint8."]
    lines: Annotated[Floats, "Both ends, (n, 6) float32."]
    line_colours: Annotated[Bytes, "Red, green, blue and opacity of each, (n, 4) uint8."]
    spheres: Annotated[Floats, "Centres and radii, (n, 4) float32."]
    sphere_colours: Annotated[Bytes, "Red, green, blue and opacity of each, (n, 4) uint8."]
    text_places: Annotated[Floats, "Positions of texts, (n, 3) float32."]
    text_colours: Annotated[Bytes, "Red, green, blue and opacity of each, (n, 4) uint8."]
    texts: Annotated[List[str], "The texts."]


class RayHits(Table):
    """Points at which rays enter their shapes."""

    hit: Annotated[Bools, "True if the ray hits, (n,) bool."]
    t: Annotated[Doubles, "t in units of the direction, 0 inside, infinity without a hit: (n,) "
        "float64."]
    normal: Annotated[Doubles, "Unit normal, outward, against the ray: (n, 3) float64."]


class Impacts(Table):
    """Times of impact of pairs of shapes, in the order of the pairs. Columns are read-only views
    that never change; vectors are new arrays.
    """

    hit: Annotated[Bools, "True if they touch: (n,) bool. False is certain."]
    time: Annotated[Doubles, "Time in [0, 1], never late: at every earlier time they are apart. 1 "
        "if they do not touch. (n,) float64."]
    gap: Annotated[Doubles, "Distance at that time; negative if they overlap at the start, 0 if "
        "they do not touch. (n,) float64."]
    error_bound: Annotated[Doubles, "The true distance at that time is within gap +- this. (n,) "
        "float64."]
    normal: Annotated[Doubles, "Unit vector from a to b at that time, in world axes: (n, 3) "
        "float64."]
    point: Annotated[Doubles, "Point on a, relative to the position of a at that time; the point "
        "on b is gap * normal farther. (n, 3) float64."]
    part_a: Annotated[Words, "Triangle or child of a that touches b, WHOLE_SHAPE for convex "
        "shapes: (n,) uint32."]
    part_b: Annotated[Words, "Triangle or child of b, as part_a."]

    def __len__(self) -> int:
        return len(self.time)


class MeshImpacts(Table):
    """Features of meshes that touch in a step."""

    features: Annotated[Words, "A vertex and a face, or two edges, by number: (m, 2) uint32."]
    time: Annotated[Doubles, "Time of the first touch, in [0, 1], never late: (m,) float64."]


class MeshProximities(Table):
    """Features of meshes that are near each other at the end of a step."""

    features: Annotated[Words, "A vertex and a face, or two edges, by number: (m, 2) uint32."]
    distance: Annotated[Doubles, "Distance in the units of the vertices, (m,) float64."]
    point_a: Annotated[Doubles, "Closest point on the first mesh: (m, 3) float64."]
    point_b: Annotated[Doubles, "Closest point on the second mesh: (m, 3) float64."]
    weight: Annotated[Doubles, "Barycentric weights of the points, (m, 4) float64: weight[0] of "
        "the vertex, or weight[0] and weight[1] of the ends of the first edge; the others are of "
        "the corners or ends of the second feature. The weights of a feature add up to 1."]


class MeshShapeImpacts(Table):
    """Faces that touch a rigid shape in a step."""

    face: Annotated[Words, "Number of the face, (m,) uint32."]
    part: Annotated[Words, "Triangle or child of the shape, WHOLE_SHAPE for a convex shape: (m,) "
        "uint32."]
    time: Annotated[Doubles, "Time in [0, 1], never late: (m,) float64."]
    gap: Annotated[Doubles, "Gap at that time, beyond the separation: (m,) float64."]
    error_bound: Annotated[Doubles, "Error bound of the gap, (m,) float64."]
    normal: Annotated[Doubles, "Unit vector from the shape to the face, at that time: (m, 3) "
        "float64."]
    point: Annotated[Doubles, "Point on the shape at that time, in the world: (m, 3) float64."]


class ContactGroups(Table):
    """Groups of contact pairs, none of them empty."""

    group: Annotated[Words, "Group of each pair of the contacts: (n,) uint32."]
    first: Annotated[Words, "The pairs of group g are order[first[g]] to order[first[g + 1]]: (g + "
        "1,) uint32."]
    order: Annotated[Words, "Pairs sorted by group, ascending in each: (n,) uint32."]


class SceneImpacts(Table):
    """Impacts of moving bodies, sorted by time, then by the ids of a and b."""

    a: Annotated[Keys, "Keys of the bodies with the smaller ids, (m,) uint64."]
    b: Annotated[Keys, "Keys of the others, (m,) uint64."]
    data_a: Annotated[Longs, "Client data of a, (m,) uint64."]
    data_b: Annotated[Longs, "Client data of b, (m,) uint64."]
    part_a: Annotated[Words, "Triangle or child of a, WHOLE_SHAPE for convex bodies: (m,) uint32."]
    part_b: Annotated[Words, "Triangle or child of b, as part_a."]
    time: Annotated[Doubles, "Time in [0, 1], never late: before it the two are apart. (m,) "
        "float64."]
    gap: Annotated[Doubles, "Gap at that time; negative if the bodies overlap at the start: (m,) "
        "float64."]
    error_bound: Annotated[Doubles, "Error bound of the gap, (m,) float64."]
    normal: Annotated[Doubles, "Unit vector from a to b, at that time: (m, 3) float64."]
    point: Annotated[Doubles, "Point on a at that time, in the world: (m, 3) float64."]
    first: Annotated[Words, "By moving body, the number of its first impact, or NO_IMPACT: (n,) "
        "uint32."]


class SceneHits(Table):
    """One hit for each query; NULL_KEY, 0, WHOLE_SHAPE, infinity and zeros if there is none."""

    key: Annotated[Keys, "Keys of bodies, uint64."]
    data: Annotated[Longs, "Client data, uint64."]
    part: Annotated[Words, "Triangle or child, WHOLE_SHAPE for convex bodies."]
    t: Annotated[Doubles, "t in units of the direction, float64."]
    normal: Annotated[Doubles, "Unit normal of the surface, (n, 3) float64."]
    point: Annotated[Doubles, "Point of the hit, in the world, (n, 3) float64."]


class SceneHitLists(SceneHits):
    """The hits of query i are first[i] to first[i + 1]."""

    first: Annotated[Longs, "(n + 1,) uint64."]


class SceneCrossings(Table):
    """The points at which ray i crosses surfaces are first[i] to first[i + 1]."""

    first: Annotated[Longs, "(n + 1,) uint64."]
    key: Annotated[Keys, "Keys of bodies, (m,) uint64."]
    data: Annotated[Longs, "Client data, (m,) uint64."]
    part: Annotated[Words, "Triangle or child, WHOLE_SHAPE for convex bodies: (m,) uint32."]
    t: Annotated[Doubles, "t in units of the direction, (m,) float64."]
    exits: Annotated[Bools, "True if the ray leaves a convex shape, or comes from the back of a "
        "triangle: (m,) bool."]
    normal: Annotated[Doubles, "Unit normal out of the shape, or of the front, (m, 3) float64."]
    point: Annotated[Doubles, "Point of the crossing, in the world, (m, 3) float64."]
    barycentric: Annotated[Doubles, "Weights of the corners of a triangle, whose sum is 1; zeros "
        "for convex shapes: (m, 3) float64."]


class SceneOverlaps(Table):
    """The bodies that shape i overlaps are first[i] to first[i + 1]."""

    first: Annotated[Longs, "(n + 1,) uint64."]
    key: Annotated[Keys, "Keys of bodies, (m,) uint64."]
    data: Annotated[Longs, "Client data, (m,) uint64."]
    part: Annotated[Words, "A part of the body that it overlaps, (m,) uint32."]


class SceneDistances(Table):
    """The results of query i are first[i] to first[i + 1]."""

    first: Annotated[Longs, "(n + 1,) uint64."]
    key: Annotated[Keys, "Keys of the second bodies, (m,) uint64."]
    data: Annotated[Longs, "Their client data, (m,) uint64."]
    part_a: Annotated[Words, "Closest part of the first, (m,) uint32."]
    part: Annotated[Words, "Closest part of the second, (m,) uint32."]
    distance: Annotated[Doubles, "Distance, negative if they overlap, (m,) float64."]
    error_bound: Annotated[Doubles, "Error bound of the distance, (m,) float64."]
    normal: Annotated[Doubles, "Unit vector from first to second, (m, 3) float64."]
    point_a: Annotated[Doubles, "Point on the first, in the world, (m, 3) float64."]
    point_b: Annotated[Doubles, "Point on the second, in the world, (m, 3) float64."]


class Sensed(Table):
    """Bodies in sensors, by the ids of sensors and of bodies."""

    sensor: Annotated[Keys, "Keys of sensors, (n,) uint64."]
    body: Annotated[Keys, "Keys of bodies in them, (n,) uint64."]
    sensor_data: Annotated[Longs, "Client data of sensors, (n,) uint64."]
    body_data: Annotated[Longs, "Client data of bodies, (n,) uint64."]
    event: Annotated[Bytes, "0 for bodies that entered, 1 for bodies that stay: (n,) uint8."]
    left: Annotated[Keys, "Pairs (sensor, body) that were there in the last call and are not now: "
        "(k, 2) uint64. Keys of removed sensors and bodies are stale."]
    left_data: Annotated[Longs, "Client data of the pairs in `left`, (k, 2) uint64."]
