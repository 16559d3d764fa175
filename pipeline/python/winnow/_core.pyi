from typing import Any, List, Literal, Optional, Tuple, Union, overload

import numpy
from numpy.typing import ArrayLike, NDArray

Order = Literal["fast", "canonical"]
Volume = Literal["aabb", "sphere", "kdop14", "kdop18", "kdop26"]
Bools = NDArray[numpy.bool_]
Bytes = NDArray[numpy.uint8]
Words = NDArray[numpy.uint32]
Keys = NDArray[numpy.uint64]
Longs = NDArray[numpy.uint64]
Floats = NDArray[numpy.float32]

NULL_KEY: int
NO_OBJECT: int
EVERY_ENVIRONMENT: int

class StatusError(ValueError):
    status: str

class Filter:
    def __init__(
        self, layers: int = ..., mask: int = ..., environment: int = ...
    ) -> None: ...
    @property
    def layers(self) -> int: ...
    @property
    def mask(self) -> int: ...
    @property
    def environment(self) -> int: ...

class Hits:
    @property
    def key(self) -> Keys: ...
    @property
    def data(self) -> Longs: ...
    @property
    def t(self) -> Floats: ...

class HitLists:
    @property
    def first(self) -> Longs: ...
    @property
    def key(self) -> Keys: ...
    @property
    def data(self) -> Longs: ...
    @property
    def t(self) -> Floats: ...

class Overlaps:
    @property
    def first(self) -> Longs: ...
    @property
    def crossing(self) -> Longs: ...
    @property
    def ids(self) -> Words: ...

class Drawing:
    @property
    def boxes(self) -> Floats: ...
    @property
    def box_colours(self) -> Bytes: ...
    @property
    def lines(self) -> Floats: ...
    @property
    def line_colours(self) -> Bytes: ...
    @property
    def spheres(self) -> Floats: ...
    @property
    def sphere_colours(self) -> Bytes: ...
    @property
    def text_places(self) -> Floats: ...
    @property
    def text_colours(self) -> Bytes: ...
    @property
    def texts(self) -> List[str]: ...

class PairEvents:
    def __init__(self) -> None: ...
    @property
    def begun(self) -> Keys: ...
    @property
    def ended(self) -> Keys: ...
    @property
    def persisting(self) -> int: ...
    def clear(self) -> None: ...

