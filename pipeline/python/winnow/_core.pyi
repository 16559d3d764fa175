from math import inf
from os import PathLike
from typing import Any, Dict, List, Literal, Optional, Sequence, Tuple, Union, overload

from numpy.typing import ArrayLike, NDArray

from winnow.tables import (
    ContactGroups, Drawing, HitLists, Hits, Impacts, MeshImpacts, MeshProximities, MeshShapeImpacts,
    Overlaps, RayHits, SceneCrossings, SceneDistances, SceneHitLists, SceneHits, SceneImpacts,
    SceneOverlaps, Sensed,
)
from winnow.types import (
    BodyState, Bools, Bytes, ContinuousPairs, Doubles, FeatureKind, Floats, Isa, Keys, Level,
    LogHook, Longs, NearDepth, Numbers, Order, PairFunction, Poses, Rules, Saved, StageHook, Status,
    Structure, SupportFunction, Tier, Volume, Words,
)

__version__: str
NO_CONTACT: int
NO_IMPACT: int
REST_COLOUR: int
NULL_KEY: int
NO_OBJECT: int
EVERY_ENVIRONMENT: int
WHOLE_SHAPE: int
FIXED: int
DYNAMIC: int
SLEEPING: int

class StatusError(ValueError):
    """A call failed and has changed nothing. `status` is the reason: invalid_bounds, invalid_key,
    invalid_argument, size_mismatch, too_many_objects, unsupported_volume, invalid_shape,
    invalid_pose or unsupported; the message names the argument and the row, if one row is the
    cause: "invalid_pose: poses[17] has a NaN". out_of_memory raises a MemoryError.
    """
    status: Status

class Filter:
    """Selects the objects that a query may find."""
    def __init__(
        self, layers: int = 0xFFFFFFFF, mask: int = 0xFFFFFFFF, environment: int = 0xFFFFFFFF, *,
        accept: Optional[PairFunction] = None, layer: Optional[int] = None,
        ignored: Optional[int] = None
    ) -> None:
        """`layers`: layers of the query; `mask`: layers that it may find; `environment`: as in
        `Partition.set_filter`. `accept(key, data)` is called for each object that passes the other
        conditions. Calls come from any working thread, one at a time, because each needs the GIL:
        some microseconds a call. It must return the same result each time and must not call winnow
        (unsupported); the query raises its exceptions. For queries of a scene: `layer` finds bodies
        in layers that collide with this layer, see Scene.set_layers_collide; `ignored` is the key
        of a body that is skipped, such as the one that casts the ray.
        """
    @property
    def accept(self) -> Optional[PairFunction]:
        """The function that decides, if there is one."""
    @property
    def layer(self) -> Optional[int]:
        """The layer of a scene that the query belongs to."""
    @property
    def ignored(self) -> Optional[int]:
        """The key of the body that is skipped."""
    @property
    def layers(self) -> int:
        """Layers of the query, a bit each."""
    @property
    def mask(self) -> int:
        """Layers that it may find, a bit each."""
    @property
    def environment(self) -> int:
        """The environment of the query."""

class Recorder:
    """Records the calls of partitions and scenes that are made with it, so that they can be
    replayed and measured elsewhere: `winnow advise FILE`. Failed calls are not recorded. Recorded
    partitions cannot load snapshots (unsupported). A recorded scene must be used with one Contacts,
    which may be loaded: `status` is 'unsupported' after one that was filled in an earlier call than
    the last. If anything fails, the recording ends and the program continues: see `status`.
    """
    def __init__(self, path: Union[str, bytes, PathLike[str], PathLike[bytes]]) -> None:
        """Records into the file at a path, as `open` accepts it, which is created or overwritten.
        """
    def end_frame(self) -> None:
        """Marks the end of a frame, and writes buffered data."""
    def close(self) -> None:
        """Ends the recording. Raises the error that occurred, if any."""
    @property
    def status(self) -> Status:
        """'ok'; 'out_of_memory', also if the disk is full; 'unsupported' after a call that cannot
        be recorded.
        """
    @property
    def calls(self) -> int:
        """Number of calls recorded."""
    @property
    def bytes(self) -> int:
        """Bytes written."""

class PairEvents:
    """Changes of pairs between two frames. Each access returns a new array."""
    def __init__(self, *, client_data: bool = False) -> None:
        """Events without a last frame. With `client_data` they include it, for 8 bytes an object
        and 16 a pair that begins or ends.
        """
    @property
    def begun(self) -> Keys:
        """Pairs of this frame that are not in the last one: (m, 2) uint64 of keys, sorted by id."""
    @property
    def ended(self) -> Keys:
        """Pairs of the last frame that are not in this one: (m, 2) uint64 of keys, sorted by id;
        keys of removed objects are stale.
        """
    @property
    def begun_data(self) -> Longs:
        """Client data of the pairs in `begun`: (m, 2) uint64; (0, 2) without `client_data`."""
    @property
    def ended_data(self) -> Longs:
        """Client data of the pairs in `ended`, including removed objects: (m, 2) uint64; (0, 2)
        without `client_data`.
        """
    @property
    def persisting(self) -> int:
        """Number of pairs that are in both frames."""
    def clear(self) -> None:
        """Forgets everything."""

