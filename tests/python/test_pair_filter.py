"""Which bodies collide, contact offsets, and islands of contacts."""

import numpy as np
import pytest
import winnow
from hypothesis import given, settings
from hypothesis import strategies as st
from test_hostile import any_array, refused
from test_narrow import poses_at
from worlds import answered_or_refused

NULL = np.uint64(winnow.NULL_KEY)


@pytest.fixture
def row():
    """Returns ten balls of radius 0.5 in a row, each of which overlaps its neighbours."""
    shapes = winnow.Shapes()
    ball = int(shapes.add_spheres(0.5)[0])
    scene = winnow.Scene(shapes)
    keys = scene.add(ball, [[0.9 * i, 0, 0] for i in range(10)], data=np.arange(10))
    return shapes, scene, keys, ball


def touching(scene, level="boolean"):
    contacts = winnow.Contacts()
    scene.collide(contacts, level)
    return {tuple(sorted(p)) for p in zip(contacts.data_a.tolist(), contacts.data_b.tolist())}


NEIGHBOURS = {(i, i + 1) for i in range(9)}


def test_ignored_pairs_have_no_contacts(row):
    _, scene, keys, _ = row
    assert touching(scene) == NEIGHBOURS
    links = np.stack([keys[:4], keys[1:5]], axis=1)
    scene.set_ignored(links)
    assert touching(scene) == NEIGHBOURS - {(i, i + 1) for i in range(4)}
    assert scene.is_ignored(links[:, ::-1]).all()
    assert scene.is_ignored([[keys[5], keys[6]], [keys[5], NULL]]).tolist() == [False, False]
    scene.set_ignored(links[:2, ::-1], False)
    assert touching(scene) == NEIGHBOURS - {(2, 3), (3, 4)}
    refused("invalid_argument", scene.set_ignored, [[keys[5], keys[6]], [keys[7], keys[7]]])
    refused("invalid_key", scene.set_ignored, [[keys[5], keys[6]], [keys[7], NULL]])
    refused("size_mismatch", scene.set_ignored, keys)
    assert not scene.is_ignored([[keys[5], keys[6]]]).any()


def test_layers_collide_by_default(row):
    _, scene, keys, ball = row
    scene.set_layer(keys[::2], 4095)
    scene.set_layer(keys[1::2], np.arange(5) + 1000)
    assert touching(scene) == NEIGHBOURS
    scene.set_layers_collide([[4095, 1000], [1003, 4095]], False)
    assert scene.layers_collide([[1000, 4095], [1001, 4095], [7, 7]]).tolist() == [False, True, True]
    apart = {(0, 1), (1, 2), (6, 7), (7, 8)}
    assert touching(scene) == NEIGHBOURS - apart
    scene.set_layers_collide([[1000, 4095]])
    assert touching(scene) == NEIGHBOURS - {(6, 7), (7, 8)}
    assert scene.bodies(keys)["layer"].tolist()[:4] == [4095, 1000, 4095, 1001]
    extra = scene.add(ball, [[50, 0, 0]], layer=12)
    assert scene.bodies(extra)["layer"].tolist() == [12]
    refused("invalid_argument", scene.set_layer, keys, 4096)
    refused("invalid_argument", scene.set_layers_collide, [[0, 4096]])
    refused("invalid_key", scene.set_layer, np.append(keys[:1], NULL), [5, 6])
    refused("size_mismatch", scene.set_layer, keys, [1, 2])
    assert scene.bodies(keys[:1])["layer"].tolist() == [4095]


def test_contacts_begin_and_rest_at_offsets(row):
    shapes, scene, keys, ball = row
    scene.clear()
    keys = scene.add(ball, [[0, 0, 0], [1.3, 0, 0]], contact=[0.2, 0.15], rest=0.1, data=[0, 1])
    contacts = winnow.Contacts()
    scene.collide(contacts, "distance")
    assert contacts.distance.tolist() == pytest.approx([0.1])
    columns = scene.bodies(keys)
    assert columns["contact"].tolist() == [0.2, 0.15] and columns["rest"].tolist() == [0.1, 0.1]
    scene.set_offsets(keys, [0.0, 0.2], rest=[0.0, -0.1])
    assert touching(scene, "distance") == set()
    scene.move(keys[1:], [[1.15, 0, 0]])
    scene.collide(contacts, "distance")
    assert contacts.distance.tolist() == pytest.approx([0.25])
    for contact, rest in (([-1, 0], 0), (np.nan, 0), (0.1, 0.2), (np.inf, 0)):
        refused("invalid_argument", scene.set_offsets, keys, contact, rest)
    refused("invalid_argument", scene.set_offsets, keys, [0.3, 0.1], 0.2)
    assert scene.bodies(keys)["contact"].tolist() == [0.0, 0.2]
    refused("invalid_argument", scene.add, ball, [[9, 9, 9]], contact=-1.0)


