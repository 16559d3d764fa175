"""The package itself: documentation, signatures, types, copies, and what pip reads."""

import copy
import email.parser
import inspect
import os
import pathlib
import pickle
import re
import subprocess
import sys
import typing

import numpy as np
import pytest
import winnow
import winnow.types
from test_hostile import callables_of, refused

SOURCES = pathlib.Path(__file__).resolve().parents[2] / "pipeline" / "python"


def everything():
    """Yields the path and value of each public name of the package, and of the members of its classes."""
    for name in winnow.__all__:
        value = getattr(winnow, name)
        yield name, value
        if isinstance(value, type):
            for member, inside in vars(value).items():
                if not member.startswith("_") or member in ("__init__",):
                    yield name + "." + member, inside


def test_every_public_name_has_documentation():
    lacking = [
        name
        for name, value in everything()
        if (callable(value) or isinstance(value, (type, property))) and not inspect.getdoc(value)
    ]
    assert not lacking
    assert "(n, 3)" in winnow.Partition.insert.__doc__ and "key: " in winnow.Hits.__doc__


def test_every_call_has_a_signature():
    for name, value in everything():
        if callable(value) and not isinstance(value, type) and not name.split(".")[0] == "StatusError":
            assert inspect.signature(value) is not None, name
    assert str(inspect.signature(winnow.Partition.cast_rays)) == (
        "(self, origins, directions, find='closest', *, min_t=0.0, max_t=inf, filter=None)"
    )
    assert list(inspect.signature(winnow.Scene).parameters)[:2] == ["shapes", "contact_margin"]
    assert len(list(callables_of(winnow._core))) > 150


# Types of names, and a call with a name that does not exist.
NAMES = {
    "BodyState": lambda w: w.size("no"),
    "ContinuousPairs": lambda w: w.find_impacts([], np.empty((0, 3)), pairs="no"),
    "FeatureKind": lambda w: winnow.DeformableMesh().self_candidates("no"),
    "Find": lambda w: w.cast_rays([0, 0, 0], [1, 0, 0], "no"),
    "Level": lambda w: w.collide(winnow.Contacts(), "no"),
    "NearDepth": lambda w: winnow.frusta_of(np.eye(4), "no"),
    "Order": lambda w: winnow.Partition().self_pairs(order="no"),
    "Rules": lambda w: w.distance([], [], rules="no"),
    "Structure": lambda w: winnow.Partition("no"),
    "Tier": lambda w: winnow.Scene(winnow.Shapes(), tier="no"),
    "Volume": lambda w: winnow.Partition(volume="no"),
}


@pytest.mark.parametrize("name", NAMES)
def test_types_list_the_names_of_the_library(name):
    text = refused("invalid_argument", NAMES[name], winnow.Scene(winnow.Shapes()))
    known = text.split(" is none of ")[1].split(", ")
    assert sorted(known) == sorted(typing.get_args(getattr(winnow.types, name)))


def test_types_of_status_and_instruction_sets_are_complete():
    core = SOURCES.parents[1] / "core"
    names = re.search(r"enum class \[\[nodiscard\]\] Status.*?\{(.*?)\};", (core / "status.h").read_text(), re.S)[1]
    known = re.findall(r"^ +(\w+),$", names, re.M)
    assert known == list(typing.get_args(winnow.types.Status))
    assert {*winnow.available_isas()} <= {*typing.get_args(winnow.types.Isa)}


def partition():
    made = winnow.Partition("SweepAndPrune", volume="sphere", fat_margin=0.25)
    made.insert_spheres([[0, 0, 0], [1, 0, 0], [9, 9, 9]], 0.75, data=[7, 8, 9])
    return made


def scene():
    shapes = winnow.Shapes()
    made = winnow.Scene(shapes, contact_margin=0.5)
    made.add(shapes.add_boxes([1, 1, 1]), [[0, 0, 0], [2.25, 0, 0]], data=[1, 2])
    return made


def contacts_of(made):
    contacts = winnow.Contacts()
    made.collide(contacts)
    return contacts


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))])
def test_copies_continue_like_the_original(copied):
    again = copied(partition())
    assert repr(again) == repr(partition()) and again.fat_margin == partition().fat_margin
    assert again.self_pairs().tolist() == [[0, 1]] and again.client_data_of([2]).tolist() == [9]
    other = copied(scene())
    bodies = other.bodies(other.keys_of([0, 1]))
    assert bodies["data"].tolist() == [1, 2] and other.shapes.contains(bodies["shape"]).all()
    assert contacts_of(other).distance.tolist() == contacts_of(scene()).distance.tolist() == [0.25]
    hits = partition().cast_rays([-9, 0, 0], [1, 0, 0])
    assert copied(hits).t.tolist() == hits.t.tolist()