class Partition:
    """Stores boxes, returns keys, and finds pairs that may touch; it never misses a pair. Any
    number of threads may call it. A call that raises changes nothing. Other threads must not write
    to arrays while a call reads them.
    """
    def __init__(
        self, structure: Structure = "LinearBvh", *, volume: Volume = "aabb",
        fat_margin: float = 0.0,
        fat_margin_share: float = 0.0, parallel: bool = True, build_budget: int = 0,
        loose: Optional[float] = None, recorder: Optional[Recorder] = None
    ) -> None:
        """An empty partition. `structure`: the spatial structure (see `structures`). `volume`: the
        bounding volume of objects: 'aabb', 'sphere', 'kdop14', 'kdop18' or 'kdop26'. Volumes are
        stored larger by `fat_margin` (a length) + `fat_margin_share` * longest edge: moves within
        this margin are free. `loose`: parameter of LooseOctree and LooseQuadtree. `recorder`:
        records all calls.
        """
    def insert(self, lower: ArrayLike, upper: ArrayLike, data: Optional[ArrayLike] = None) -> Keys:
        """Adds n boxes and returns their keys, (n,) uint64. `lower`, `upper`: (n, 3), in units of
        the scene; lower <= upper, may be infinite. Floats of any strides are read in place if both
        arrays have the same stride from box to box; all others are rounded outward to float.
        `data`: (n,) uint64, or one for all, returned by queries.
        """
    def update(
        self, keys: ArrayLike, lower: ArrayLike, upper: ArrayLike,
        entries: Optional[ArrayLike] = None
    ) -> None:
        """Sets new boxes, (n, 3) each, of the n objects of `keys` (n,). With `entries`, indices
        (m,) or a mask (n,) of bool, only of these entries.
        """
    def insert_spheres(
        self, centers: ArrayLike, radii: ArrayLike, data: Optional[ArrayLike] = None
    ) -> Keys:
        """Adds n spheres, if the volume is 'sphere', and returns their keys, (n,) uint64.
        `centers`: (n, 3), `radii`: (n,) or one for all, finite and >= 0.
        """
    def update_spheres(self, keys: ArrayLike, centers: ArrayLike, radii: ArrayLike) -> None:
        """Sets new spheres of the n objects of `keys` (n,): `centers` (n, 3), `radii` (n,) or one
        for all.
        """
    def insert_kdops(
        self, lower: ArrayLike, upper: ArrayLike, data: Optional[ArrayLike] = None
    ) -> Keys:
        """Adds n k-DOPs, if the volume is one: lower and upper ends (n, k/2) of the slabs along
        `kdop_directions(k)`. Returns their keys, (n,) uint64.
        """
    def update_kdops(self, keys: ArrayLike, lower: ArrayLike, upper: ArrayLike) -> None:
        """Sets new k-DOPs of the n objects of `keys` (n,), lower and upper ends (n, k/2)."""
    def remove(self, keys: ArrayLike) -> None:
        """Removes the objects of `keys` (n,), all or none. Fails for a key that is stale, of
        another partition or given twice.
        """
    def clear(self) -> None:
        """Removes every object and keeps the memory."""
    def release_memory(self) -> None:
        """Frees memory that an empty partition, or scratch, holds."""
    def reserve(
        self, objects: int, pairs: int = 0, touch: bool = False, events: Optional[PairEvents] = None
    ) -> None:
        """Reserves the memory for a first frame with this many objects and pairs, and for `events`
        of the pairs; `touch` writes to each page of it.
        """
    def __len__(self) -> int: ...
    def contains(self, keys: ArrayLike) -> Bools:
        """True for `keys` (n,) of live objects: (n,) bool."""
    def bounds(self, keys: ArrayLike) -> Tuple[Floats, Floats]:
        """Boxes (lower, upper) of the objects of `keys` (n,), (n, 3) float32 each, as they are
        tested: grown by the fat margin, and around other volumes.
        """
    def client_data(self, keys: ArrayLike) -> Longs:
        """Client data of the objects of `keys` (n,): (n,) uint64."""
    def keys_of(self, ids: ArrayLike) -> Keys:
        """Keys (n,) uint64 of objects by id (n,); NULL_KEY for objects that do not exist."""
    def client_data_of(self, ids: ArrayLike) -> Longs:
        """Client data (n,) uint64 of objects by id (n,); 0 for objects that do not exist."""
    def set_filter(
        self, keys: ArrayLike, layers: ArrayLike = 1, mask: ArrayLike = 0xFFFFFFFF,
        environment: ArrayLike = 0
    ) -> None:
        """Sets filters of the objects of `keys` (n,): `layers` that they are in and `mask` of
        layers that they may be paired with, a bit each, and `environment`, which must be equal or
        EVERY_ENVIRONMENT. (n,) uint32 each, or one for all.
        """
    def filters(self, keys: ArrayLike) -> Tuple[Words, Words, Words]:
        """(layers, mask, environment) of the objects of `keys` (n,), (n,) uint32 each."""
    def self_pairs(
        self, events: Optional[PairEvents] = None, *, order: Order = "fast",
        incremental: bool = True, predicate: Optional[PairFunction] = None
    ) -> Words:
        """Finds all pairs of objects whose volumes overlap: (m, 2) uint32 of ids, first < second.
        The array is a read-only view that never changes. Drop it before the next call, which then
        updates it in place if few objects moved; else pairs are written to another buffer. `order`:
        'fast' or 'canonical' (sorted). With `events`, the changes since the last call are written
        there. `predicate(first, second)`, which cannot be combined with events (unsupported), is
        called for each pair of ids and decides. Calls come from any working thread, one at a time,
        because each needs the GIL; filters, or a test of the resulting array of pairs, are much
        faster. It must not call winnow (unsupported); this call raises its exceptions.
        """
    def pair_changes(self, events: PairEvents, *, predicate: Optional[PairFunction] = None) -> None:
        """Finds only the changes of all pairs since the last call with these events, in time
        proportional to the objects that moved, or with a `predicate`, as in `self_pairs`, in the
        time of all pairs. If the predicate raises, the events are cleared.
        """
    def pairs_with(
        self, other: "Partition", *, order: Order = "fast", predicate: Optional[PairFunction] = None
    ) -> Words:
        """All pairs (object of this, object of `other`) whose boxes overlap: (m, 2) uint32 of ids.
        `predicate` as in `self_pairs`.
        """
    def refresh(self) -> None:
        """Brings the structure up to date now rather than in the next query."""
    def set_structure(self, structure: Structure, loose: Optional[float] = None) -> None:
        """Replaces the structure; objects, keys, filters and events stay."""
    @property
    def structure(self) -> Structure:
        """Name of the current structure, as it was set."""
    @property
    def volume(self) -> Volume:
        """The bounding volume of objects."""
    @property
    def fat_margin(self) -> Tuple[float, float]:
        """Fat margin: (length, share of the longest edge)."""
    @property
    def is_exact(self) -> bool:
        """True if `self_pairs` gives exactly the pairs whose given boxes overlap."""
    def choice(self) -> Dict[str, Any]:
        """The structure that AutoPartition uses and the reason, with the properties of the scene;
        for any other structure that structure itself.
        """
    def statistics(self) -> Dict[str, int]:
        """Counters of its state and work, no timings."""
    def footprint(self) -> Dict[str, Tuple[int, int]]:
        """Bytes (used, reserved) by purpose."""
    def debug_draw(
        self, *, objects: bool = True, structure: bool = True, labels: bool = False,
        max_depth: int = 64
    ) -> Drawing:
        """The objects and the structure as boxes, lines, spheres and texts. O(n)."""
    @overload
    def cast_rays(
        self, origins: ArrayLike, directions: ArrayLike,
        find: Literal["closest", "any"] = "closest", *, min_t: ArrayLike = 0.0,
        max_t: ArrayLike = inf, filter: Optional[Filter] = None
    ) -> Hits:
        """Finds the objects whose boxes the rays origins + t * directions, (n, 3) each or (3,) for
        all, min_t <= t <= max_t, (n,) or one for all, hit. `find`: 'closest' or 'any', returning
        Hits, or 'all', returning HitLists sorted by t. Floats with one stride are read in place.
        """
    @overload
    def cast_rays(
        self, origins: ArrayLike, directions: ArrayLike, find: Literal["all"], *,
        min_t: ArrayLike = 0.0, max_t: ArrayLike = inf, filter: Optional[Filter] = None
    ) -> HitLists: ...
    @overload
    def cast_boxes(
        self, lower: ArrayLike, upper: ArrayLike, directions: ArrayLike,
        find: Literal["closest", "any"] = "closest", *, min_t: ArrayLike = 0.0,
        max_t: ArrayLike = inf, filter: Optional[Filter] = None
    ) -> Hits:
        """As cast_rays, for boxes (n, 3), (n, 3) that move by t * directions (n, 3)."""
    @overload
    def cast_boxes(
        self, lower: ArrayLike, upper: ArrayLike, directions: ArrayLike, find: Literal["all"], *,
        min_t: ArrayLike = 0.0, max_t: ArrayLike = inf, filter: Optional[Filter] = None
    ) -> HitLists: ...
    @overload
    def cast_spheres(
        self, centers: ArrayLike, radii: ArrayLike, directions: ArrayLike,
        find: Literal["closest", "any"] = "closest", *, min_t: ArrayLike = 0.0,
        max_t: ArrayLike = inf, filter: Optional[Filter] = None
    ) -> Hits:
        """As cast_rays, for spheres: centres (n, 3), radii (n,) or one for all."""
    @overload
    def cast_spheres(
        self, centers: ArrayLike, radii: ArrayLike, directions: ArrayLike, find: Literal["all"], *,
        min_t: ArrayLike = 0.0, max_t: ArrayLike = inf, filter: Optional[Filter] = None
    ) -> HitLists: ...
    @overload
    def cast_capsules(
        self, a: ArrayLike, b: ArrayLike, radii: ArrayLike, directions: ArrayLike,
        find: Literal["closest", "any"] = "closest", *, min_t: ArrayLike = 0.0,
        max_t: ArrayLike = inf, filter: Optional[Filter] = None
    ) -> Hits:
        """As cast_rays, for capsules: ends a and b (n, 3), radii (n,) or one for all."""
    @overload
    def cast_capsules(
        self, a: ArrayLike, b: ArrayLike, radii: ArrayLike, directions: ArrayLike,
        find: Literal["all"], *, min_t: ArrayLike = 0.0, max_t: ArrayLike = inf,
        filter: Optional[Filter] = None
    ) -> HitLists: ...
    def overlap_boxes(
        self, lower: ArrayLike, upper: ArrayLike, *, order: Order = "fast",
        filter: Optional[Filter] = None
    ) -> Words:
        """All overlapping pairs (number of the box, id of the object): (m, 2) uint32. Boxes (n, 3),
        (n, 3) as in `insert`.
        """
    def overlap_points(
        self, points: ArrayLike, *, order: Order = "fast", filter: Optional[Filter] = None
    ) -> Overlaps:
        """Objects whose boxes contain the points (n, 3), as Overlaps."""
    def overlap_spheres(
        self, centers: ArrayLike, radii: ArrayLike, *, order: Order = "fast",
        filter: Optional[Filter] = None
    ) -> Overlaps:
        """Objects whose boxes overlap the spheres: centres (n, 3), radii (n,) or one for all."""
    def overlap_capsules(
        self, a: ArrayLike, b: ArrayLike, radii: ArrayLike, *, order: Order = "fast",
        filter: Optional[Filter] = None
    ) -> Overlaps:
        """Objects whose boxes overlap the capsules: ends (n, 3), radii (n,) or one for all."""
    def overlap_oriented_boxes(
        self, centers: ArrayLike, half: ArrayLike, axes: ArrayLike, *, order: Order = "fast",
        filter: Optional[Filter] = None
    ) -> Overlaps:
        """Objects whose boxes overlap oriented boxes: centres (n, 3), half extents (n, 3) or (3,),
        axes as columns of (n, 3, 3) or (3, 3).
        """
    def overlap_frusta(
        self, frusta: ArrayLike, *, order: Order = "fast", filter: Optional[Filter] = None
    ) -> Overlaps:
        """Objects whose boxes overlap frusta of cameras: (n, 30), as returned by `perspective` and
        `frusta_of`.
        """
    def overlap_planes(
        self, planes: ArrayLike, *, order: Order = "fast", filter: Optional[Filter] = None
    ) -> Overlaps:
        """Objects whose boxes are not entirely outside of one of p planes: (n, p, 4), an inward
        normal and an offset each, normal . x + offset >= 0 inside.
        """
    def nearest(
        self, lower: ArrayLike, count: int = 1, *, upper: Optional[ArrayLike] = None,
        radius: ArrayLike = inf, filter: Optional[Filter] = None
    ) -> Hits:
        """The `count` objects whose boxes are nearest to each point `lower` (n, 3), or to each box
        up to `upper` (n, 3), within `radius`, (n,) or one for all. Hits of shape (n, count), sorted
        by distance, which is t; NULL_KEY and infinity if there are fewer.
        """
    def save(self) -> bytes:
        """Saves all objects, and the structure with its options, as bytes."""
    def load(self, data: Saved) -> None:
        """Loads a snapshot. Saved keys stay valid, unless another partition of the process has
        them: see `keys_of`.
        """