def islands_of(pairs, movable):
    """Returns, for each pair, the number of its island, in the order of first pairs, by joining sets."""
    sets = {body: {body} for body in movable}
    for a, b in pairs:
        if a in sets and b in sets and sets[a] is not sets[b]:
            joined = sets[a] | sets[b]
            for body in joined:
                sets[body] = joined
    numbers, seen = [], []
    for a, b in pairs:
        own = sets[a if a in sets else b]
        if own not in seen:
            seen.append(own)
        numbers.append(seen.index(own))
    return numbers


def test_islands_and_colours_equal_a_reference():
    random = np.random.default_rng(91)
    shapes = winnow.Shapes()
    scene = winnow.Scene(shapes)
    state = np.where(np.arange(150) % 6 == 0, winnow.FIXED, winnow.DYNAMIC)
    keys = scene.add(
        shapes.add_spheres(0.5), random.uniform(0, 6, (150, 3)), state, data=np.arange(150)
    )
    contacts = winnow.Contacts()
    scene.collide(contacts, "distance")
    pairs = list(zip(contacts.data_a.tolist(), contacts.data_b.tolist()))
    movable = set(np.nonzero(state == winnow.DYNAMIC)[0].tolist())
    islands = scene.islands(contacts)
    assert islands.group.tolist() == islands_of(pairs, movable)
    assert islands.group.max() > 5
    colours = scene.colours(contacts)
    for groups in (islands, colours):
        for g in range(len(groups.first) - 1):
            own = groups.order[groups.first[g] : groups.first[g + 1]]
            assert len(own) and np.array_equal(own, np.nonzero(groups.group == g)[0])
    for g in range(len(colours.first) - 1):
        own = colours.order[colours.first[g] : colours.first[g + 1]]
        bodies = [body for i in own for body in pairs[i] if body in movable]
        assert g < winnow.REST_COLOUR and len(bodies) == len(set(bodies))
    scene.remove(keys[:1])
    refused("invalid_key", winnow.Scene(shapes).islands, contacts)


def test_contacts_have_their_places_in_the_last_frame():
    random = np.random.default_rng(92)
    shapes = winnow.Shapes()
    box = int(shapes.add_boxes([0.5, 0.5, 0.5])[0])
    scene = winnow.Scene(shapes, warm_start=True)
    scene.add(shapes.add_half_spaces([0, 0, 1]), [[0, 0, 0]], "fixed", data=[99])
    places = np.stack([np.arange(20) * 2.0, np.zeros(20), np.full(20, 0.49)], axis=1)
    keys = scene.add(box, places, data=np.arange(20))
    contacts = winnow.Contacts()
    scene.collide(contacts)
    assert (contacts.previous_pair == winnow.NO_CONTACT).all() and len(contacts) == 20
    before = contacts.data_a + contacts.data_b
    features = contacts.contact_feature.copy()
    lifted = random.permutation(20)[:5]
    places[lifted, 2] = 9
    scene.move(keys, places)
    scene.collide(contacts)
    now = contacts.data_a + contacts.data_b
    assert len(contacts) == 15 and np.array_equal(before[contacts.previous_pair], now)
    assert np.array_equal(features[contacts.previous_point], contacts.contact_feature)
    plain = winnow.Scene(shapes)
    plain.add(box, [[0, 0, 0], [0.5, 0, 0]])
    plain.collide(contacts)
    assert len(contacts) == 1 and len(contacts.previous_pair) == 0


def floor_of_tiles(**options):
    shapes = winnow.Shapes()
    scene = winnow.Scene(shapes, contact_margin=0.02, **options)
    x, y = np.meshgrid(np.arange(5.0), np.arange(5.0))
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(25)], axis=1)
    square = (np.arange(4)[:, None] * 5 + np.arange(4)).ravel()
    triangles = np.vstack(
        [np.stack([square, square + 1, square + 5], 1), np.stack([square + 1, square + 6, square + 5], 1)]
    )
    scene.add(shapes.add_mesh(vertices, triangles), [[0, 0, 0]], "fixed")
    scene.add(shapes.add_boxes([0.9, 0.9, 0.5]), [[2, 2, 0.495]])
    contacts = winnow.Contacts()
    scene.collide(contacts)
    return contacts


def test_contacts_have_one_manifold_for_each_region():
    raw, reduced = floor_of_tiles(part_manifolds=True), floor_of_tiles()
    assert len(raw) == len(reduced) == 1
    assert len(raw.distance) > 1 and len(reduced.distance) == 1
    assert len(reduced.contact_depth) == 4
    assert reduced.contact_depth == pytest.approx(0.005, abs=1e-5)


