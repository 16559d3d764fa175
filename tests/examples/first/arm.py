"""A robot arm of capsules that checks itself: which links touch, except those that share a joint."""

import numpy as np
import winnow

LINKS = 7

shapes = winnow.Shapes()
arm = winnow.Scene(shapes)
links = arm.add(shapes.add_capsules(0.1, 0.5), np.zeros((LINKS, 3)))
arm.set_ignored(np.stack([links[:-1], links[1:]], axis=1))


def poses_of(configuration):
    """Returns poses of the links (n, 7); all joints turn about y."""
    angle = np.cumsum(2.5 * np.sin(0.37 * configuration * np.arange(1, LINKS + 1)))
    zero = np.zeros(LINKS)
    along = np.stack([np.sin(angle), zero, np.cos(angle)], axis=1)
    middle = np.cumsum(along, axis=0) - 0.5 * along
    turn = np.stack([np.cos(angle / 2), zero, np.sin(angle / 2), zero], axis=1)
    return np.hstack([middle, turn])


colliding = 0
for configuration in range(1000):
    arm.move(links, poses_of(configuration))
    colliding += len(arm.any_contact()) > 0

print("%d of 1000 configurations collide" % colliding)
assert 0 < colliding < 1000
