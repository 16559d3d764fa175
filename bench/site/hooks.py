"""Replaces placeholders in pages while mkdocs builds them.

- A line `<!-- tests/examples/boxes.cpp [frames] -->` becomes a passage of that program: the lines
  between `// [frames]` and `// [end]` (`# ...` in Python and CMake). Tests build and run the programs.
- `[text](api:Partition::self_pairs)` becomes a link to the reference of that name.
- `<!-- results -->` becomes bench/RESULTS.md without its title.
- `{figure:Hard cases:robust:wrong}` becomes a figure of the results by table, row and column. The table is
  the first whose headings or first cell contain these words (several, separated by slashes).
- `<!-- architecture -->` becomes .github/ARCHITECTURE.md without its title; its pictures are in pages/.
- `<!-- ledger -->` becomes the contents of bench/trust/ledger.json.
- `<!-- python -->` becomes the reference of the Python package, from its stubs and sources.
- `<!-- live -->` becomes the scene that runs in the page, or a picture if it was not built.

A missing passage, name or figure ends the build.

After the build, search_index.js contains the sections of all pages and the names of the reference.
"""

import ast
import json
import os
import pathlib
import re
import shutil
import xml.etree.ElementTree

import mkdocs.contrib.search

ROOT = pathlib.Path(os.environ.get("WINNOW_ROOT", pathlib.Path(__file__).parents[2]))
WORK = pathlib.Path(os.environ.get("WINNOW_SITE_WORK", ROOT / "build"))

LANGUAGES = {".c": "c", ".cpp": "cpp", ".h": "cpp", ".py": "python", ".txt": "cmake"}


def passage(path, name):
    """Returns the lines of a passage, without the indentation of its first line."""
    lines = (ROOT / path).read_text().splitlines()
    marks = [i for i, line in enumerate(lines) if re.fullmatch(rf" *(//|#) \[{name}\]", line)]
    if len(marks) != 1:
        raise SystemExit(f"{path} has {len(marks)} passages [{name}]")
    start = marks[0] + 1
    end = next(i for i in range(start, len(lines)) if re.fullmatch(r" *(//|#) \[end\]", lines[i]))
    margin = len(lines[start - 1]) - len(lines[start - 1].lstrip())
    return "\n".join(line[margin:] for line in lines[start:end])


def shown_passage(match):
    path, name = match[1], match[2]
    language = LANGUAGES[pathlib.Path(path).suffix]
    return (
        f"```{language}\n{passage(path, name)}\n```\n"
        f'<p class="source" markdown="1">`{path}`, part of a test</p>\n'
    )


def reference_names():
    """Returns the page and anchor of each name in the reference, by its name without `winnow::`."""
    names = {}
    tags = xml.etree.ElementTree.parse(WORK / "api.tag").getroot()
    for compound in tags.findall("compound"):
        if compound.get("kind") not in ("class", "struct", "namespace"):
            continue
        name = compound.findtext("name").removeprefix("winnow::")
        names.setdefault(name, compound.findtext("filename"))
        prefix = "" if name == "winnow" else name + "::"
        for member in compound.findall("member"):
            place = member.findtext("anchorfile") + "#" + member.findtext("anchor")
            names.setdefault(prefix + member.findtext("name"), place)
    return names


_names = None


def reference_link(match):
    global _names
    _names = _names or reference_names()
    if match[1] not in _names:
        raise SystemExit(f"the reference does not explain {match[1]}")
    return f"](api/{_names[match[1]]})"


def results_text():
    return (ROOT / "bench/RESULTS.md").read_text().split("\n", 1)[1]


def architecture_text():
    text = (ROOT / ".github/ARCHITECTURE.md").read_text().split("\n", 1)[1]
    return text.replace("](../bench/site/pages/", "](")


def tables():
    """Yields each table of the results: (headings above it and first cell, columns, rows by first cell)."""
    above = ["", ""]
    rows = None
    for line in [*results_text().splitlines(), ""]:
        if line.startswith("#"):
            level = line.index(" ") - 2
            above = above[:level] + [line] + [""] * (1 - level)
        cells = [cell.strip(" *") for cell in line.strip("|").split("|")]
        if line.startswith("|") and rows is None:
            columns, rows = cells, {}
        elif line.startswith("|"):
            rows[cells[0]] = cells
        elif rows is not None:
            yield [*above, columns[0]], columns, rows
            rows = None


def figure(match):
    place, row, column = match[1].split(":")
    for words, columns, rows in tables():
        held = all(any(piece in word for word in words) for piece in place.split("/"))
        if held and row in rows and column in columns:
            return rows[row][columns.index(column)]
    raise SystemExit(f"the results have no {match[0]}")


def ledger_row(row):
    lines = [f"## {row['name'].capitalize()}", "", row["what"], "", "| | |", "|---|---|"]
    lines += [f"| {figure['name']} | {figure['value']} |" for figure in row["figures"]]
    if row.get("note"):
        lines += ["", row["note"]]
    lines += ["", f"{row['date']}, commit `{row['commit']}`: `{row['command']}`", ""]
    return "\n".join(lines)


