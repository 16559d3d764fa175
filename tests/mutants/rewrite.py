"""Puts mutants into the sources of a copy of the tree: rewrite.py TREE COMPILE_COMMANDS COUNT SEED OUT [GROUPS].

A mutant is a small change of one expression or statement. All of them are compiled into one program, and
the environment variable WINNOW_MUTANT selects the one that runs: `a < b` becomes
`(winnow_mutants::is(17) ? (a) <= (b) : (a) < (b))`. COUNT mutants of each group of targets.txt are drawn
with SEED, no two of which overlap; 0 takes all that do not overlap. The mutants of a group do not depend on
other groups, and a smaller COUNT draws the first ones of a larger COUNT. GROUPS, a regular expression,
selects groups. Writes the list of mutants to OUT as JSON.
"""

import itertools
import json
import pathlib
import random
import re
import sys

import clang.cindex
from clang.cindex import CursorKind, TokenKind

OTHER = {
    "<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==",
    "+": "-", "-": "+", "*": "+", "/": "*", "&&": "||", "||": "&&",
    "&": "|", "|": "&", "+=": "-=", "-=": "+=", "|=": "&=", "&=": "|=", "<<": ">>", ">>": "<<",
}
# Warnings about the mutants, which are odd on purpose.
QUIET = "".join(f'#pragma GCC diagnostic ignored "-W{name}"\n' for name in (
    "conversion", "sign-conversion", "float-conversion", "parentheses", "unused-value", "type-limits",
    "sign-compare", "bool-operation", "int-in-bool-context", "shift-count-overflow", "duplicated-cond"))
# Statements that can be removed.
REMOVABLE = {
    CursorKind.CALL_EXPR, CursorKind.BINARY_OPERATOR, CursorKind.COMPOUND_ASSIGNMENT_OPERATOR,
    CursorKind.UNARY_OPERATOR, CursorKind.CONTINUE_STMT,
}
# clang wraps expressions with temporaries in a cursor that has no name in this interface.
WRAPPED = {CursorKind.UNEXPOSED_EXPR}
LITERALS = {CursorKind.INTEGER_LITERAL, CursorKind.FLOATING_LITERAL}
DECLARATIONS = {CursorKind.VAR_DECL, CursorKind.PARM_DECL, CursorKind.FIELD_DECL}
# Functions whose calls change only the run time: mutants of these calls would survive.
HINTS = {"__builtin_prefetch"}


