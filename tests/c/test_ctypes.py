"""The C interface as another language calls it: through Python's ctypes, from the shared library only.

Usage: test_ctypes.py LIBRARY INCLUDE [arguments of unittest]
"""

import ctypes
import pathlib
import re
import subprocess
import sys
import unittest
from ctypes import POINTER, byref, c_char_p, c_float, c_int32, c_size_t, c_uint32, c_uint64, c_void_p

OK, INVALID_KEY, INVALID_ARGUMENT = 0, 2, 3


class Key(ctypes.Structure):
    _fields_ = [("id", c_uint32), ("stamp", c_uint32)]


class Pair(ctypes.Structure):
    _fields_ = [("first", c_uint32), ("second", c_uint32)]


class StructureKind(ctypes.Structure):
    _fields_ = [("structure", c_int32), ("parameter", c_float)]


class BoxView(ctypes.Structure):
    _fields_ = [("min", c_void_p * 3), ("max", c_void_p * 3), ("stride", c_size_t),
                ("count", c_size_t), ("number", c_int32)]


class Filter(ctypes.Structure):
    Accept = ctypes.CFUNCTYPE(ctypes.c_bool, c_void_p, Key, c_uint64)
    _fields_ = [("layers", c_uint32), ("mask", c_uint32), ("environment", c_uint32),
                ("accept", Accept), ("context", c_void_p)]


class Aabb(ctypes.Structure):
    _fields_ = [("min", c_float * 3), ("max", c_float * 3)]


class Hit(ctypes.Structure):
    _fields_ = [("key", Key), ("data", c_uint64), ("t", c_float)]


STRUCTS = {"key": Key, "pair": Pair, "structure_kind": StructureKind, "box_view": BoxView,
           "filter": Filter, "aabb": Aabb, "hit": Hit}


def declared_calls(include):
    """Returns (result type, name, arguments) of each call in the headers."""
    text = "".join(path.read_text() for path in sorted((include / "winnow/c").glob("*.h")))
    # In a build tree each header includes the real one in one line.
    for path in re.findall(r'^#include "(.*)"$', text, re.M):
        text += pathlib.Path(path).read_text()
    calls = re.findall(r"^WINNOW_C_API ([^;{]*?)\b(winnow_\w+)\(([^;]*)\);", text, re.M)
    return [(answer.strip(), name, arguments) for answer, name, arguments in calls]


