"""Python's defaults equal the defaults of C++ and C, which a program prints as a table."""

import ast
import inspect
import os
import re
import subprocess

import pytest
import winnow

FILTER = {"layers": "layers", "mask": "mask", "environment": "environment"}
DRAWING = dict.fromkeys(("objects", "structure", "labels", "max_depth"))
CONTINUOUS = dict.fromkeys(("pairs", "tolerance", "touching", "first_only"))
FEATURES = dict.fromkeys(("min_separation", "tolerance", "max_intervals"))

# Function, C++ struct, and its members by the names of arguments; None stands for an equal name.
# The options for parallel execution are left out: Python has another default, because its arrays
# are long and the results are equal.
SAME = [
    ("Partition.__init__", "PartitionOptions",
     {"volume": None, "fat_margin": None, "fat_margin_share": None, "build_budget": None}),
    ("Partition.set_filter", "ObjectFilter", FILTER),
    ("Partition.self_pairs", "PairOptions", {"order": None, "incremental": None}),
    ("Partition.pairs_with", "PairOptions", {"order": None}),
    ("Partition.debug_draw", "DebugDrawOptions", DRAWING),
    ("Partition.cast_rays", "Ray", {"min_t": None, "max_t": None}),
    ("Partition.cast_boxes", "Ray", {"min_t": None, "max_t": None}),
    ("Partition.cast_spheres", "Ray", {"min_t": None, "max_t": None}),
    ("Partition.cast_capsules", "Ray", {"min_t": None, "max_t": None}),
    ("PairEvents.__init__", "PairEventsOptions", {"client_data": None}),
    ("Filter.__init__", "Filter", FILTER),
    ("Scene.__init__", "SceneOptions",
     dict.fromkeys(("contact_margin", "tier", "cache_tolerance", "part_manifolds", "suppress_ghost_contacts",
                    "warm_start", "build_budget"))),
    ("Scene.add", "BodyDefinition",
     {"state": None, "contact": None, "rest": None, "layer": None, **FILTER}),
    ("Scene.set_filter", "ObjectFilter", FILTER),
    ("Scene.reserve", "SceneCapacity",
     dict.fromkeys(("pairs", "level", "touching", "manifolds", "points"))),
    ("Scene.debug_draw", "DebugDrawOptions", DRAWING),
    ("Scene.cast_rays", "ShapeRay", {"max_t": None}),
    ("Scene.cast_shapes", "ShapeCast", {"max_t": None, "touching": None}),
    ("Scene.cast_motions", "MotionCast", {"touching": None}),
    ("Scene.cast_shapes", None, {"tolerance": "WINNOW_CAST_TOLERANCE"}),
    ("Scene.cast_motions", None, {"tolerance": "WINNOW_CAST_TOLERANCE"}),
    ("Scene.find_impacts", "ContinuousOptions", CONTINUOUS),
    ("Scene.find_impacts_of_motions", "ContinuousOptions", CONTINUOUS),
    ("Sensors.add", "SensorDefinition", FILTER),
    ("Shapes.cast_rays", "ShapeRay", {"max_t": None}),
    ("Shapes.add_mesh", "MeshOptions", {"active_edge_angle": None}),
    ("Shapes.add_height_field", "HeightSamples", {"spacing": None}),
    ("NarrowPhase.collide", "NarrowOptions", {"level": None, "tier": None, "contact_margin": None}),
    ("time_of_impact", "ImpactOptions", {"tolerance": None}),
    ("DeformableMesh.__init__", "DeformableMeshOptions", {"origin": None}),
    ("DeformableMesh.self_impacts", "FeatureImpactOptions", FEATURES),
    ("DeformableMesh.impacts_with", "FeatureImpactOptions", FEATURES),
    ("DeformableMesh.impacts_with_shape", "ImpactOptions", {"tolerance": None}),
    ("feature_impacts", "FeatureImpactOptions", FEATURES),
    ("ClusterScene.__init__", "ClusterSceneOptions.scene",
     {"contact_margin": None, "tier": None, "part_manifolds": None}),
    ("ClusterScene.__init__", "ClusterSceneOptions", {"imbalance": None}),
    ("Cluster.__init__", "ClusterOptions", {"imbalance": None}),
]


def value(text):
    """Returns the value of a literal, or of inf and nan."""
    literal = ast.literal_eval(re.sub(r"\binf\b", "1e999", text.strip()))
    return tuple(literal) if isinstance(literal, list) else literal


def python_defaults(name):
    """Returns the arguments with defaults; None if there is no such function."""
    function = winnow
    for part in name.split("."):
        function = getattr(function, part, None)
    return function and {
        parameter.name: parameter.default
        for parameter in inspect.signature(function).parameters.values()
        if parameter.default is not parameter.empty
    }


@pytest.fixture(scope="module")
def table():
    completed = subprocess.run([os.environ["WINNOW_DEFAULTS"]], capture_output=True, text=True)
    assert completed.returncode == 0, completed.stderr
    return dict(line.split(" = ", 1) for line in completed.stdout.splitlines())


@pytest.mark.parametrize("function, struct, names", SAME, ids=lambda x: x if isinstance(x, str) else "")
def test_defaults_equal_cpp_and_c(table, function, struct, names):
    own = python_defaults(function)
    if own is None and function.startswith("Cluster"):
        pytest.skip("built without clusters")
    for argument, member in names.items():
        row = (struct + "." if struct else "") + (member or argument)
        assert own[argument] == value(table[row]), function + ": " + argument


def test_structures_equal_cpp_and_c(table):
    names = list(python_defaults("Scene.__init__")["structures"])
    of_cpp = table["SceneOptions.structures"]
    assert re.findall(r"'(\w+)'", of_cpp) == names
