"""Boxes in the program's own arrays: pairs that begin and end from frame to frame."""

import numpy as np
import winnow

BOXES = 10000


def lower_corners(time):
    i = np.arange(BOXES, dtype=np.float32)
    return np.stack(
        [100 * np.sin(0.7 * i + time), 100 * np.cos(1.3 * i + 0.5 * time), 0 * i], axis=1
    ).astype(np.float32)


partition = winnow.Partition("LinearBvh")
low = lower_corners(0)
keys = partition.insert(low, low + 1)
events = winnow.PairEvents()
begun = ended = 0
for frame in range(1, 11):
    low = lower_corners(0.01 * frame)
    partition.update(keys, low, low + 1)
    pairs = partition.self_pairs(events=events)
    begun += len(events.begun)
    ended += len(events.ended)

print("%d pairs; %d began, %d ended" % (len(pairs), begun, ended))
assert begun - ended == len(pairs) and ended > 0