class CInterface(unittest.TestCase):
    library: ctypes.CDLL
    include: pathlib.Path

    def ok(self, status):
        self.assertEqual(status, OK, self.library.winnow_status_name(status))

    def partition(self, count):
        """Returns a row of boxes, each of which touches the next, and their keys."""
        partition = c_void_p()
        self.ok(self.library.winnow_partition_create(StructureKind(0, 0.0), None, byref(partition)))
        lows = (ctypes.c_double * count)(*[float(i) for i in range(count)])
        highs = (ctypes.c_double * count)(*[i + 1.0 for i in range(count)])
        low, high = ctypes.addressof(lows), ctypes.addressof(highs)
        view = BoxView((low, low, low), (high, high, high), 0, count, 1)
        data = (c_uint64 * count)(*[10 * i for i in range(count)])
        keys = (Key * count)()
        self.ok(self.library.winnow_partition_insert(partition, byref(view), data, keys))
        return partition, keys

    def test_structs_have_the_layout_of_the_headers(self):
        program = "#include <stdio.h>\n#include <winnow/c/winnow.h>\nint main(void) {\n"
        for name, struct in STRUCTS.items():
            for field, _ in struct._fields_:
                program += f'printf("%zu\\n", offsetof(winnow_{name}, {field}));\n'
            program += f'printf("%zu\\n", sizeof(winnow_{name}));\n'
        compiled = pathlib.Path(self.work, "layout")
        subprocess.run(["cc", "-std=c99", "-x", "c", "-", "-I", self.include, "-o", compiled],
                       input=program + "return 0; }\n", text=True, check=True)
        printed = [int(word) for word in subprocess.check_output([compiled]).split()]
        own = []
        for struct in STRUCTS.values():
            own += [getattr(struct, field).offset for field, _ in struct._fields_]
            own.append(ctypes.sizeof(struct))
        self.assertEqual(printed, own)

    def test_pairs_and_hits_are_read_without_a_copy(self):
        partition, keys = self.partition(50)
        pairs = c_void_p()
        self.ok(self.library.winnow_pair_buffer_create(None, byref(pairs)))
        self.ok(self.library.winnow_partition_self_pairs(partition, pairs, None, None))
        first, count = POINTER(Pair)(), c_size_t()
        self.ok(self.library.winnow_pair_buffer_pairs(pairs, byref(first), byref(count)))
        found = {(first[i].first, first[i].second) for i in range(count.value)}
        self.assertEqual(found, {(i, i + 1) for i in range(49)})

        hits, nearest = c_void_p(), POINTER(Hit)()
        self.ok(self.library.winnow_hit_buffer_create(None, byref(hits)))
        is_odd = Filter.Accept(lambda context, key, data: key.id % 2 == 1)
        odd = Filter(0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF, is_odd, None)
        origin = Aabb((c_float * 3)(), (c_float * 3)())
        self.ok(self.library.winnow_partition_nearest(partition, byref(origin), c_size_t(3),
                                                      c_float(100.0), byref(odd), hits))
        self.ok(self.library.winnow_hit_buffer_hits(hits, byref(nearest), byref(count)))
        self.assertEqual([nearest[i].data for i in range(count.value)], [10, 30, 50])
        self.ok(self.library.winnow_partition_remove(partition, keys, c_size_t(50)))
        self.assertEqual(self.library.winnow_partition_remove(partition, keys, c_size_t(50)),
                         INVALID_KEY)
        self.library.winnow_hit_buffer_destroy(hits)
        self.library.winnow_pair_buffer_destroy(pairs)
        self.library.winnow_partition_destroy(partition)

    def test_calls_without_arguments_are_refused(self):
        calls = declared_calls(self.include)
        self.assertGreater(len(calls), 100)
        by_value = {"winnow_key": Key(), "winnow_structure_kind": StructureKind()}
        for answer, name, arguments in calls:
            if answer != "winnow_status":
                continue
            nothing = []
            for argument in arguments.split(","):
                kind = argument.replace("const ", "").split()[0]
                if "*" in argument or "[" in argument:
                    nothing.append(None)
                elif kind in ("float", "double"):
                    nothing.append(getattr(ctypes, "c_" + kind)(0.0))
                else:
                    nothing.append(by_value.get(kind, c_size_t(0)))
            self.assertEqual(getattr(self.library, name)(*nothing), INVALID_ARGUMENT, name)

    def test_versions_match_their_names(self):
        major, minor, patch = self.library.winnow_version_name().decode().split(".")
        self.assertEqual(self.library.winnow_version(),
                         int(major) << 16 | int(minor) << 8 | int(patch))
        self.assertEqual(self.library.winnow_abi(), 1)
        self.assertIn(self.library.winnow_isa_name().decode(), ("sse42", "avx2", "avx512", "neon64"))


def main():
    import tempfile

    library = ctypes.CDLL(sys.argv[1])
    for name in ("winnow_status_name", "winnow_version_name", "winnow_isa_name"):
        getattr(library, name).restype = c_char_p
    library.winnow_version.restype = library.winnow_abi.restype = c_uint32
    CInterface.library = library
    CInterface.include = pathlib.Path(sys.argv[2])
    with tempfile.TemporaryDirectory() as work:
        CInterface.work = work
        unittest.main(argv=[sys.argv[0], *sys.argv[3:]])


if __name__ == "__main__":
    main()
