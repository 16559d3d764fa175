"""Counts all instances of a template together: merge.py EXPORT.json IN.info OUT.info.

In its files for lcov, llvm-cov writes separate branches for each instance of a template, and lists a
file twice if it was compiled under two spellings of its path. This script writes lines and branches
once for each place in a source, with the sum of all executions. EXPORT.json is the output of
`llvm-cov export -format=text` for the same run as IN.info.
"""

import collections
import json
import os
import sys


def branches_of(export):
    """Returns, by file and place, how often a condition was true and how often false."""
    files = collections.defaultdict(dict)
    for function in export["data"][0]["functions"]:
        for *place, true, false, file, _, _ in function.get("branches", []):
            name = os.path.normpath(function["filenames"][file])
            counts = files[name].setdefault(tuple(place), [0, 0])
            counts[0] += true
            counts[1] += false
    return files


def lines_of(info):
    """Returns, by file and line, how often the line was executed."""
    files = collections.defaultdict(collections.Counter)
    name = ""
    for line in info:
        if line.startswith("SF:"):
            name = os.path.normpath(line[3:].strip())
        if line.startswith("DA:"):
            number, count = line[3:].split(",")[:2]
            files[name][int(number)] += int(count)
    return files


def record(name, lines, branches):
    """Yields the record of one file in lcov's format."""
    yield f"SF:{name}\n"
    for number, count in sorted(lines.items()):
        yield f"DA:{number},{count}\n"
    for number, (place, counts) in enumerate(sorted(branches.items())):
        for way, count in enumerate(counts):
            # A condition that was never evaluated has no count.
            yield f"BRDA:{place[0]},{number},{way},{count if any(counts) else '-'}\n"
    yield f"BRF:{2 * len(branches)}\n"
    yield f"BRH:{sum(count != 0 for counts in branches.values() for count in counts)}\n"
    yield f"LF:{len(lines)}\nLH:{sum(count != 0 for count in lines.values())}\nend_of_record\n"


def main():
    export, source, out = sys.argv[1:4]
    with open(export, encoding="utf-8") as file:
        branches = branches_of(json.load(file))
    with open(source, encoding="utf-8") as file:
        lines = lines_of(file)
    with open(out, "w", encoding="utf-8") as file:
        for name in sorted(lines):
            file.writelines(record(name, lines[name], branches.get(name, {})))


if __name__ == "__main__":
    main()
