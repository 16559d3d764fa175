"""What pages are filled in with while mkdocs builds them.

- A line `<!-- tests/examples/boxes.cpp [frames] -->` becomes that passage of that program: what lies
  there between the lines `// [frames]` and `// [end]` (`# ...` in Python and CMake). Tests build and run
  the programs.
- `[text](api:Partition::self_pairs)` links to the reference of that name.
- `<!-- results -->` becomes bench/RESULTS.md without its title.
- `{figure:Hard cases:robust:wrong}` becomes a figure of that: the first table below headings, or with a
  first cell, that hold these words (several by slashes), by row and column.
- `<!-- ledger -->` becomes what bench/trust/ledger.json holds.
- `<!-- live -->` becomes the scene that runs in the page, or a picture if there is no WebAssembly of it.

A passage, name or figure that is not there ends the build.
"""

import json
import os
import pathlib
import re
import xml.etree.ElementTree

ROOT = pathlib.Path(os.environ.get("WINNOW_ROOT", pathlib.Path(__file__).parents[2]))
WORK = pathlib.Path(os.environ.get("WINNOW_SITE_WORK", ROOT / "build"))

LANGUAGES = {".c": "c", ".cpp": "cpp", ".h": "cpp", ".py": "python", ".txt": "cmake"}


def passage(path, name):
    """The lines of a passage, without the margin of its first one."""
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
    """Where the reference explains each name, by its name with and without `winnow::`."""
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


def tables():
    """Of the results: (words above it and its first cell, columns, rows by first cell)."""
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


def live_scene(_):
    docs = pathlib.Path(os.environ["WINNOW_SITE_DOCS"])
    if not (docs / "live_wasm.js").exists():
        return "![Boxes, pairs in orange, and the nodes of a tree around them](partition.svg)"
    scene = (ROOT / "bench/site/live/scene.html").read_text().strip()
    return scene + '\n<script src="live_wasm.js"></script>\n<script src="live.js"></script>'


def on_page_markdown(markdown, page, **_):
    markdown = re.sub(r"^<!-- (\S+) \[(.*)\] -->$", shown_passage, markdown, flags=re.M)
    markdown = re.sub(r"^<!-- live -->$", live_scene, markdown, flags=re.M)
    markdown = re.sub(r"\{figure:([^}]*)\}", figure, markdown)
    markdown = re.sub(r"^<!-- ledger -->$", ledger, markdown, flags=re.M)
    markdown = re.sub(r"^<!-- results -->$", lambda _: results_text(), markdown, flags=re.M)
    return re.sub(r"\]\(api:([\w:]+)\)", reference_link, markdown)