class Shapes:
    """Shapes by id, for scenes and the narrow phase: convex ones, added many at a time, and meshes,
    height fields and compounds. Any number of threads and scenes may use it.
    """
    def __init__(self) -> None:
        """An empty pool."""
    def add_spheres(self, radius: ArrayLike) -> Words:
        """Adds n spheres: radii (n,), or one. Returns their ids, (n,) uint32, as all of these do.
        Lengths are finite and >= 0.
        """
    def add_capsules(self, radius: ArrayLike, half_length: ArrayLike) -> Words:
        """Adds n capsules about segments |z| <= half_length: (n,) each, or one for all."""
    def add_boxes(self, half: ArrayLike, rounding: ArrayLike = 0.0) -> Words:
        """Adds n boxes |x_i| <= half_i: half extents (n, 3), or (3,) for all, and the radius of
        their rounding, (n,) or one for all.
        """
    def add_cylinders(
        self, radius: ArrayLike, half_length: ArrayLike, rounding: ArrayLike = 0.0
    ) -> Words:
        """Adds n cylinders about z, |z| <= half_length: (n,) each, or one for all."""
    def add_cones(
        self, radius: ArrayLike, half_length: ArrayLike, rounding: ArrayLike = 0.0
    ) -> Words:
        """Adds n cones with the apex at z = half_length and the disc at -half_length: (n,) each, or
        one for all.
        """
    def add_triangles(self, vertices: ArrayLike, rounding: ArrayLike = 0.0) -> Words:
        """Adds n two-sided triangles: corners (n, 3, 3), rounding (n,) or one for all."""
    def add_half_spaces(self, normal: ArrayLike, offset: ArrayLike = 0.0) -> Words:
        """Adds n half-spaces normal . x <= offset: (n, 3) and (n,), or one for all."""
    def add_ellipsoids(self, radius: ArrayLike, rounding: ArrayLike = 0.0) -> Words:
        """Adds n ellipsoids: half of their lengths along x, y, z, (n, 3), or (3,) for all, and the
        radius of their rounding, (n,) or one for all.
        """
    def add_tapered_capsules(self, radius: ArrayLike, half_length: ArrayLike) -> Words:
        """Adds n convex hulls of two balls at z = -half_length and z = half_length: their radii (n,
        2), or (2,) for all, and half lengths (n,) or one for all.
        """
    def add_hull(
        self, points: ArrayLike, rounding: float = 0.0, indices: Optional[ArrayLike] = None,
        sizes: Optional[ArrayLike] = None
    ) -> int:
        """Adds the convex hull of points (n, 3) and returns its id. With `indices` (m,) and `sizes`
        (f,), face i is the next sizes[i] of the indices, counter-clockwise as seen from outside;
        without them, the hull is computed.
        """
    def add_support(self, function: SupportFunction, radius: float, rounding: float = 0.0) -> int:
        """Adds a convex user shape and returns its id. `function(direction)` is the support
        function: it takes a unit vector, (3,) float64, and returns a point of the shape, three
        numbers, that is farthest in this direction, at most `radius` from the origin; `rounding` is
        added outside. The same direction must give the same point. Calls come from any working
        thread, one at a time, because each needs the GIL: some microseconds a call, and about ten
        calls a pair. It must not call winnow (unsupported). Its exceptions are raised by all calls
        in progress that use such shapes; contacts that they were to fill are cleared. invalid_shape
        if a result is not finite, beyond the radius or not convex. Pools with such shapes cannot be
        saved (unsupported).
        """
    def add_mesh(
        self, vertices: ArrayLike, triangles: ArrayLike, active_edge_angle: float = 0.02
    ) -> int:
        """Adds a triangle mesh, vertices (n, 3) and corners (m, 3), and returns its id. Edges at
        which the surface bends by more than the angle, in radians, are active: contacts at them
        have normals of their own.
        """
    def add_scaled(self, mesh: int, scale: Sequence[float]) -> int:
        """Adds a copy of a mesh that is scaled by three factors and shares its triangles; returns
        the new id.
        """
    def refit_mesh(self, mesh: int, vertices: ArrayLike) -> None:
        """Sets new positions (n, 3) of the vertices of a mesh."""
    def add_height_field(self, heights: Numbers, spacing: Sequence[float] = (1.0, 1.0)) -> int:
        """Adds a height field (rows, columns), NaN for holes, with sample (row, column) at (column
        * spacing[0], row * spacing[1], height), and returns its id.
        """
    def update_height_field(self, field: int, column: int, row: int, heights: Numbers) -> None:
        """Sets new heights (rows, columns) from (column, row) on."""
    def add_compound(self, children: ArrayLike, poses: Poses) -> int:
        """Adds a compound of n children, ids (n,) of convex shapes, meshes and height fields, at
        poses (n, 7), and returns its id. Parts are numbered child by child: a convex child is one
        part, a surface has one part for each triangle.
        """
    def compound_parts(self, compound: int, parts: ArrayLike) -> Tuple[Words, Words]:
        """Child and part of child of the parts (n,) of a compound: (child, part), (n,) uint32 each;
        part is WHOLE_SHAPE for convex children.
        """
    def compound_children(self, compound: int) -> Tuple[Words, Doubles]:
        """The children of a compound: (ids (n,) uint32, poses (n, 7) float64)."""
    def parts(self, shapes: ArrayLike) -> Words:
        """Number of parts of composite shapes (n,): (n,) uint32."""
    def set_one_sided(self, surfaces: ArrayLike, one_sided: bool = True) -> None:
        """Makes meshes and height fields (n,) one-sided, or two-sided again. The front is the side
        from which corners are counter-clockwise; for height fields it is up. Anything behind a
        one-sided triangle does not collide with it.
        """
    def is_one_sided(self, shapes: ArrayLike) -> Bools:
        """True for composite shapes (n,) that are one-sided: (n,) bool."""
    def set_solid(self, surfaces: ArrayLike, solid: bool = True) -> None:
        """Makes meshes (n,) solid, or surfaces again. Solid meshes must be closed, with corners
        counter-clockwise as seen from outside, else invalid_shape. Distance and overlap queries of
        a scene then include the inside.
        """
    def is_solid(self, shapes: ArrayLike) -> Bools:
        """True for composite shapes (n,) that are solid: (n,) bool."""
    def remove(self, shapes: ArrayLike) -> None:
        """Removes shapes (n,), all or none: invalid_key for shapes that bodies of a scene or
        compounds use.
        """
    def contains(self, shapes: ArrayLike) -> Bools:
        """True for ids (n,) of existing shapes: (n,) bool."""
    def bounds(self, shapes: ArrayLike, poses: Poses) -> Tuple[Floats, Floats]:
        """Boxes (lower, upper), (n, 3) float32 each, of shapes (n,), or one for all, at poses: (n,
        7) of x, y, z and a quaternion w, x, y, z; (n, 3); or a tuple of both.
        """
    def cast_rays(
        self, shapes: ArrayLike, poses: Poses, origins: ArrayLike, directions: ArrayLike,
        max_t: ArrayLike = inf
    ) -> RayHits:
        """Casts n rays against n convex shapes (n,) at poses (n, 7): origins and directions (n, 3)
        or (3,), max_t (n,) or one for all.
        """
    def footprint(self) -> Dict[str, Tuple[int, int]]:
        """Bytes (used, reserved) of convex and composite shapes."""
    def save(self) -> bytes:
        """Saves all shapes and the free ids, as bytes."""
    def load(self, data: Saved) -> None:
        """Loads a snapshot, with the same ids. invalid_key while bodies of a scene use shapes of
        this pool: clear the scene, load both.
        """