class Source:
    """One source file, and the mutants that are possible in it."""

    def __init__(self, tree, path, arguments):
        self.path = path
        self.bytes = (tree / path).read_bytes()
        index = clang.cindex.Index.create()
        self.unit = index.parse(str(tree / path), args=arguments)
        self.name = str(tree / path)
        self.points = []
        for cursor in self.unit.cursor.get_children():
            if cursor.location.file and cursor.location.file.name == self.name:
                self.visit(cursor)

    def text(self, start, end):
        return self.bytes[start:end].decode()

    def span(self, cursor):
        """Returns begin and end as offsets; None for text that is not written in this file verbatim."""
        start, end = cursor.extent.start, cursor.extent.end
        if not start.file or start.file.name != self.name or end.file.name != self.name:
            return None
        return (start.offset, end.offset) if start.offset < end.offset else None

    def add(self, start, end, text, what):
        line = self.bytes[:start].count(b"\n") + 1
        self.points.append({"file": str(self.path), "line": line, "start": start, "end": end,
                            "text": text, "was": self.text(start, end), "what": what,
                            "place": self.place(start, end)})

    def place(self, start, end):
        """Returns the line of the change, with the changed part between « and »: a mere
        number or name occurs in many places of a file."""
        first = self.bytes.rfind(b"\n", 0, start) + 1
        last = self.bytes.find(b"\n", end)
        around = (self.text(first, start), "«", self.text(start, end), "»", self.text(end, last))
        return " ".join("".join(around).split())

    def visit(self, cursor):
        if cursor.kind in (CursorKind.STATIC_ASSERT, CursorKind.ENUM_DECL) or self.is_constant(cursor):
            return
        if cursor.kind is CursorKind.CALL_EXPR and cursor.spelling in HINTS:
            return
        if cursor.kind in (CursorKind.BINARY_OPERATOR, CursorKind.COMPOUND_ASSIGNMENT_OPERATOR):
            self.visit_operator(cursor)
        elif cursor.kind in LITERALS:
            self.visit_literal(cursor)
        elif cursor.kind is CursorKind.COMPOUND_STMT:
            for statement in cursor.get_children():
                self.visit_statement(statement)
        elif cursor.kind is CursorKind.IF_STMT:
            self.visit_condition(cursor)
        for child in list(cursor.get_children())[self.is_decided_early(cursor):]:
            if not (cursor.kind in DECLARATIONS and self.is_in_type(child)):
                self.visit(child)

    def is_decided_early(self, cursor):
        """Returns how many of its parts, from the first on, are constant expressions."""
        if cursor.kind is not CursorKind.IF_STMT:
            return 0
        words = [token.spelling for token, _ in zip(cursor.get_tokens(), range(2))]
        return 1 if words == ["if", "constexpr"] else 0

    def is_in_type(self, cursor):
        """Returns whether this is an array size, which is a constant expression."""
        place = self.span(cursor)
        return (place is not None and self.bytes[: place[0]].rstrip().endswith((b"[", b","))
                and self.bytes[place[1] :].lstrip().startswith((b"]", b">")))

    def is_template_argument(self, start, end):
        """Returns whether this is a template argument, which is constant. A comparison has a space before it."""
        return self.bytes[start - 1 : start] == b"<" and self.bytes[end : end + 1] in (b">", b",")

    def is_constant(self, cursor):
        """Returns whether this is constant; mutants never run in constant expressions, see mutants.h."""
        if cursor.kind is not CursorKind.VAR_DECL:
            return False
        words = (token.spelling for token in cursor.get_tokens())
        return "constexpr" in itertools.takewhile(lambda word: word not in ("=", "{"), words)

    def visit_operator(self, cursor):
        """Replaces an operator with the other ones of its group."""
        children = list(cursor.get_children())
        place = self.span(cursor)
        if place is None or len(children) != 2:
            return
        left, right = self.span(children[0]), self.span(children[1])
        if left is None or right is None:
            return
        operator = self.text(left[1], right[0]).strip()
        if operator not in OTHER:
            return
        a, b = self.text(*left), self.text(*right)
        other = OTHER[operator]
        if cursor.kind is CursorKind.BINARY_OPERATOR:
            text = f"(winnow_mutants::is(@) ? ({a}) {other} ({b}) : ({a}) {operator} ({b}))"
        else:
            text = f"(winnow_mutants::is(@) ? (void)({a} {other} {b}) : (void)({a} {operator} {b}))"
        self.add(*place, text, f"'{operator}' -> '{other}'")

    def visit_literal(self, cursor):
        place = self.span(cursor)
        if place is None:
            return
        literal = self.text(*place)
        if not literal[0].isdigit() or self.is_template_argument(*place):
            return
        self.add(*place, f"(winnow_mutants::is(@) ? {literal} + 1 : {literal})",
                 f"{literal} -> {literal} + 1")

    def visit_statement(self, statement):
        """Removes a statement."""
        inner = statement
        while inner.kind in WRAPPED and len(list(inner.get_children())) == 1:
            inner = next(inner.get_children())
        place = self.span(statement)
        if inner.kind not in REMOVABLE or inner.spelling in HINTS or place is None:
            return
        end = place[1]
        while self.bytes[end : end + 1].isspace():
            end += 1
        if self.bytes[end : end + 1] != b";":
            return
        self.add(place[0], end + 1,
                 f"if (!winnow_mutants::is(@)) {{ {self.text(place[0], end + 1)} }}", "left out")

    def visit_condition(self, cursor):
        """Negates a condition."""
        children = list(cursor.get_children())
        place = self.span(children[0]) if children else None
        words = [token.spelling for token, _ in zip(cursor.get_tokens(), range(2))]
        if place is None or words != ["if", "("] or not children[0].kind.is_expression():
            return
        if ";" in self.text(cursor.extent.start.offset, place[1]):
            return
        condition = self.text(*place)
        self.add(*place, f"(static_cast<bool>({condition}) != winnow_mutants::is(@))",
                 "negated")