def test_scenes_of_one_pickle_share_their_shapes():
    first = scene()
    second = winnow.Scene(first.shapes)
    one, two, shapes = pickle.loads(pickle.dumps((first, second, first.shapes)))
    assert one.shapes is two.shapes is shapes


TEXTS = [
    (partition, "Partition(len=3, structure='SweepAndPrune', volume='sphere')"),
    (scene, "Scene(len=2, origin=(0.0, 0.0, 0.0))"),
    (winnow.Shapes, "Shapes()"),
    (winnow.Filter, "Filter(layers=4294967295, mask=4294967295, environment=4294967295, layer=None, accept=None)"),
    (winnow.Contacts, "Contacts(len=0, level='pairs')"),
    (winnow.PairEvents, "PairEvents(persisting=0)"),
    (winnow.NarrowPhase, "NarrowPhase()"),
    (winnow.DeformableMesh, "DeformableMesh(vertices=0, triangles=0)"),
    (lambda: winnow.Sensors(scene()), "Sensors(len=0)"),
    (winnow.Cluster, "Cluster(ranks=1, hosted=(0, 1))"),
    (lambda: winnow.ClusterScene(winnow.Shapes(), ranks=2), "ClusterScene(ranks=2, hosted=(0, 2))"),
    (lambda: partition().cast_rays([0, 0, 9], [1, 0, 0]), "Hits(key=uint64[1], data=uint64[1], t=float32[1])"),
    (lambda: contacts_of(scene()).normal, "array([[1., 0., 0.]])"),
]


@pytest.mark.parametrize("make, text", TEXTS, ids=lambda x: x if isinstance(x, str) else "")
def test_objects_show_what_they_hold(make, text):
    assert repr(make()) == text


def test_tables_do_not_change():
    hits = partition().cast_rays([0, 0, 9], [1, 0, 0])
    with pytest.raises(AttributeError):
        hits.t = np.zeros(1)
    with pytest.raises(TypeError):
        winnow.Hits(hits.t)


def backend(code, **environment):
    """Returns what the build backend prints."""
    run = subprocess.run(
        [sys.executable, "-B", "-c", "import backend, sys\n" + code], cwd=SOURCES, check=True,
        capture_output=True, text=True, env={**os.environ, **environment},
    )  # fmt: skip
    return run.stdout


def test_metadata_are_those_of_the_project():
    text = backend("print(backend.metadata())", WINNOW_REPOSITORY="https://example.org/winnow")
    fields = email.parser.Parser().parsestr(text)
    assert fields["Name"] == "winnow" and fields["Version"] == winnow.__version__
    assert fields["Author"] == "The winnow authors" and fields["License"] == "MIT"
    assert fields["Project-URL"] == "Repository, https://example.org/winnow"
    assert "Typing :: Typed" in fields.get_all("Classifier")
    assert fields["Requires-Dist"] == "numpy" and fields["Requires-Python"] == ">=3.9"
    assert fields.get_payload().startswith("# winnow for Python")


@pytest.mark.parametrize(
    "environment, lacks",
    [
        ({"WINNOW_PYTHON_OPTIONS": ""}, "[]"),
        (
            {"WINNOW_PYTHON_OPTIONS": "-DCMAKE_DISABLE_FIND_PACKAGE_TBB=ON -DCMAKE_DISABLE_FIND_PACKAGE_Eigen3=ON "
                                      "-DCMAKE_DISABLE_FIND_PACKAGE_pybind11=ON"},
            "['libeigen3-dev', 'libtbb-dev', 'pybind11-dev']",
        ),
        ({"PATH": "/none", "CXX": "none"}, "['cmake', 'ninja-build', 'g++']"),
    ],
)  # fmt: skip
def test_missing_packages_are_named_before_the_build(environment, lacks):
    assert backend("print(backend.missing()[0])", **environment).strip() == lacks


def test_stubs_with_other_arguments_are_refused(tmp_path):
    stub = tmp_path / "stub.pyi"
    stub.write_text('class A:\n    def f(self, x: int = 1, *, y: "A") -> int:\n        """Adds `x`."""\n')
    run = [sys.executable, str(SOURCES / "describe"), str(stub)]
    table = subprocess.run(run, check=True, capture_output=True, text=True).stdout
    assert '{"x", "1", true}, {"*", nullptr, true}, {"y", nullptr, false}' in table
    assert re.search(r'"A\.f", "f\(self, x=1, \*, y\)\\n"\s+"--\\n"\s+"\\n"\s+"Adds `x`\."', table)
