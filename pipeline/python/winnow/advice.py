"""Finds the fastest structure for frames of boxes."""

import time
from dataclasses import dataclass
from typing import Dict, Iterable, List, Optional, Sequence, Tuple

import numpy
from numpy.typing import ArrayLike, NDArray

from winnow._core import Partition, StatusError
from winnow._core import structures as all_structures
from winnow.types import Status, Structure

__all__ = ["Advice", "Advised", "advise"]

Boxes = Tuple[NDArray[numpy.float32], NDArray[numpy.float32]]


@dataclass(frozen=True)
class Advised:
    """Measurements of one structure."""

    structure: Structure
    first_ms: float
    """Time of the frame in which all objects are inserted."""
    median_ms: float
    """Median time of the frames after the first."""
    worst_ms: float
    """Longest time of the frames after the first."""
    tests: int
    """Number of tests in the last frame, each of 16 volumes."""
    bytes: int
    """Memory after the last frame, without results."""


@dataclass(frozen=True)
class Advice:
    """All structures, fastest first, and the choice of AutoPartition, if it is among them."""

    ranking: List[Advised]
    chosen: str
    """The structure that AutoPartition uses at the end; empty if it was not measured."""
    reason: str
    """AutoPartition's reason."""
    objects: int
    frames: int
    pairs: float
    """Mean number of pairs per frame."""

    @property
    def best(self) -> Structure:
        """The fastest structure."""
        return self.ranking[0].structure


class _Runner:
    """A partition that is measured frame by frame."""

    def __init__(self, structure: Structure, first: Boxes, parallel: bool) -> None:
        self.partition = Partition(structure, parallel=parallel)
        self.milliseconds: List[float] = []
        start = time.perf_counter()
        self.keys = self.partition.insert(*first)
        self.found = len(self.partition.self_pairs())
        self.milliseconds.append(1e3 * (time.perf_counter() - start))

    def frame(self, boxes: Boxes, entries: NDArray[numpy.uint32]) -> None:
        start = time.perf_counter()
        self.partition.update(self.keys, boxes[0], boxes[1], entries)
        self.found = len(self.partition.self_pairs())
        self.milliseconds.append(1e3 * (time.perf_counter() - start))

    def advised(self) -> Advised:
        later = self.milliseconds[1:] or self.milliseconds
        footprint = self.partition.footprint()
        return Advised(
            structure=self.partition.structure,
            first_ms=self.milliseconds[0],
            median_ms=float(numpy.median(later)),
            worst_ms=max(later),
            tests=self.partition.statistics()["last_tests"],
            bytes=footprint["total"][1] - footprint["results"][1],
        )


def _boxes(frame: Tuple[ArrayLike, ArrayLike]) -> Boxes:
    lower, upper = frame
    return numpy.array(lower, numpy.float32), numpy.array(upper, numpy.float32)


def _structures(names: Optional[Sequence[Structure]], objects: int) -> List[Structure]:
    if names is not None:
        return list(names)
    # Structures that test all pairs take time quadratic in the number of objects.
    brute = {"NSquared": 2_000, "BoundsNSquared": 20_000}
    return [name for name in all_structures() if objects <= brute.get(name, objects)]


def advise(
    frames: Iterable[Tuple[ArrayLike, ArrayLike]],
    structures: Optional[Sequence[Structure]] = None,
    *,
    parallel: bool = True,
) -> Advice:
    """Measures structures on `frames`, boxes (lower, upper) of (n, 3) each, of the same n objects.

    In each frame, each structure in turn gets the boxes that changed and finds all pairs; the
    interleaving spreads disturbances by other programs over all structures. `structures` are
    names, by default all that are suitable for n objects. About twenty frames are enough.
    invalid_argument without frames or structures, size_mismatch if a frame has another number of
    objects. To measure a whole program, record it (`Recorder`) and run `winnow advise FILE`.
    """
    of: Dict[Structure, _Runner] = {}
    last: Optional[Boxes] = None
    pairs = 0
    count = 0
    for frame in frames:
        boxes = _boxes(frame)
        count += 1
        if last is None:
            for name in _structures(structures, len(boxes[0])):
                of[name] = _Runner(name, boxes, parallel)
        else:
            if boxes[0].shape != last[0].shape or boxes[1].shape != last[1].shape:
                raise _refusal("size_mismatch", "frame %d has other objects" % (count - 1))
            moved = (boxes[0] != last[0]).any(1) | (boxes[1] != last[1]).any(1)
            entries = numpy.flatnonzero(moved).astype(numpy.uint32)
            for runner in of.values():
                runner.frame(boxes, entries)
        last = boxes
        pairs += next((runner.found for runner in of.values()), 0)
    if last is None or not of:
        raise _refusal("invalid_argument", "no frames, or no structures")
    choice = of["AutoPartition"].partition.choice() if "AutoPartition" in of else {}
    return Advice(
        ranking=sorted((r.advised() for r in of.values()), key=lambda a: a.median_ms),
        chosen=str(choice.get("structure", "")),
        reason=str(choice.get("reason", "")),
        objects=len(last[0]),
        frames=count,
        pairs=pairs / count,
    )


def _refusal(status: Status, what: str) -> StatusError:
    error = StatusError("%s: advise: %s" % (status, what))
    error.status = status
    return error