class NarrowResult:
    """Results as columns, sorted by the kinds of shapes. They are read-only views that never
    change; vectors are new arrays.
    """
    def __len__(self) -> int: ...
    @property
    def level(self) -> Level:
        """The level of the call."""
    @property
    def pair(self) -> Words:
        """Index of the input pair of each result: (n,) uint32."""
    @property
    def overlaps(self) -> Bools:
        """True if they overlap: (n,) bool."""
    @property
    def distance(self) -> Doubles:
        """Levels distance and manifold: distance, negative if they overlap. (n,) float64."""
    @property
    def error_bound(self) -> Doubles:
        """The true distance is within distance +- this. (n,) float64."""
    @property
    def normal(self) -> Doubles:
        """Unit vector from a to b, in world axes: (n, 3) float64."""
    @property
    def point(self) -> Doubles:
        """Level distance: the closest or deepest point of a, relative to its position; the point of
        b is distance * normal farther. (n, 3) float64.
        """
    @property
    def contact_first(self) -> Words:
        """Level manifold: index of the first contact of each result, which has contact_count
        contacts. (n,).
        """
    @property
    def contact_count(self) -> Words:
        """Number of contacts, at most 4 each, (n,) uint32."""
    @property
    def contact_position(self) -> Floats:
        """Position halfway between the surfaces, relative to the position of a: (m, 3) float32."""
    @property
    def contact_depth(self) -> Floats:
        """Depth, positive if they overlap: (m,) float32."""
    @property
    def contact_feature(self) -> Longs:
        """The features of a and b that made the contact, the same from frame to frame: (m,) uint64.
        """

class NarrowPhase:
    """Tests pairs of convex shapes for overlaps, distances or contacts. Keeps its scratch memory;
    calls from several threads run one at a time.
    """
    def __init__(self, *, parallel: bool = True) -> None:
        """`parallel` uses all cores."""
    def collide(
        self, shapes: Shapes, shape_of: ArrayLike, poses: Poses, pairs: ArrayLike, *,
        level: Level = "manifold", tier: Tier = "robust", contact_margin: ArrayLike = 0.0
    ) -> NarrowResult:
        """Computes results for pairs (m, 2) uint32 of bodies: body i has the shape shape_of[i],
        (n,) or one for all, at poses (n, 7) of x, y, z and a quaternion w, x, y, z, (n, 3), or a
        tuple of both. `level`: 'boolean', 'distance' or 'manifold'; `tier`: 'robust' or
        'reference'. Pairs at most `contact_margin` apart, (m,) or one for all, get contacts too.
        Contiguous pairs of uint32 and poses (n, 7) of double are read in place.
        """
    def statistics(self) -> Dict[str, int]:
        """Counters of the last call."""

class DeformableMesh:
    """A mesh whose vertices move in every step, for cloth and soft bodies. Finds vertices and
    faces, or edges, that may touch, do touch or are near each other, in one mesh or between two.
    Any number of threads may call it; a call that raises changes nothing.
    """
    def __init__(self, *, origin: Sequence[float] = (0.0, 0.0, 0.0), parallel: bool = True) -> None:
        """An empty mesh. Boxes are measured from `origin`: a point near the mesh keeps them tight
        far from (0, 0, 0). Two meshes that are tested against each other must have the same origin,
        else invalid_argument. An origin that is not finite makes `build` fail: invalid_bounds.
        `parallel` uses all cores.
        """
    def build(self, rest: ArrayLike, triangles: ArrayLike) -> None:
        """Sets triangles (m, 3) and sorts them by the rest positions of vertices, (n, 3). Call
        `move` before any query. O(m log m).
        """
    def move(self, start: ArrayLike, end: ArrayLike, distance: float = 0.0) -> None:
        """Sets the motion of a step: vertices move from `start` to `end`, (n, 3) each, which are
        copied. Features that come within `distance` (a length) are candidates. O(n).
        """
    @property
    def triangles(self) -> int:
        """Number of triangles; 0 before `build`."""
    @property
    def vertices(self) -> int:
        """Number of vertices; 0 before `build`."""
    def edges(self) -> Words:
        """Vertices of all edges, the lower one first: (e, 2) uint32, sorted."""
    def footprint(self) -> Tuple[int, int]:
        """Bytes (used, reserved), without the positions of vertices."""
    def self_candidates(self, kind: FeatureKind) -> Words:
        """Pairs of features whose boxes overlap, (m, 2) uint32. `kind`: 'vertex_face', a vertex and
        a face, or 'edge_edge', two edges, the lower one first. Features that share a vertex are
        left out.
        """
    def candidates_with(self, other: "DeformableMesh", kind: FeatureKind) -> Words:
        """Pairs of features of this mesh (first) and of another one, as self_candidates."""
    def self_impacts(
        self, kind: FeatureKind, *, min_separation: float = 0.0,
        tolerance: float = 9.094947017729282e-13, max_intervals: int = 2048
    ) -> MeshImpacts:
        """Features that touch in the step, with times: MeshImpacts. Options as in
        `feature_impacts`; `min_separation` is at most the distance of the step.
        """
    def impacts_with(
        self, other: "DeformableMesh", kind: FeatureKind, *, min_separation: float = 0.0,
        tolerance: float = 9.094947017729282e-13, max_intervals: int = 2048
    ) -> MeshImpacts:
        """As self_impacts, with another mesh; `min_separation` is at most half of both distances.
        """
    def impacts_with_shape(
        self, shapes: Shapes, shape: int, motion: ArrayLike, *, separation: float = 0.0,
        tolerance: float = 1e-06
    ) -> MeshShapeImpacts:
        """Faces that touch a shape of `shapes` that moves by `motion`, (1, 13) as returned by
        `motions_between`, with times: MeshShapeImpacts. `separation` (a length) is at most half of
        the distance of the step; `tolerance` as in `time_of_impact`.
        """
    def self_proximity(self, kind: FeatureKind, thickness: float) -> MeshProximities:
        """Features with a distance of at most `thickness` at the end of the step: MeshProximities.
        `thickness` is at most the distance of the step.
        """
    def proximity_with(
        self, other: "DeformableMesh", kind: FeatureKind, thickness: float
    ) -> MeshProximities:
        """As self_proximity, with another mesh; `thickness` is at most half of both distances."""

