"""Scenes of random boxes, and brute-force references for queries."""

import contextlib
import threading

import numpy as np
import winnow

REFUSALS = (winnow.StatusError, TypeError, MemoryError)


def answered_or_refused(calls):
    """Calls functions; each returns, or raises an exception of winnow."""
    for call in calls:
        with contextlib.suppress(*REFUSALS):
            call()


def at_once(*works, times=30):
    """Calls each function for the numbers from 0 to `times`, on a thread of its own; they raise nothing."""
    failures = []

    def run(work):
        try:
            for i in range(times):
                work(i)
        except BaseException as error:  # noqa: B902
            failures.append(error)

    threads = [threading.Thread(target=run, args=(work,)) for work in works]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failures


def random_boxes(seed, count, side=None):
    """Returns corners of boxes with about two overlaps each, as (n, 3) float32."""
    random = np.random.default_rng(seed)
    side = side or max(1.0, count ** (1 / 3))
    lower = random.uniform(0, side, (count, 3)).astype(np.float32)
    return lower, (lower + random.uniform(0.1, 1.0, (count, 3))).astype(np.float32)


def overlapping(lower, upper, other_lower, other_upper):
    """Returns the closed overlap of each box with each, as (n, m) bool."""
    overlap = (lower[:, None] <= other_upper[None]) & (other_lower[None] <= upper[:, None])
    return overlap.all(axis=2)


def pair_set(pairs):
    return {(int(a), int(b)) for a, b in pairs}


def reference_pairs(lower, upper):
    first, second = np.nonzero(np.triu(overlapping(lower, upper, lower, upper), 1))
    return set(zip(first.tolist(), second.tolist()))


def ray_entry(lower, upper, origin, direction):
    """Returns where a ray enters a box, in double; infinity if it does not."""
    with np.errstate(divide="ignore", invalid="ignore"):
        a = (lower.astype(float) - origin) / direction
        b = (upper.astype(float) - origin) / direction
    near, far = np.minimum(a, b), np.maximum(a, b)
    parallel = direction == 0
    inside = (lower <= origin) & (origin <= upper)
    near = np.where(parallel, np.where(inside, -np.inf, np.inf), near)
    far = np.where(parallel, np.where(inside, np.inf, -np.inf), far)
    enter = max(0.0, near.max())
    return enter if enter <= far.min() else np.inf
