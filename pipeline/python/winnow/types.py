"""Types of arguments and results, for annotations."""

from typing import Any, Callable, Dict, Literal, Tuple, Union

import numpy
from numpy.typing import ArrayLike, NDArray

Bools = NDArray[numpy.bool_]
Bytes = NDArray[numpy.uint8]
Words = NDArray[numpy.uint32]
Keys = NDArray[numpy.uint64]
Longs = NDArray[numpy.uint64]
Floats = NDArray[numpy.float32]
Doubles = NDArray[numpy.float64]
Numbers = NDArray[Any]
Poses = Union[ArrayLike, Tuple[ArrayLike, ArrayLike]]
Saved = Union[bytes, bytearray, memoryview, Bytes]

BodyState = Literal["fixed", "dynamic", "sleeping"]
ContinuousPairs = Literal["all", "fixed", "bullets", "bullets_and_fixed"]
FeatureKind = Literal["vertex_face", "edge_edge"]
Find = Literal["closest", "any", "all"]
Isa = Literal["sse42", "avx2", "avx512", "neon64"]
Level = Literal["pairs", "boolean", "distance", "manifold"]
NearDepth = Literal["zero", "minus_one"]
Order = Literal["fast", "canonical"]
Rules = Literal["scene", "none"]
Stage = Literal["refresh", "build", "pairs", "mid_phase", "narrow_phase", "contacts"]
Status = Literal[
    "ok", "invalid_bounds", "invalid_key", "invalid_argument", "size_mismatch", "out_of_memory",
    "too_many_objects", "unsupported_volume", "invalid_shape", "invalid_pose", "unsupported",
    "communication_failed",
]  # fmt: skip
Structure = Literal[
    "AutoPartition", "BoundsNSquared", "FlatGrid", "HierarchicalGrid", "LinearBvh", "LooseOctree",
    "LooseQuadtree", "NSquared", "StaticBvh", "SweepAndPrune",
]  # fmt: skip
Tier = Literal["robust", "reference"]
Volume = Literal["aabb", "sphere", "kdop14", "kdop18", "kdop26"]

PairFunction = Callable[[int, int], Any]
SupportFunction = Callable[[Doubles], ArrayLike]
StageHook = Callable[[Stage, bool], Any]
LogHook = Callable[[Dict[str, Any]], Any]
