"""Robot self-collision: tests many poses of an arm of capsules at once, each in its own
environment. Links that share a joint are not tested against each other."""

import numpy as np
import winnow

LENGTH, RADIUS = 1.0, 0.15


def arm_poses(angles):
    """Returns poses of the links, (poses, links, 7), from angles about y between links."""
    count, links = angles.shape
    turned = np.cumsum(angles, axis=1)
    along = np.stack([np.sin(turned), np.zeros_like(turned), np.cos(turned)], axis=2)
    joints = np.concatenate([np.zeros((count, 1, 3)), np.cumsum(LENGTH * along, axis=1)], axis=1)
    poses = np.zeros((count, links, 7))
    poses[:, :, :3] = (joints[:, 1:] + joints[:, :-1]) / 2
    poses[:, :, 3] = np.cos(turned / 2)
    poses[:, :, 5] = np.sin(turned / 2)
    return poses


def collides(angles):
    """Returns (n,) bool: whether links collide in each pose (n, links), in radians."""
    count, links = angles.shape
    # [scene]
    shapes = winnow.Shapes()
    link = shapes.add_capsules(RADIUS, LENGTH / 2)
    arm = winnow.Scene(shapes)
    number = np.arange(count * links)
    arm.add(link, arm_poses(angles).reshape(-1, 7), environment=number // links, data=number)
    contacts = winnow.Contacts()
    arm.collide(contacts, "boolean")
    a, b = contacts.data_a.astype(int), contacts.data_b.astype(int)
    hit = np.zeros(count, bool)
    hit[a[np.abs(a - b) > 1] // links] = True
    # [end]
    return hit


if __name__ == "__main__":
    sample = np.random.default_rng(4).uniform(-2.5, 2.5, (1000, 7))
    print("%d of 1000 poses collide" % collides(sample).sum())
