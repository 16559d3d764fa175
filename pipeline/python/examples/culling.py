"""Culling: which of many boxes a camera sees, and which are entirely inside its frustum."""

import numpy as np
import winnow


def walk(count=20000, frames=8, seed=2):
    """Returns the numbers (seen, entirely inside) for each frame of a rotating camera."""
    random = np.random.default_rng(seed)
    lower = random.uniform(-100, 100, (count, 3)).astype(np.float32)
    world = winnow.Partition("StaticBvh")
    world.insert(lower, lower + random.uniform(0.5, 3, (count, 3)).astype(np.float32))
    angle = np.linspace(0, 2 * np.pi, frames, endpoint=False)
    ahead = np.stack([np.cos(angle), np.sin(angle), np.zeros(frames)], axis=1)
    cameras = winnow.perspective(np.zeros((frames, 3)), ahead, [0, 0, 1], 1.0, 1.6, 0.1, 80.0)
    found = world.overlap_frusta(cameras)
    seen = np.diff(found.first.astype(int))
    inside = found.crossing.astype(int) - found.first[:-1].astype(int)
    return list(zip(seen.tolist(), inside.tolist()))


if __name__ == "__main__":
    for number, (seen, inside) in enumerate(walk()):
        print("frame %d: %d boxes, %d of them wholly" % (number, seen, inside))