def compile_arguments(commands, path):
    """Returns the compile options of the file itself, or of the kernels or sources of its room."""
    room = path.parts[0]
    kernel = ".kernel." in path.name
    for own in (True, False):
        for command in commands:
            file = command["file"]
            if own and not file.endswith("/" + str(path)):
                continue
            if not own and not (f"winnow_{room}" in command["command"]
                                and (".kernel." in file) == kernel):
                continue
            words = command["command"].split()
            words = words[next(i for i, w in enumerate(words) if w.startswith("-")) :]
            return [w for i, w in enumerate(words)
                    if w not in ("-c", "-o") and words[i - 1] not in ("-c", "-o")] + ["-x", "c++"]
    raise SystemExit(f"no command compiles {path}")


def drawn(points, count, rng):
    """Returns `count` of the points, no two of which overlap, in random order."""
    rng.shuffle(points)
    taken = {}
    chosen = []
    for point in points:
        if count and len(chosen) == count:
            break
        others = taken.setdefault(point["file"], [])
        if any(point["start"] < end and start < point["end"] for start, end in others):
            continue
        others.append((point["start"], point["end"]))
        chosen.append(point)
    return chosen


def write(tree, mutants):
    """Writes the sources with all mutants that are to be compiled."""
    by_file = {}
    for mutant in mutants:
        # A file whose mutants were all dropped is written without them.
        some = by_file.setdefault(mutant["file"], [])
        if not mutant.get("dropped"):
            some.append(mutant)
    for path, some in by_file.items():
        pristine = (tree / path).with_suffix((tree / path).suffix + ".pristine")
        if not pristine.exists():
            pristine.write_bytes((tree / path).read_bytes())
        text = pristine.read_bytes()
        for mutant in sorted(some, key=lambda m: -m["start"]):
            change = mutant["text"].replace("@", str(mutant["id"])).encode()
            # Keeps the line numbers, by which errors are matched.
            change += b"\n" * (mutant["was"].count("\n") - change.count(b"\n"))
            text = text[: mutant["start"]] + change + text[mutant["end"] :]
        (tree / path).write_bytes(f'#include "tests/mutants/mutants.h"\n{QUIET}#line 1\n'.encode() + text)


def main():
    tree, commands_file, count, seed, out = sys.argv[1:6]
    tree = pathlib.Path(tree).resolve()
    commands = json.loads(pathlib.Path(commands_file).read_text())
    selected = re.compile(sys.argv[6] if len(sys.argv) > 6 else "")
    mutants = []
    targets = pathlib.Path(__file__).parent / "targets.txt"
    seen = set()
    for line in targets.read_text().splitlines():
        if not line or line.startswith("#"):
            continue
        group, *globs = line.split()
        paths = sorted({p.relative_to(tree) for g in globs for p in tree.glob(g)} - seen)
        seen.update(paths)
        if not selected.search(group):
            continue
        points = [point for path in paths
                  for point in Source(tree, path, compile_arguments(commands, path)).points]
        chosen = drawn(points, int(count), random.Random(f"{seed} {group}"))
        print(f"{group}: {len(chosen)} mutants of {len(points)} places", flush=True)
        for point in chosen:
            mutants.append({"id": len(mutants), "group": group, **point})
    write(tree, mutants)
    pathlib.Path(out).write_text(json.dumps(mutants, indent=1))


if __name__ == "__main__":
    main()
