"""Pretty printers of winnow's public types for gdb: `source winnow_gdb.py`.

They only read memory and call nothing, so they also work on core dumps. The content of a Partition
and a Scene is shown if winnow itself was built with debug information.
"""

import gdb
import gdb.printing


def number(value):
    """The shortest decimal form."""
    return "%g" % float(value)


def numbers(values):
    return "(" + ", ".join(number(value) for value in values) + ")"


def vector(value, count=3):
    """The coordinates of a Vec3f or Vec3d."""
    array = value["at_"]
    return [array[i] for i in range(count)]


def column(value):
    """The elements of a Column."""
    data = value["data_"]
    return (data[i] for i in range(int(value["size_"])))


def box_text(low, high):
    low = [float(x) for x in low]
    high = [float(x) for x in high]
    if any(a > b for a, b in zip(low, high)):
        return "empty box"
    return numbers(low) + " to " + numbers(high)


class Text:
    """A value that is one line."""

    def __init__(self, value):
        self.value = value

    def to_string(self):
        return self.text(self.value)


class List(Text):
    """A value that has elements."""

    def display_hint(self):
        return "array"

    def children(self):
        for i, element in enumerate(self.elements(self.value)):
            yield "[%d]" % i, element


class Vec3(Text):
    def text(self, v):
        return numbers(vector(v))


class Aabb(Text):
    def text(self, box):
        return box_text(vector(box["min"]), vector(box["max"]))


class Sphere(Text):
    def text(self, ball):
        return "%s radius %s" % (numbers(vector(ball["center"])), number(ball["radius"]))


class Ray(Text):
    def text(self, ray):
        return "from %s along %s, t %s to %s" % (
            numbers(vector(ray["origin"])), numbers(vector(ray["direction"])),
            number(ray["min_t"]), number(ray["max_t"]))


class Key(Text):
    def text(self, key):
        if int(key["id"]) == 0xFFFFFFFF:
            return "null key"
        return "object %d, stamp %d" % (int(key["id"]), int(key["stamp"]))


class Pair(Text):
    def text(self, pair):
        return "%s, %s" % (pair["first"], pair["second"])


class Pose(Text):
    def text(self, pose):
        place = numbers(pose["position"]["at_"][i] for i in range(3))
        turn = [pose["orientation"]["at_"][i] for i in range(4)]
        if [float(q) for q in turn] == [1.0, 0.0, 0.0, 0.0]:
            return "at " + place
        return "at %s turned %s" % (place, numbers(turn))


class ShapeId(Text):
    def text(self, shape):
        bits = int(shape["bits"])
        for kinds in ("winnow::ShapeKind", "winnow::CompositeKind"):
            for kind in gdb.lookup_type(kinds).fields():
                if kind.enumval == bits >> 28:
                    return "%s %d" % (kind.name.split("::")[-1], bits & 0xFFFFFFF)
        return "no shape"


class Column(List):
    def text(self, value):
        return "%d of %d" % (int(value["size_"]), int(value["capacity_"]))

    def elements(self, value):
        return column(value)


def at(pointer, index, stride):
    """Element `index` of elements that are `stride` bytes apart."""
    address = int(pointer) + index * stride
    return gdb.Value(address).cast(pointer.type).dereference()


def array_of(value):
    """The elements of a std::array."""
    return [value["_M_elems"][i] for i in range(int(value.type.template_argument(1)))]


class BoxView(List):
    def text(self, view):
        return "%d boxes, %d bytes apart" % (int(view["count"]), int(view["stride"]))

    def elements(self, view):
        stride = int(view["stride"])
        for i in range(int(view["count"])):
            yield box_text([at(p, i, stride) for p in array_of(view["min"])],
                           [at(p, i, stride) for p in array_of(view["max"])])


class PoseView(List):
    def text(self, view):
        return "%d poses" % int(view["count"])

    def elements(self, view):
        stride = int(view["position_stride"])
        for i in range(int(view["count"])):
            yield "at " + numbers(at(p, i, stride) for p in array_of(view["position"]))


class PairBuffer(List):
    def text(self, buffer):
        return "%d pairs" % int(buffer["rows_"]["size_"])

    def elements(self, buffer):
        return column(buffer["rows_"])


class PairEvents(Text):
    def text(self, events):
        return "%d begun, %d ended, %d persisting" % (
            int(events["begun_"]["size_"]), int(events["ended_"]["size_"]),
            int(events["persisting_"]))

    def children(self):
        for name in ("begun", "ended"):
            yield name, self.value[name + "_"]


class HitBuffer(List):
    def text(self, buffer):
        return "%d hits" % int(buffer["rows_"]["size_"])

    def elements(self, buffer):
        return column(buffer["rows_"])


class OverlapBuffer(List):
    def text(self, buffer):
        return "%d objects, the first %d inside" % (
            int(buffer["rows_"]["size_"]), int(buffer["inside_"]))

    def elements(self, buffer):
        return column(buffer["rows_"])


def objects_of(state):
    """The number of objects in a partition's state."""
    return int(state["rows"]["keys_"]["live_"])


def structure_of(state):
    info = state["structure"]["info_"].dereference()
    return info["name"]["_M_str"].string(length=int(info["name"]["_M_len"]))


def held_by(value):
    """The state behind a class's pointer; None if gdb has no debug information about it."""
    state = value["state_"].dereference()
    return state if state.type.strip_typedefs().sizeof else None


class Partition(Text):
    def text(self, partition):
        if int(partition["state_"]) == 0:
            return "no partition"
        state = held_by(partition)
        if state is None:
            return "a partition"
        return "%s, %d objects" % (structure_of(state), objects_of(state))


class Scene(Text):
    def text(self, scene):
        if int(scene["state_"]) == 0:
            return "no scene"
        state = held_by(scene)
        if state is None:
            return "a scene"
        return "%d bodies" % int(state["keys"]["live_"])


class Contacts(Text):
    def text(self, contacts):
        if int(contacts["state_"]) == 0:
            return "no contacts"
        state = held_by(contacts)
        if state is None:
            return "contacts"
        return "%d pairs" % int(state["frame"]["event"]["size_"])


def printers():
    collection = gdb.printing.RegexpCollectionPrettyPrinter("winnow")
    plain = [Aabb, Sphere, Ray, Key, Pair, Pose, ShapeId, BoxView, PoseView, PairBuffer, PairEvents,
             HitBuffer, OverlapBuffer, Partition, Scene, Contacts]
    for printer in plain:
        collection.add_printer(printer.__name__, "^winnow::%s$" % printer.__name__, printer)
    collection.add_printer("Vec3", "^winnow::BasicVec3<.*>$", Vec3)
    collection.add_printer("KeyPair", "^winnow::KeyPair$", Pair)
    collection.add_printer("Column", "^winnow::Column<.*>$", Column)
    return collection


gdb.printing.register_pretty_printer(gdb.current_objfile(), printers(), replace=True)