def test_seamless_floors_have_no_ghost_contacts():
    aslant = {}
    for seamless in (False, True):
        random = np.random.default_rng(94)
        shapes = winnow.Shapes()
        scene = winnow.Scene(shapes, contact_margin=0.03, suppress_ghost_contacts=seamless)
        tile = shapes.add_boxes([2, 2, 1])
        scene.add(tile, [[x, y, -1] for x in (-2, 2) for y in (-2, 2)], "fixed")
        slider = scene.add(shapes.add_boxes([0.5, 0.4, 0.3]), [[0, 0, 9]])
        contacts = winnow.Contacts()
        up = []
        for _ in range(60):
            yaw = random.uniform(-3, 3)
            place = [*random.uniform(-0.7, 0.7, 2), 0.3 + random.uniform(-0.02, 0.02)]
            scene.move(slider, [[*place, np.cos(yaw), 0, 0, np.sin(yaw)]])
            scene.collide(contacts)
            up += np.abs(contacts.normal[:, 2]).tolist()
        assert len(up) >= 60
        aslant[seamless] = sum(z < 0.99 for z in up)
    assert aslant[True] == 0 < aslant[False]


def test_reserved_scene_does_not_allocate(row):
    shapes, _, _, ball = row
    scene = winnow.Scene(shapes)
    contacts = winnow.Contacts()
    room = dict(dynamic=400, pairs=2000, touching=2000, manifolds=2000, points=2000)
    scene.reserve(contacts=contacts, touch=True, **room)
    before = scene.footprint()
    scene.add(ball, np.random.default_rng(93).uniform(0, 9, (400, 3)))
    scene.collide(contacts)
    assert 100 < len(contacts) < 2000
    assert all(scene.footprint()[part][1] == before[part][1] for part in before)
    with pytest.raises((MemoryError, winnow.StatusError)):
        scene.reserve(dynamic=2**40)
    refused("invalid_argument", scene.reserve, level="all")


def test_composite_shapes_list_their_parts():
    shapes = winnow.Shapes()
    ball = int(shapes.add_spheres(0.25)[0])
    field = shapes.add_height_field(np.zeros((3, 4), np.float32))
    poses = poses_at([0, 0, 0], [0, 0, 1])
    compound = shapes.add_compound([ball, field], poses)
    assert shapes.parts([field, compound]).tolist() == [12, 13]
    children, places = shapes.compound_children(compound)
    assert children.tolist() == [ball, field] and np.array_equal(places, poses)
    scene = winnow.Scene(shapes)
    scene.add(field, [[0, 0, 0]], "fixed")
    scene.add(ball, [[1.4, 1.2, -0.1]])
    contacts = winnow.Contacts()
    scene.collide(contacts)
    assert len(contacts) == 1
    shapes.set_one_sided([field])
    assert shapes.is_one_sided([field, compound]).tolist() == [True, False]
    scene.collide(contacts)
    assert len(contacts) == 0
    mesh = shapes.add_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    assert "entry 1" in refused("invalid_key", shapes.set_one_sided, [mesh, ball])
    assert shapes.is_one_sided([mesh]).tolist() == [False]
    refused("invalid_key", shapes.parts, [ball])
    refused("invalid_key", shapes.is_one_sided, [2**32 - 1])
    refused("invalid_key", shapes.compound_children, mesh)


def test_closed_mesh_can_be_solid():
    shapes = winnow.Shapes()
    corners = [[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
    faces = [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4],
             [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]]
    cube = shapes.add_mesh(corners, faces)
    open_box = shapes.add_mesh(corners, faces[1:])
    ball = int(shapes.add_spheres(0.25)[0])
    scene = winnow.Scene(shapes)
    body = scene.add(cube, [[5, 0, 0]])
    scene.refresh()
    assert len(scene.overlap([ball], poses_at([5, 0, 0])).key) == 0
    assert "entry 1" in refused("invalid_shape", shapes.set_solid, [cube, open_box])
    assert shapes.is_solid([cube, open_box]).tolist() == [False, False]
    shapes.set_solid([cube])
    assert shapes.is_solid([cube, open_box]).tolist() == [True, False]
    scene.refresh()
    assert scene.overlap([ball], poses_at([5, 0, 0])).key.tolist() == body.tolist()
    shapes.set_solid([cube], False)
    refused("invalid_key", shapes.set_solid, [ball])


@given(any_array(), any_array(), any_array(), st.integers(0, 2**32 - 1))
@settings(max_examples=100)
def test_any_arrays_are_accepted_or_refused(first, second, third, number):
    shapes = winnow.Shapes()
    ids = shapes.add_spheres([1.0, 2.0])
    scene = winnow.Scene(shapes)
    keys = scene.add(ids, np.zeros((2, 3)))
    answered_or_refused([
        lambda: scene.set_offsets(keys, first, second),
        lambda: scene.set_offsets(first, second, third),
        lambda: scene.set_layer(keys, first),
        lambda: scene.set_layer(first, number),
        lambda: scene.set_layers_collide(first, False),
        lambda: scene.layers_collide(first),
        lambda: scene.set_ignored(first),
        lambda: scene.is_ignored(first),
        lambda: scene.add(ids, np.zeros((2, 3)), contact=first, rest=second, layer=third),
        lambda: shapes.parts(first),
        lambda: shapes.is_one_sided(first),
        lambda: shapes.set_one_sided(first),
        lambda: shapes.is_solid(first),
        lambda: shapes.set_solid(first),
        lambda: shapes.compound_children(number),
        lambda: scene.collide(winnow.Contacts()),
    ])
