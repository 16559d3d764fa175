"""Which structure is fastest on frames of your own."""

import time
from dataclasses import dataclass
from typing import Dict, Iterable, List, Optional, Sequence, Tuple

import numpy
from numpy.typing import ArrayLike, NDArray

from winnow._core import Partition, StatusError
from winnow._core import structures as all_structures

__all__ = ["Advice", "Advised", "advise"]

Boxes = Tuple[NDArray[numpy.float32], NDArray[numpy.float32]]


@dataclass(frozen=True)
class Advised:
    """One structure in the race."""

    structure: str
    first_ms: float
    """Of the frame in which everything is inserted."""
    median_ms: float
    """Of the frames after the first."""
    worst_ms: float
    """Of those."""
    tests: int
    """Of 16 volumes at once, in the last frame."""
    bytes: int
    """Held in the end, results left out."""


@dataclass(frozen=True)
class Advice:
    """The race, fastest first, and what AutoPartition took, if it was in it."""

    ranking: List[Advised]
    chosen: str
    """The structure that AutoPartition has in the end; empty if it was not in the race."""
    reason: str
    """Its own."""
    objects: int
    frames: int
    pairs: float
    """A frame, on the average."""

    @property
    def best(self) -> str:
        """The fastest structure."""
        return self.ranking[0].structure


class _Runner:
    """A partition that takes frame after frame."""

    def __init__(self, structure: str, first: Boxes, parallel: bool) -> None:
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


def _structures(names: Optional[Sequence[str]], objects: int) -> List[str]:
    if names is not None:
        return list(names)
    # What tests each with each takes the square of the objects' number.
    brute = {"NSquared": 2_000, "BoundsNSquared": 20_000}
    return [name for name in all_structures() if objects <= brute.get(name, objects)]


def advise(
    frames: Iterable[Tuple[ArrayLike, ArrayLike]],
    structures: Optional[Sequence[str]] = None,
    *,
    parallel: bool = True,
) -> Advice:
    """Races structures on `frames`, boxes (lower, upper) of (n, 3) each, of the same n objects.

    In each frame each structure is given the boxes that changed and asked for all pairs, one after
    the other, so that what else the machine does meets all of them. `structures` are names, by
    default all that suit so many objects. About twenty frames do. invalid_argument where there are
    no frames or no structures, size_mismatch where a frame has another number of objects. To
    measure what a program did, record it (`Recorder`) and ask the tool: `winnow advise FILE`.
    """
    of: Dict[str, _Runner] = {}
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


def _refusal(status: str, what: str) -> StatusError:
    error = StatusError("%s: advise: %s" % (status, what))
    error.status = status
    return error