class Contacts:
    """The results of `Scene.collide`: pairs of bodies, the manifolds of each pair, and the points
    of each manifold. Reused from frame to frame, because it remembers the last results. Each access
    returns a new array, which later calls do not change.
    """
    def __init__(self) -> None:
        """Contacts without a last frame."""
    def __len__(self) -> int: ...
    def clear(self) -> None:
        """Forgets everything."""
    @property
    def level(self) -> Level:
        """The level of the last `collide`."""
    @property
    def cached_pairs(self) -> int:
        """Number of pairs that kept their manifolds."""
    @property
    def a(self) -> Keys:
        """Keys of the first bodies, (n,) uint64."""
    @property
    def b(self) -> Keys:
        """Keys of the second bodies, (n,) uint64."""
    @property
    def data_a(self) -> Longs:
        """Client data of the first bodies, (n,) uint64."""
    @property
    def data_b(self) -> Longs:
        """Client data of the second bodies, as data_a."""
    @property
    def event(self) -> Bytes:
        """0 for pairs that began, 1 for pairs that persist: (n,) uint8."""
    @property
    def ended(self) -> Keys:
        """Pairs of keys that were in contact in the last frame and are not now, (k, 2) uint64."""
    @property
    def ended_data(self) -> Longs:
        """Client data of the pairs in `ended`, (k, 2) uint64."""
    @property
    def previous_pair(self) -> Words:
        """With the scene's `warm_start`, else empty: index of each pair in the last frame, or
        NO_CONTACT for new pairs: (n,) uint32.
        """
    @property
    def previous_point(self) -> Words:
        """Index of each point in the last frame, as `previous_pair`: (p,) uint32."""
    @property
    def runs(self) -> List[Tuple[int, int, int, int]]:
        """Ranges of pairs with the same two kinds of shapes: (kind a, kind b, first, count) each.
        """
    @property
    def manifold_first(self) -> Words:
        """Manifolds of pair i are manifold_first[i] to manifold_first[i + 1]: (n + 1,) uint32."""
    @property
    def part_a(self) -> Words:
        """Triangle or child of a in each manifold, WHOLE_SHAPE for convex shapes: (m,) uint32."""
    @property
    def part_b(self) -> Words:
        """Triangle or child of b, as part_a."""
    @property
    def distance(self) -> Doubles:
        """Distance, negative if they overlap: (m,) float64."""
    @property
    def error_bound(self) -> Doubles:
        """The true distance is within distance +- this: (m,) float64."""
    @property
    def normal(self) -> Doubles:
        """Unit vector from a to b, in world axes: (m, 3) float64."""
    @property
    def point(self) -> Doubles:
        """Level distance: the closest or deepest point of a, relative to its position: (m, 3)
        float64.
        """
    @property
    def point_first(self) -> Words:
        """Level manifold: the points of manifold m are point_first[m] to point_first[m + 1]."""
    @property
    def contact_position(self) -> Floats:
        """Position halfway between the surfaces, relative to the position of a: (p, 3) float32."""
    @property
    def contact_depth(self) -> Floats:
        """Positive where they overlap: (p,) float32."""
    @property
    def contact_feature(self) -> Longs:
        """The features of a and b that made the point, the same from frame to frame: (p,) uint64.
        """