def ledger(_):
    rows = json.loads((ROOT / "bench/trust/ledger.json").read_text())["rows"]
    return "\n".join(ledger_row(row) for row in rows)


def python_call(node):
    """Returns the signature of a Python function, without the types of its arguments."""
    arguments = node.args
    values = [None] * (len(arguments.args) - len(arguments.defaults)) + arguments.defaults
    pairs = list(zip(arguments.args, values)) + [(ast.arg("*"), None)] * bool(arguments.kwonlyargs)
    pairs += zip(arguments.kwonlyargs, arguments.kw_defaults)
    texts = [a.arg + (f"={ast.unparse(value)}" if value else "") for a, value in pairs if a.arg != "self"]
    return f"({', '.join(texts)})"


def python_entries(node, owner):
    """Yields the headings and texts of a Python function, or of a class and its members."""
    text = ast.get_docstring(node) or ""
    name = f"{owner}.{node.name}" if owner else node.name
    if isinstance(node, ast.ClassDef):
        yield f"## {name}\n\n{text}"
        columns = [part for part in node.body if isinstance(part, ast.AnnAssign)]
        yield "\n".join(
            f"- `{part.target.id}`: {part.annotation.slice.elts[1].value}"
            for part in columns if isinstance(part.annotation, ast.Subscript)
            and ast.unparse(part.annotation.value) == "Annotated"
        )
        for part in node.body:
            if isinstance(part, ast.FunctionDef) and (ast.get_docstring(part) or not part.name.startswith("_")):
                yield from python_entries(part, name)
        return
    is_property = any(ast.unparse(mark) == "property" for mark in node.decorator_list)
    returned = "" if node.returns is None or ast.unparse(node.returns) == "None" else ast.unparse(node.returns)
    if text:  # only one of overloads has a text
        call = name.replace(".__init__", "") + ("" if is_property else python_call(node))
        yield f"### `{call}`\n\n{text}" + (f"\n\nReturns `{returned}`." if returned else "")


def python_reference(_):
    """Returns the reference of the classes, then of the other functions, of the Python package."""
    nodes = [
        node
        for file in ("_core.pyi", "tables.py", "calls.py", "advice.py")
        for node in ast.parse((ROOT / "pipeline/python/winnow" / file).read_text()).body
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)) and not node.name.startswith("_")
    ]
    classes = [node for node in nodes if isinstance(node, ast.ClassDef) and node.name != "Table"]
    functions = [node for node in nodes if isinstance(node, ast.FunctionDef) and node.name != "shown"]
    entries = [entry for node in classes for entry in python_entries(node, "")] + ["## Functions"]
    return "\n\n".join(entries + [entry for node in functions for entry in python_entries(node, "")])


def live_scene(_):
    docs = pathlib.Path(os.environ["WINNOW_SITE_DOCS"])
    if not (docs / "live_wasm.js").exists():
        return "![Boxes, pairs in orange, and the nodes of a tree around them](partition.svg)"
    scene = (ROOT / "bench/site/live/scene.html").read_text().strip()
    return scene + '\n<script src="live_wasm.js"></script>\n<script src="live.js"></script>'


def on_page_markdown(markdown, page, **_):
    markdown = re.sub(r"^<!-- (\S+) \[(.*)\] -->$", shown_passage, markdown, flags=re.M)
    markdown = re.sub(r"^<!-- architecture -->$", lambda _: architecture_text(), markdown, flags=re.M)
    markdown = re.sub(r"^<!-- live -->$", live_scene, markdown, flags=re.M)
    markdown = re.sub(r"\{figure:([^}]*)\}", figure, markdown)
    markdown = re.sub(r"^<!-- ledger -->$", ledger, markdown, flags=re.M)
    markdown = re.sub(r"^<!-- python -->$", python_reference, markdown, flags=re.M)
    markdown = re.sub(r"^<!-- results -->$", lambda _: results_text(), markdown, flags=re.M)
    return re.sub(r"\]\(api:([\w:]+)\)", reference_link, markdown)


def on_post_build(config, **_):
    """Makes the index of the search plugin a script, with the name of its page for each section."""
    site = pathlib.Path(config["site_dir"])
    sections = json.loads((site / "search/search_index.json").read_text())["docs"]
    pages = {section["location"]: section["title"] for section in sections if "#" not in section["location"]}
    entries = [
        {**section, "page": pages[section["location"].partition("#")[0]]} for section in sections
    ]
    entries += [
        {"location": f"api/{place}", "title": name, "text": name.replace("::", " ").replace("_", " "),
         "page": "Reference"}
        for name, place in sorted(reference_names().items())
    ]
    (site / "search_index.js").write_text(f"const WINNOW_SEARCH = {json.dumps(entries)};\n")
    lunr = pathlib.Path(mkdocs.contrib.search.__file__).parent / "templates/search/lunr.js"
    shutil.copy(lunr, site)
    shutil.rmtree(site / "search")
