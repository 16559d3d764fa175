"""Adds `repr`, and `pickle` and `copy` by snapshots, to the classes of `_core`."""

from typing import Any, Dict, Tuple

from winnow import _core
from winnow.tables import shown

# Properties that `repr` shows, besides the number of objects.
SHOWN: Dict[str, Tuple[str, ...]] = {
    "Cluster": ("ranks", "hosted"),
    "ClusterScene": ("ranks", "hosted"),
    "Contacts": ("level",),
    "DeformableMesh": ("vertices", "triangles"),
    "Filter": ("layers", "mask", "environment", "layer", "accept"),
    "NarrowPhase": (),
    "NarrowResult": ("level",),
    "PairEvents": ("persisting",),
    "Partition": ("structure", "volume"),
    "Recorder": ("status", "calls"),
    "Scene": ("origin",),
    "Sensors": (),
    "Shapes": (),
}


def _repr(self: Any) -> str:
    columns = ["%s=%s" % (name, shown(getattr(self, name))) for name in SHOWN[type(self).__name__]]
    size = ["len=%d" % len(self)] if hasattr(self, "__len__") else []
    return "%s(%s)" % (type(self).__name__, ", ".join(size + columns))


def _loaded(kind: Any, arguments: Tuple[Any, ...], saved: bytes) -> Any:
    """Returns an object with the state that another one saved."""
    made = kind(*arguments)
    made.load(saved)
    return made


def _reduce(self: Any) -> Tuple[Any, ...]:
    arguments = (self.shapes,) if isinstance(self, _core.Scene) else ()
    return _loaded, (type(self), arguments, self.save())


for _name in SHOWN:
    setattr(getattr(_core, _name), "__repr__", _repr)
for _kind in (_core.Partition, _core.Scene, _core.Shapes):
    setattr(_kind, "__reduce__", _reduce)