class Scene:
    """Bodies with shapes and poses, and their contacts. Any number of threads may call it; a call
    that raises changes nothing.
    """
    def __init__(
        self, shapes: Shapes, *, contact_margin: float = 0.0, tier: Tier = "robust",
        cache_tolerance: float = 0.0, part_manifolds: bool = False,
        suppress_ghost_contacts: bool = False, warm_start: bool = False,
        structures: Sequence[Structure] = ("LinearBvh", "LinearBvh", "LinearBvh"),
        parallel: bool = True,
        build_budget: int = 0, recorder: Optional[Recorder] = None
    ) -> None:
        """An empty scene. Pairs at most `contact_margin` apart are contacts too; a pair that has
        moved less than `cache_tolerance` keeps its contacts; both are lengths. `tier` as in
        NarrowPhase. `part_manifolds`: one manifold for each pair of parts of composite shapes,
        instead of one for each contact region; `suppress_ghost_contacts`: suppresses ghost contacts
        at the seams between flush fixed bodies; `warm_start`: contacts include their indices in the
        last frame. `structures` of fixed, dynamic and sleeping bodies; `build_budget`: rows of
        planned work per refresh, 0 for as many as are needed in time. `recorder`: records all
        calls.
        """
    def add(
        self, shapes: ArrayLike, poses: Poses, state: Union[BodyState, ArrayLike] = "dynamic",
        layers: ArrayLike = 1, mask: ArrayLike = 0xFFFFFFFF, environment: ArrayLike = 0,
        data: Optional[ArrayLike] = None, *, contact: ArrayLike = 0.0, rest: ArrayLike = 0.0,
        layer: ArrayLike = 0
    ) -> Keys:
        """Adds n bodies and returns their keys, (n,) uint64: shapes (n,), or one for all, at poses
        (n, 7) of x, y, z and a quaternion w, x, y, z, (n, 3), or a tuple of both. `state`: 'fixed',
        'dynamic' or 'sleeping', or (n,) of FIXED, DYNAMIC, SLEEPING. Filters (n,) or one for all,
        as in Partition.set_filter. `data`: (n,) uint64, or one for all. `contact` and `rest` as in
        `set_offsets`, `layer` as in `set_layer`.
        """
    @property
    def shapes(self) -> Shapes:
        """The shapes of the scene."""
    def remove(self, keys: ArrayLike) -> None:
        """Removes the bodies of `keys` (n,), all or none."""
    def clear(self) -> None:
        """Removes every body."""
    def reserve(
        self, *, fixed: int = 0, dynamic: int = 0, sleeping: int = 0, pairs: int = 0,
        touching: int = 0, manifolds: int = 0, points: int = 0, level: Level = "manifold",
        contacts: Optional[Contacts] = None, touch: bool = False
    ) -> None:
        """Reserves the memory for a first `collide` with these numbers of bodies of convex shapes,
        of pairs whose boxes overlap, and of touching pairs; `contacts` reserves for these, their
        manifolds and points. `touch` writes to each page.
        """
    def move(self, keys: ArrayLike, poses: Poses) -> None:
        """Sets new poses of the bodies of `keys` (n,), as in `add`. Positions in double, and
        orientations in float or double, of any strides are read in place.
        """
    def set_body_state(self, keys: ArrayLike, state: BodyState) -> None:
        """Moves bodies to the set of 'fixed', 'dynamic' or 'sleeping' ones."""
    def set_shape(self, keys: ArrayLike, shapes: ArrayLike) -> None:
        """Sets new shapes, (n,) or one for all, of the bodies of `keys` (n,)."""
    def set_filter(
        self, keys: ArrayLike, layers: ArrayLike = 1, mask: ArrayLike = 0xFFFFFFFF,
        environment: ArrayLike = 0
    ) -> None:
        """As Partition.set_filter."""
    def set_offsets(self, keys: ArrayLike, contact: ArrayLike, rest: ArrayLike = 0.0) -> None:
        """Sets contact and rest offsets. Two bodies are in contact from a gap of the sum of their
        `contact` on, in addition to the scene's contact margin, and rest at a distance of the sum
        of their `rest`: (n,) lengths, or one for all, contact >= 0 and >= rest.
        """
    def set_layer(self, keys: ArrayLike, layer: ArrayLike) -> None:
        """Puts bodies into layers, (n,) below 4096 or one for all: see `set_layers_collide`. These
        are independent of the 32 layers of a filter.
        """
    def set_layers_collide(self, layers: ArrayLike, collide: bool = True) -> None:
        """Sets whether bodies of two layers, pairs (n, 2), collide. By default all do."""
    def layers_collide(self, layers: ArrayLike) -> Bools:
        """True for pairs of layers (n, 2) that collide."""
    def set_ignored(self, pairs: ArrayLike, ignored: bool = True) -> None:
        """Makes pairs of bodies, keys (n, 2), never collide, whatever their filters are; or collide
        again. All or none.
        """
    def is_ignored(self, pairs: ArrayLike) -> Bools:
        """True for pairs of keys (n, 2) that are ignored: (n,) bool."""
    def __len__(self) -> int: ...
    def size(self, state: BodyState) -> int:
        """Number of 'fixed', 'dynamic' or 'sleeping' bodies."""
    def contains(self, keys: ArrayLike) -> Bools:
        """True for `keys` (n,) of live bodies: (n,) bool."""
    def keys_of(self, ids: ArrayLike) -> Keys:
        """Keys (n,) uint64 of bodies by id (n,); NULL_KEY for bodies that do not exist."""
    def bodies(self, keys: ArrayLike) -> Dict[str, NDArray[Any]]:
        """The current definitions of the bodies of `keys` (n,): columns shape, pose (n, 7), state,
        layers, mask, environment, data, contact, rest, layer.
        """
    def collide(self, contacts: Contacts, level: Level = "manifold") -> None:
        """Fills `contacts` with all contacts. `level`: 'pairs', 'boolean', 'distance' or
        'manifold'.
        """
    def set_predicate(self, predicate: Optional[PairFunction]) -> None:
        """Sets `predicate(first, second)`, which decides for each pair of bodies, by id, that their
        filters allow; None accepts all. Calls come from any working thread, one at a time, because
        each needs the GIL: some microseconds a pair. Layers (`set_layers_collide`) and
        `set_ignored` have no such cost. It must return the same result each time, because it is not
        called in each frame: set it again to have all pairs tested again. It must not call winnow
        (unsupported). `collide` and `find_impacts` raise its exceptions; contacts that they were to
        fill are cleared. Set None to release it: needed if it refers to the scene.
        """
    @property
    def predicate(self) -> Optional[PairFunction]:
        """The current predicate."""
    def islands(self, contacts: Contacts) -> ContactGroups:
        """Islands of the pairs in contacts that this scene filled last: pairs connected by bodies
        that are not fixed. invalid_key for other contacts.
        """
    def colours(self, contacts: Contacts) -> ContactGroups:
        """Groups in which no two pairs share a body that is not fixed, so that they can be solved
        in parallel; except group REST_COLOUR, the pairs that got no colour.
        """
    def find_impacts(
        self, keys: ArrayLike, ends: Poses, *, pairs: ContinuousPairs = "all",
        bullets: Optional[ArrayLike] = None, tolerance: float = 1e-06, touching: bool = True,
        first_only: bool = False
    ) -> SceneImpacts:
        """Finds the impacts of bodies (n,) that move from their poses to `ends`, poses as in `add`,
        by the shorter rotation; with positions (n, 3) only they do not turn. All other bodies stay
        in place, and the scene does not change. Returns SceneImpacts: the first impact of each pair
        of bodies. `pairs`: 'all', 'fixed' (with fixed bodies), 'bullets' (of these, (n,) bool, with
        all), or 'bullets_and_fixed'. `tolerance` as in `time_of_impact`. `touching` false leaves
        out bodies that touch at the start; `first_only` finds only the first impact of each moving
        body. size_mismatch; invalid_key, also for a key that is given twice; invalid_pose for an
        end that is invalid or too far away; invalid_argument for bad options. O(n log n) and about
        log of all bodies for each, and `time_of_impact` for each pair whose boxes overlap.
        """
    def find_impacts_of_motions(
        self, keys: ArrayLike, motions: ArrayLike, *, pairs: ContinuousPairs = "all",
        bullets: Optional[ArrayLike] = None, tolerance: float = 1e-06, touching: bool = True,
        first_only: bool = False
    ) -> SceneImpacts:
        """As `find_impacts`, for any motions (n, 13), such as those of `motions_by_velocities`;
        each starts at its own pose.
        """
    def refresh(self) -> None:
        """Brings boxes and partitions up to date now rather than in the next query."""
    @property
    def origin(self) -> Tuple[float, float, float]:
        """The point that boxes are measured from."""
    def statistics(self) -> Dict[str, Any]:
        """Counters of the last `collide`."""
    def footprint(self) -> Dict[str, Tuple[int, int]]:
        """Bytes (used, reserved) by part."""
    def debug_draw(
        self, *, objects: bool = True, structure: bool = True, labels: bool = False,
        max_depth: int = 64
    ) -> Drawing:
        """As Partition.debug_draw, of all sets."""
    @overload
    def cast_rays(
        self, origins: ArrayLike, directions: ArrayLike,
        find: Literal["closest", "any"] = "closest", *, min_t: ArrayLike = 0.0,
        max_t: ArrayLike = inf, filter: Optional[Filter] = None
    ) -> SceneHits:
        """Finds the bodies whose shapes the rays origins + t * directions, (n, 3) each or (3,) for
        all, min_t <= t <= max_t, (n,) or one for all, hit. `find`: 'closest' or 'any', returning
        SceneHits, or 'all', returning SceneHitLists. Doubles of one stride are read in place.
        """
    @overload
    def cast_rays(
        self, origins: ArrayLike, directions: ArrayLike, find: Literal["all"], *,
        min_t: ArrayLike = 0.0, max_t: ArrayLike = inf, filter: Optional[Filter] = None
    ) -> SceneHitLists: ...
    def crossings(
        self, origins: ArrayLike, directions: ArrayLike, *, min_t: ArrayLike = 0.0,
        max_t: ArrayLike = inf, filter: Optional[Filter] = None
    ) -> SceneCrossings:
        """All points at which the rays, as in `cast_rays`, cross surfaces of bodies, sorted by t:
        where they enter and leave convex shapes, and each triangle of a mesh or field, from either
        side. A ray that starts in a convex shape only leaves it.
        """
    @overload
    def cast_shapes(
        self, shapes: ArrayLike, poses: Poses, directions: ArrayLike,
        find: Literal["closest"] = "closest", *, max_t: ArrayLike = 1.0, tolerance: float = 1e-06,
        touching: bool = True, filter: Optional[Filter] = None
    ) -> SceneHits:
        """Finds the first contacts with bodies of shapes (n,), or one, at poses (n, 7), that move
        by t * directions, (n, 3) or (3,), without turning. t is never later than the true time, and
        at most `tolerance` (a length) earlier. No half-spaces. `find`: 'closest' or 'all'.
        `touching` false: contacts at the start along which the shape slides or separates are no
        hits.
        """
    @overload
    def cast_shapes(
        self, shapes: ArrayLike, poses: Poses, directions: ArrayLike, find: Literal["all"], *,
        max_t: ArrayLike = 1.0, tolerance: float = 1e-06, touching: bool = True,
        filter: Optional[Filter] = None
    ) -> SceneHitLists: ...
    @overload
    def cast_motions(
        self, shapes: ArrayLike, motions: ArrayLike, find: Literal["closest"] = "closest", *,
        tolerance: float = 1e-06, touching: bool = True, filter: Optional[Filter] = None
    ) -> SceneHits:
        """Finds the first contacts with bodies of shapes (n,), or one, that move and turn by
        motions (n, 13), as returned by `motions_between`; t is the time in [0, 1], never late. The
        gap then is at most `tolerance` as in `time_of_impact`. `find`: 'closest' or 'all'.
        `touching` as in `cast_shapes`. size_mismatch, invalid_key; invalid_pose for an invalid
        motion; unsupported for half-spaces; invalid_argument for a bad tolerance. A path that is
        diagonal to the axes is queried in up to eight pieces.
        """
    @overload
    def cast_motions(
        self, shapes: ArrayLike, motions: ArrayLike, find: Literal["all"], *,
        tolerance: float = 1e-06, touching: bool = True, filter: Optional[Filter] = None
    ) -> SceneHitLists: ...
    def overlap(
        self, shapes: ArrayLike, poses: Poses, *, filter: Optional[Filter] = None
    ) -> SceneOverlaps:
        """Bodies that overlap shapes (n,), or one, at poses (n, 7), sorted by id."""
    def distances(
        self, shapes: ArrayLike, poses: Poses, limit: ArrayLike = 0.0, *,
        filter: Optional[Filter] = None
    ) -> SceneDistances:
        """Bodies within distance `limit`, (n,) or one for all, of shapes (n,), or one, at poses
        (n, 7), sorted by distance; with limit 0 those that overlap, with their depths. The shape is
        the first of the two.
        """
    def distance(
        self, a: ArrayLike, b: ArrayLike, *, limit: float = inf, rules: Rules = "scene"
    ) -> SceneDistances:
        """Closest or deepest points of bodies a (n,) and b (n,): one result for each pair, and none
        if the bodies are farther apart than `limit`. `rules`, here and below: 'scene' tests only
        pairs that `collide` would make, by their sets (one is dynamic), filters, layers, ignored
        pairs and the predicate; 'none' tests any two bodies.
        """
    def least_distance(
        self, a: ArrayLike, b: ArrayLike, *, limit: float = inf, rules: Rules = "scene"
    ) -> Tuple[Keys, SceneDistances]:
        """The closest, or deepest, bodies of two sets a (n,) and b (m,): the key of the first,
        (1,), and one result; both are empty if all are farther apart than `limit`.
        """
    def overlaps(
        self, a: ArrayLike, b: ArrayLike, *, most: int = 0xFFFFFFFFFFFFFFFF, rules: Rules = "scene"
    ) -> Keys:
        """Overlapping bodies of two sets a (n,) and b (m,): keys (k, 2), at most `most` pairs; 1
        stops at the first pair.
        """
    def any_contact(
        self, a: Optional[ArrayLike] = None, b: Optional[ArrayLike] = None, *,
        contact_margin: float = 0.0, rules: Rules = "scene"
    ) -> Keys:
        """The first pair of bodies of two sets a (n,) and b (m,) that touch or are at most
        `contact_margin` apart: keys (1, 2), or (0, 2) if there is none. Without b, of bodies of a
        with each other; without both, of all bodies of the scene.
        """
    def nearest(
        self, points: ArrayLike, count: int = 1, *, radius: ArrayLike = inf,
        filter: Optional[Filter] = None
    ) -> SceneDistances:
        """The bodies nearest to each point (n, 3), at most `count`, within `radius`, (n,) or one
        for all, sorted by distance.
        """
    def save(self) -> bytes:
        """Saves all bodies, and the options of the scene, as bytes. Shapes are saved separately."""
    def load(self, data: Saved) -> None:
        """Loads a snapshot, after its shapes were loaded; results then continue bit for bit.
        Contacts that were filled before belong to another scene from then on.
        """
    def save_contacts(self, contacts: Contacts) -> bytes:
        """Saves the results and records of contacts that this scene filled last, as bytes."""
    def load_contacts(self, data: Saved, contacts: Contacts) -> None:
        """Loads saved contacts into `contacts`; the scene must be in the state in which they were
        saved.
        """