class Partition:
    def __init__(
        self,
        structure: str = ...,
        *,
        volume: Volume = ...,
        margin: float = ...,
        margin_share: float = ...,
        parallel: bool = ...,
        build_budget: int = ...,
        loose: Optional[float] = ...,
    ) -> None: ...
    def insert(
        self, lower: ArrayLike, upper: ArrayLike, data: Optional[ArrayLike] = ...
    ) -> Keys: ...
    def update(
        self,
        keys: ArrayLike,
        lower: ArrayLike,
        upper: ArrayLike,
        entries: Optional[ArrayLike] = ...,
    ) -> None: ...
    def insert_spheres(
        self, centers: ArrayLike, radii: ArrayLike, data: Optional[ArrayLike] = ...
    ) -> Keys: ...
    def update_spheres(
        self, keys: ArrayLike, centers: ArrayLike, radii: ArrayLike
    ) -> None: ...
    def insert_kdops(
        self, lower: ArrayLike, upper: ArrayLike, data: Optional[ArrayLike] = ...
    ) -> Keys: ...
    def update_kdops(
        self, keys: ArrayLike, lower: ArrayLike, upper: ArrayLike
    ) -> None: ...
    def remove(self, keys: ArrayLike) -> None: ...
    def clear(self) -> None: ...
    def release_memory(self) -> None: ...
    def reserve(self, objects: int, pairs: int = ..., touch: bool = ...) -> None: ...
    def __len__(self) -> int: ...
    def contains(self, keys: ArrayLike) -> Bools: ...
    def bounds(self, keys: ArrayLike) -> Tuple[Floats, Floats]: ...
    def client_data(self, keys: ArrayLike) -> Longs: ...
    def keys_of(self, ids: ArrayLike) -> Keys: ...
    def client_data_of(self, ids: ArrayLike) -> Longs: ...
    def set_filter(
        self,
        keys: ArrayLike,
        layers: ArrayLike = ...,
        mask: ArrayLike = ...,
        environment: ArrayLike = ...,
    ) -> None: ...
    def filters(self, keys: ArrayLike) -> Tuple[Words, Words, Words]: ...
    def self_pairs(
        self,
        events: Optional[PairEvents] = ...,
        *,
        order: Order = ...,
        incremental: bool = ...,
    ) -> Words: ...
    def pair_changes(self, events: PairEvents) -> None: ...
    def pairs_with(self, other: "Partition", *, order: Order = ...) -> Words: ...
    def refresh(self) -> None: ...
    def set_structure(self, structure: str, loose: Optional[float] = ...) -> None: ...
    @property
    def structure(self) -> str: ...
    @property
    def volume(self) -> Volume: ...
    @property
    def margin(self) -> Tuple[float, float]: ...
    @property
    def is_exact(self) -> bool: ...
    def choice(self) -> dict[str, Any]: ...
    def statistics(self) -> dict[str, int]: ...
    def footprint(self) -> dict[str, Tuple[int, int]]: ...
    def debug_draw(
        self,
        *,
        objects: bool = ...,
        structure: bool = ...,
        labels: bool = ...,
        max_depth: int = ...,
    ) -> Drawing: ...
    @overload
    def cast_rays(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        find: Literal["closest", "any"] = ...,
        *,
        min_t: ArrayLike = ...,
        max_t: ArrayLike = ...,
        filter: Filter = ...,
    ) -> Hits: ...
    @overload
    def cast_rays(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        find: Literal["all"],
        *,
        min_t: ArrayLike = ...,
        max_t: ArrayLike = ...,
        filter: Filter = ...,
    ) -> HitLists: ...
    @overload
    def cast_boxes(
        self,
        lower: ArrayLike,
        upper: ArrayLike,
        directions: ArrayLike,
        find: Literal["closest", "any"] = ...,
        *,
        min_t: ArrayLike = ...,
        max_t: ArrayLike = ...,
        filter: Filter = ...,
    ) -> Hits: ...
    @overload
    def cast_boxes(
        self,
        lower: ArrayLike,
        upper: ArrayLike,
        directions: ArrayLike,
        find: Literal["all"],
        *,
        min_t: ArrayLike = ...,
        max_t: ArrayLike = ...,
        filter: Filter = ...,
    ) -> HitLists: ...
    @overload
    def cast_spheres(
        self,
        centers: ArrayLike,
        radii: ArrayLike,
        directions: ArrayLike,
        find: Literal["closest", "any"] = ...,
        *,
        min_t: ArrayLike = ...,
        max_t: ArrayLike = ...,
        filter: Filter = ...,
    ) -> Hits: ...
    @overload
    def cast_spheres(
        self,
        centers: ArrayLike,
        radii: ArrayLike,
        directions: ArrayLike,
        find: Literal["all"],
        *,
        min_t: ArrayLike = ...,
        max_t: ArrayLike = ...,
        filter: Filter = ...,
    ) -> HitLists: ...
    @overload
    def cast_capsules(
        self,
        a: ArrayLike,
        b: ArrayLike,
        radii: ArrayLike,
        directions: ArrayLike,
        find: Literal["closest", "any"] = ...,
        *,
        min_t: ArrayLike = ...,
        max_t: ArrayLike = ...,
        filter: Filter = ...,
    ) -> Hits: ...
    @overload
    def cast_capsules(
        self,
        a: ArrayLike,
        b: ArrayLike,
        radii: ArrayLike,
        directions: ArrayLike,
        find: Literal["all"],
        *,
        min_t: ArrayLike = ...,
        max_t: ArrayLike = ...,
        filter: Filter = ...,
    ) -> HitLists: ...
    def overlap_boxes(
        self,
        lower: ArrayLike,
        upper: ArrayLike,
        *,
        order: Order = ...,
        filter: Filter = ...,
    ) -> Words: ...
    def overlap_points(
        self, points: ArrayLike, *, order: Order = ..., filter: Filter = ...
    ) -> Overlaps: ...
    def overlap_spheres(
        self,
        centers: ArrayLike,
        radii: ArrayLike,
        *,
        order: Order = ...,
        filter: Filter = ...,
    ) -> Overlaps: ...
    def overlap_capsules(
        self,
        a: ArrayLike,
        b: ArrayLike,
        radii: ArrayLike,
        *,
        order: Order = ...,
        filter: Filter = ...,
    ) -> Overlaps: ...
    def overlap_oriented_boxes(
        self,
        centers: ArrayLike,
        half: ArrayLike,
        axes: ArrayLike,
        *,
        order: Order = ...,
        filter: Filter = ...,
    ) -> Overlaps: ...
    def overlap_frusta(
        self, frusta: ArrayLike, *, order: Order = ..., filter: Filter = ...
    ) -> Overlaps: ...
    def overlap_planes(
        self, planes: ArrayLike, *, order: Order = ..., filter: Filter = ...
    ) -> Overlaps: ...
    def nearest(
        self,
        lower: ArrayLike,
        count: int = ...,
        *,
        upper: Optional[ArrayLike] = ...,
        radius: ArrayLike = ...,
        filter: Filter = ...,
    ) -> Hits: ...

def perspective(
    eye: ArrayLike,
    forward: ArrayLike,
    up: ArrayLike,
    vertical_fov: float,
    aspect: float,
    near: float,
    far: float,
) -> Floats: ...
def frusta_of(
    clip_from_world: ArrayLike, near_depth: Literal["zero", "minus_one"] = ...
) -> Floats: ...
def kdop_directions(faces: int) -> Floats: ...
def structures() -> List[str]: ...
def boxes_address(lower: ArrayLike, upper: ArrayLike) -> int: ...
def outward(
    lower: ArrayLike, upper: ArrayLike, origin: ArrayLike
) -> Tuple[Floats, Floats]: ...
def isa_name() -> str: ...
def available_isas() -> List[str]: ...
def set_isa(name: str) -> None: ...
