"""Collision detection: pairs that may touch, pairs that do, and their contacts.

All calls take numpy arrays of many objects and return arrays; they release the GIL during work.

    import winnow
    partition = winnow.Partition("LinearBvh")
    keys = partition.insert(lower, upper)      # (n, 3) each, float or double, any strides
    pairs = partition.self_pairs()             # (m, 2) uint32 of ids
    ids = winnow.ids_of(keys)

An argument (n,) may be one number, and an argument (n, 3) one point, for all n; a single object may
be given without a list. A failed call raises a `StatusError` with the status, which names the
argument and the row, and changes nothing. Arrays that are returned
keep their data alive, and the data do not change.
"""

from winnow import protocols as _protocols
from winnow._core import *
from winnow._core import __version__ as __version__
from winnow.advice import *
from winnow.calls import *
from winnow.tables import *

__all__ = ["__version__"]
__all__ += (
    name
    for name, value in list(globals().items())
    if not name.startswith("_") and not isinstance(value, type(_protocols))
)
