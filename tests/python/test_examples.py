"""The examples run and show the effect that they are about."""

import os
import runpy
import sys

import numpy as np
import pytest

sys.path.insert(
    0, os.path.join(os.path.dirname(__file__), "..", "..", "pipeline", "python", "examples")
)

import boids  # noqa: E402
import culling  # noqa: E402
import granular_flow  # noqa: E402
import lidar  # noqa: E402
import robot_self_collision  # noqa: E402


@pytest.mark.parametrize("name", ["spheres", "boxes", "meshes", "arm"])
def test_first_program_runs(name, monkeypatch):
    monkeypatch.setattr(sys, "argv", [name])
    runpy.run_path(os.path.join(os.path.dirname(__file__), "..", "examples", "first", name + ".py"))


def test_boids_align():
    alignment = boids.flock(500, 30)
    assert alignment[-1] > 3 * alignment[0]


def test_camera_sees_part_of_the_world():
    for seen, inside in culling.walk(5000):
        assert 0 < inside < seen < 5000


def test_lidar_hits_ground_and_boxes():
    points, kinds = lidar.scan()
    assert len(points) > 500 and 0 < kinds.sum() < len(kinds)
    assert np.abs(points).max() < 70


def test_grains_leave_the_funnel():
    left, depth = granular_flow.flow(steps=600)
    assert left > 0 and depth < 0.1


def test_folded_arms_collide():
    straight, folded = np.zeros(5), np.array([0, 0, 3.0, 0.1, 0])
    assert robot_self_collision.collides(np.array([straight, folded])).tolist() == [False, True]