class Sensors:
    """Volumes that detect the bodies in them, and which entered or left, without contacts: goals,
    triggers, light curtains. Rays and bodies do not collide with them. A call that raises changes
    nothing.
    """
    def __init__(self, scene: Scene) -> None:
        """No sensors yet. They detect the bodies of `scene`, which they keep alive."""
    def add(
        self, shapes: ArrayLike, poses: Poses, layers: ArrayLike = 1, mask: ArrayLike = 0xFFFFFFFF,
        environment: ArrayLike = 0, carrier: Optional[ArrayLike] = None,
        data: Optional[ArrayLike] = None, layer: ArrayLike = 0xFFFF
    ) -> Keys:
        """Adds n sensors and returns their keys, (n,) uint64: shapes (n,), or one for all, with
        poses and filters as in Scene.add. `carrier`: keys (n,) of bodies that they ignore, NULL_KEY
        for none. `data`: (n,) uint64, or one for all. `layer`: see Scene.set_layers_collide; 65535
        senses bodies of all layers. All or none: size_mismatch, invalid_key for an unknown shape,
        invalid_pose, invalid_argument for a layer out of range, too_many_objects beyond 2^28.
        """
    def set(
        self, keys: ArrayLike, shapes: ArrayLike, poses: Poses, layers: ArrayLike = 1,
        mask: ArrayLike = 0xFFFFFFFF, environment: ArrayLike = 0,
        carrier: Optional[ArrayLike] = None, data: Optional[ArrayLike] = None,
        layer: ArrayLike = 0xFFFF
    ) -> None:
        """Replaces the definitions of the sensors of `keys` (n,), as in `add`; their keys stay.
        Errors as in `add`, and invalid_key for a key that is stale or given twice.
        """
    def remove(self, keys: ArrayLike) -> None:
        """Removes sensors (n,), all or none: their bodies leave them in the next `sense`.
        invalid_key for a key that is stale or given twice.
        """
    def move(self, keys: ArrayLike, poses: Poses) -> None:
        """Sets new poses of the sensors (n,). size_mismatch, invalid_key, invalid_pose."""
    def __len__(self) -> int: ...
    def contains(self, keys: ArrayLike) -> Bools:
        """True for `keys` (n,) of live sensors: (n,) bool."""
    def sense(self) -> Sensed:
        """Finds the bodies in each sensor, exactly: fixed, dynamic and sleeping ones. O(sensors
        (log n + bodies near each)).
        """

class Cluster:
    """Boxes on any number of ranks and their overlapping pairs: the pairs of one partition of all
    boxes, each once, whatever the number of ranks. A body has a name, uint64, and belongs to the
    rank whose region contains its centre; that rank moves and removes it. The constructor, add,
    self_pairs and digest are collective: every process calls them, in the same order.
    """
    def __init__(
        self, comm: Optional[Any] = None, ranks: int = 1, structure: Structure = "LinearBvh",
        imbalance: float = 1.1
    ) -> None:
        """`comm`: an mpi4py communicator, whose processes are the ranks, or an object with the same
        rank, size, alltoall and allgather. None: `ranks` virtual ranks in this process. Space is
        divided again once a rank has more than `imbalance` times the mean work.
        """
    @property
    def ranks(self) -> int:
        """Number of ranks of all processes."""
    @property
    def hosted(self) -> Tuple[int, int]:
        """Ranks of this process: the first, and one past the last."""
    @property
    def statistics(self) -> Dict[str, Union[int, float]]:
        """Counters of all ranks, the same on each: bodies, ghosts, pairs, bytes, messages,
        migrated, cuts, imbalance.
        """
    def add(
        self, names: ArrayLike, lower: ArrayLike, upper: ArrayLike, rank: Optional[int] = None
    ) -> None:
        """Adds n bodies: names (n,) that no other body has, boxes (n, 3) each. A process that adds
        nothing passes empty arrays. `rank`: a rank of this process, by default its first.
        Collective.
        """
    def move(
        self, names: ArrayLike, lower: ArrayLike, upper: ArrayLike, rank: Optional[int] = None
    ) -> None:
        """New boxes (n, 3) for bodies (n,) of a rank."""
    def remove(self, names: ArrayLike, rank: Optional[int] = None) -> None:
        """Removes bodies of a rank."""
    def self_pairs(self, order: Order = "fast") -> Longs:
        """Pairs of names, the smaller first, that ranks of this process report: (m, 2) uint64.
        Moves bodies to the ranks that they belong to first. Collective.
        """
    def bodies(self, rank: Optional[int] = None) -> Tuple[Longs, Floats, Floats]:
        """(names, lower, upper) of the bodies of a rank: (n,) uint64 and (n, 3) float32 each."""
    def digest(self) -> str:
        """A digest, 128 bits as 32 digits, of the pairs of all ranks: the same on any number of
        ranks. Collective.
        """

