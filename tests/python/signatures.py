"""Usage: signatures.py STUB

Compares the signatures in the stubs with the docstrings of pybind11, which mypy's stubtest cannot read:
names and order of arguments, which have defaults, and which are keyword-only.
"""

import ast
import inspect
import re
import sys

import winnow._core


def stub_signature(function):
    arguments = function.args
    names = [a.arg for a in arguments.args]
    defaults = names[len(names) - len(arguments.defaults) :] if arguments.defaults else []
    named = [a.arg for a in arguments.kwonlyargs]
    defaults += [a for a, value in zip(named, arguments.kw_defaults) if value is not None]
    return names, named, set(defaults)


def module_signature(function):
    line = (function.__doc__ or "").split("\n")[0]
    inside = line[line.index("(") + 1 : line.rindex(")")]
    inside = re.sub(r"<[^<>]*>", "x", inside)
    while re.search(r"[\[(][^\[\]()]*[\])]", inside):
        inside = re.sub(r"[\[(][^\[\]()]*[\])]", "", inside)
    names, named, defaults = [], [], set()
    to = names
    for part in filter(None, (p.strip() for p in inside.split(","))):
        if part == "*":
            to = named
            continue
        name = re.match(r"\w+", part).group()
        to.append(name)
        if "=" in part:
            defaults.add(name)
    return names, named, defaults


def functions(body, owner):
    """Returns the last declaration of each name; overloads differ in their defaults."""
    found = {}
    for node in body:
        if isinstance(node, ast.ClassDef):
            yield from functions(node.body, getattr(owner, node.name))
        elif isinstance(node, ast.FunctionDef):
            if any(isinstance(d, ast.Name) and d.id == "property" for d in node.decorator_list):
                continue
            found.setdefault(node.name, []).append(node)
    for name, nodes in found.items():
        yield getattr(owner, name), nodes


def main():
    with open(sys.argv[1]) as file:
        stub = ast.parse(file.read())
    bad = 0
    classes = {node.name for node in stub.body if isinstance(node, ast.ClassDef)}
    for name, value in vars(winnow._core).items():
        if isinstance(value, type) and name not in classes:
            print(name + " is only in the module")
            bad = 1
    for function, nodes in functions(stub.body, winnow._core):
        declared = module_signature(function)
        for node in nodes:
            stubbed = stub_signature(node)
            same = stubbed[:2] == declared[:2] and (len(nodes) > 1 or stubbed[2] == declared[2])
            if not same and node.name not in ("__len__", "__repr__"):
                print("%s: the stub has %s, the module %s" % (node.name, stubbed, declared))
                bad = 1
        if not inspect.getdoc(function):
            print(node.name + " has no docstring")
            bad = 1
    return bad


sys.exit(main())
