"""Boids: each flies with its neighbours, found as overlapping spheres of half the sight radius."""

import numpy as np
import winnow


def flock(count=2000, frames=20, sight=1.0, seed=1):
    """Mean alignment, 0 to 1, of each frame."""
    random = np.random.default_rng(seed)
    side = count ** (1 / 3)
    place = random.uniform(0, side, (count, 3))
    speed = random.normal(size=(count, 3))
    # [neighbours]
    boids = winnow.Partition("HierarchicalGrid", volume="sphere")
    keys = boids.insert_spheres(place, sight / 2)
    alignment = []
    for _ in range(frames):
        first, second = boids.self_pairs().T
        # [end]
        others = np.zeros_like(speed)
        np.add.at(others, first, speed[second])
        np.add.at(others, second, speed[first])
        apart = place[first] - place[second]
        push = 0.05 * apart / np.maximum(np.linalg.norm(apart, axis=1, keepdims=True), 0.1)
        np.add.at(others, first, push)
        np.add.at(others, second, -push)
        speed += 0.2 * others
        speed /= np.linalg.norm(speed, axis=1, keepdims=True)
        place = (place + 0.05 * speed) % side
        boids.update_spheres(keys, place, sight / 2)
        alignment.append(float(np.linalg.norm(speed.mean(axis=0))))
    return alignment


if __name__ == "__main__":
    found = flock()
    print("alignment went from %.2f to %.2f" % (found[0], found[-1]))