class ClusterScene:
    """Bodies with shapes on any number of ranks and their contacts: the contacts of one Scene of
    all bodies, to the bit, each on one rank. A body has a name, uint64, and belongs to the rank
    whose region contains it; that rank moves and removes it. Every process must have added the same
    shapes in the same order; no shape can be removed while the cluster exists. Collective calls are
    made by every process, in the same order.
    """
    def __init__(
        self, shapes: Shapes, comm: Optional[Any] = None, ranks: int = 1, *,
        contact_margin: float = 0.0, tier: Tier = "robust", part_manifolds: bool = False,
        structures: Sequence[Structure] = ("LinearBvh", "LinearBvh", "LinearBvh"),
        parallel: bool = True,
        imbalance: float = 1.1
    ) -> None:
        """`comm`, `ranks` and `imbalance` as for Cluster, the others as for Scene."""
    @property
    def ranks(self) -> int:
        """Number of ranks of all processes."""
    @property
    def hosted(self) -> Tuple[int, int]:
        """Ranks of this process: the first, and one past the last."""
    @property
    def statistics(self) -> Dict[str, Union[int, float]]:
        """Counters of all ranks: bodies, ghosts (copies of bodies), pairs, bytes, messages,
        migrated, cuts, imbalance.
        """
    def add(
        self, names: ArrayLike, shapes: ArrayLike, poses: Poses,
        state: Union[BodyState, ArrayLike] = "dynamic", layers: ArrayLike = 1,
        mask: ArrayLike = 0xFFFFFFFF, environment: ArrayLike = 0, *, rank: Optional[int] = None
    ) -> None:
        """Adds n bodies: names (n,) uint64 that no other body has, otherwise as Scene.add. A
        process that adds nothing passes empty arrays. Bodies are fixed or dynamic. `rank`: a rank
        of this process, by default its first. Collective.
        """
    def replicate(
        self, names: ArrayLike, shapes: ArrayLike, poses: Poses, layers: ArrayLike = 1,
        mask: ArrayLike = 0xFFFFFFFF, environment: ArrayLike = 0
    ) -> None:
        """Adds fixed bodies that are on every rank, such as a ground. Every process passes the same
        bodies. They cannot be removed. Collective.
        """
    def move_replicated(self, names: ArrayLike, poses: Poses) -> None:
        """Sets new poses of replicated bodies, the same on every process. Collective."""
    def move(self, names: ArrayLike, poses: Poses, *, rank: Optional[int] = None) -> None:
        """Sets new poses of bodies (n,) that belong to a rank, as in Scene.move."""
    def remove(self, names: ArrayLike, *, rank: Optional[int] = None) -> None:
        """Removes bodies that belong to a rank."""
    def collide(self, level: Level = "manifold") -> None:
        """Finds all contacts, as Scene.collide; see `contacts`. Moves bodies to the ranks that they
        belong to first. Collective.
        """
    def contacts(self, rank: Optional[int] = None) -> Contacts:
        """The contacts that a rank of this process reports; all ranks together report all contacts.
        Client data are names. No other call can fill them.
        """
    def digest(self) -> str:
        """A digest, 128 bits as 32 digits, of the contacts of all ranks: the same on any number of
        ranks. Collective.
        """
    def bodies(self, rank: Optional[int] = None) -> Dict[str, Numbers]:
        """The bodies of a rank: columns name, shape, pose (n, 7), state."""
    def migrated(self, rank: Optional[int] = None) -> Tuple[Longs, Longs]:
        """Names of bodies that the last `collide` moved to this rank, and of bodies that it moved
        to others: (n,) and (m,) uint64.
        """
    def save(self, rank: Optional[int] = None) -> bytes:
        """The state of a rank, without replicated bodies, as bytes."""
    def restore(self, saved: Sequence[Saved]) -> None:
        """Adds the bodies that any number of ranks saved: bytes for each rank of this process
        (several concatenated, or none). Replicated bodies must be added again before the first
        `collide`. Collective.
        """

def perspective(
    eye: ArrayLike, forward: ArrayLike, up: ArrayLike, vertical_fov: float, aspect: float,
    near: float, far: float
) -> Floats:
    """Frusta of cameras at eye (n, 3) with view direction `forward` and approximate up direction
    `up`, (n, 3) or (3,) each; vertical field of view in radians, in (0, pi); distances of the near
    and far plane. (n, 30) float32: six inward planes, then a box.
    """

def frusta_of(
    clip_from_world: ArrayLike, near_depth: NearDepth = "zero"
) -> Floats:
    """Frusta of matrices (n, 4, 4) that transform column vectors from world to clip space, with the
    near plane at depth 'zero' or 'minus_one'. (n, 30) float32.
    """

def kdop_directions(faces: int) -> Floats:
    """Directions of the slabs of a k-DOP of 14, 18 or 26 faces, not normalised: (k/2, 3) float32.
    """

def structures() -> List[Structure]:
    """Names of all structures."""

def boxes_address(lower: ArrayLike, upper: ArrayLike) -> int:
    """Address from which a call reads the lower corner of the first box: in `lower` itself, unless
    the boxes must be copied.
    """

def outward(lower: ArrayLike, upper: ArrayLike, origin: ArrayLike) -> Tuple[Floats, Floats]:
    """The smallest float boxes, (n, 3) float32 each, that contain boxes in double, measured from
    `origin`, (n, 3) or (3,): for worlds far from 0.
    """

def isa_name() -> Isa:
    """The instruction set in use: sse42, avx2, avx512 or neon64."""

def available_isas() -> List[Isa]:
    """Instruction sets of this build that the machine supports, narrowest first."""

def set_isa(name: Isa) -> None:
    """Chooses an instruction set for the whole process."""

def set_stage_hook(hook: Optional[StageHook]) -> Optional[StageHook]:
    """Sets a process-wide hook: `hook(stage, begins)` is called at the begin and end of each stage
    of work, by the thread that called winnow: 'refresh', 'build', 'pairs', 'mid_phase',
    'narrow_phase' or 'contacts'. Stages nest. None removes the hook; returns the old one. A hook
    must not call winnow (unsupported); its exceptions go to sys.unraisablehook.
    """

def set_log_hook(hook: Optional[LogHook]) -> Optional[LogHook]:
    """Sets a process-wide hook: `hook(entry)` is called, as the stage hook, with a dict: kind
    'choice' if AutoPartition changed its structure (what, before, reason, objects), kind 'refusal'
    if a call of a partition or scene failed (what, reason, status).
    """

def motions_between(start: Poses, end: Poses) -> Doubles:
    """Motions between poses (n, 7), (n, 3) or tuples, from time 0 to 1: (n, 13) float64 of the pose
    at the start (x, y, z and a quaternion w, x, y, z), the translation, and the rotation, an axis
    in the world times an angle in radians; both at constant speed. The rotation is the shorter one.
    """

def motions_by_velocities(
    poses: Poses, linear: ArrayLike, angular: ArrayLike, duration: ArrayLike = 1.0
) -> Doubles:
    """Motions of bodies at poses (n, 7) with velocities, linear and angular (n, 3) or (3,), in
    lengths and radians per unit of time, during `duration` units, (n,) or one for all. At most 1e6
    radians.
    """

def poses_at(motions: ArrayLike, times: ArrayLike) -> Doubles:
    """Poses of motions (n, 13) at times in [0, 1], (n,) or one for all: (n, 7) float64."""

def time_of_impact(
    shapes: Shapes, shape_of: ArrayLike, motions: ArrayLike, pairs: ArrayLike, *,
    tolerance: float = 1e-06, parallel: bool = True
) -> Impacts:
    """Times of impact of pairs (m, 2) uint32 of bodies. Body i has the shape shape_of[i] of
    `shapes`, (n,) or one for all, convex or composite, and moves by motions (n, 13), as returned by
    `motions_between` and `motions_by_velocities`. At the time of impact the gap is at most
    `tolerance`, in (0, 1], of the smaller shape's size. One bad pair makes the call fail:
    size_mismatch, invalid_key for an unknown shape, invalid_pose for an invalid motion,
    invalid_argument for an unknown body or a bad tolerance. A pair takes about three closest-point
    computations, up to |turn| / sqrt(tolerance) if shapes rotate fast around each other; composite
    shapes take as many for each pair of parts whose boxes overlap.
    """

def feature_impacts(
    kind: FeatureKind, start: ArrayLike, end: ArrayLike, *, min_separation: float = 0.0,
    tolerance: float = 9.094947017729282e-13, max_intervals: int = 2048
) -> Doubles:
    """Times at which mesh features first touch, whose points move from `start` to `end`, (n, 4, 3)
    each. `kind`: 'vertex_face', point 0 and the triangle of the others, or 'edge_edge', the edge of
    points 0 and 1 and the edge of points 2 and 3. Times (n,) float64 in [0, 1], never late;
    infinity without an impact, NaN if a coordinate is not finite. They touch at a distance of
    `min_separation`. Times are early by at most `tolerance`, in (0, 1], or more if `max_intervals`
    ends the search.
    """

def replay(data: Saved, parallel: bool = True) -> Dict[str, int]:
    """Replays a recording, the bytes of a file, and compares each result with the recorded one, bit
    for bit: counts of calls, frames, questions, differences and worlds (partitions and scenes), and
    is_whole if the recording is complete. invalid_argument for bytes that are not a valid
    recording.
    """
