"""Reads results, for the scripts of bench/results, bench/goals and bench/site."""

import json
import math
import pathlib
import re


class Rows:
    """The rows of files by name, of repeated measurements the median; the context of the first file."""

    def __init__(self, *paths):
        self.context, self.all = {}, {}
        for path in paths:
            document = json.loads(pathlib.Path(path).read_text())
            self.context = self.context or document["context"]
            for row in document["benchmarks"]:
                if row.get("run_type") != "aggregate" or row.get("aggregate_name") == "median":
                    self.all[re.sub("/(real|manual)_time$", "", row.get("run_name", row["name"]))] = row

    def found(self, pattern, value, only_right=True):
        """Yields the groups of each name that the pattern matches, and the row's value. {isa} is the default
        instruction set of the run. Rows of libraries with wrong answers are left out, if `only_right`."""
        compiled = re.compile(pattern.replace("{isa}", self.context.get("isa", "")))
        for name, row in self.all.items():
            match = compiled.fullmatch(name)
            if match and row.get(value) is not None and (row.get("right", 1) != 0 or not only_right):
                yield match.groupdict(""), row[value]


def short(value):
    """Formats a number with three digits; an error with two and an exponent."""
    if not isinstance(value, (int, float)):
        return "-" if value is None else str(value)
    if value != 0 and abs(value) < 1e-3:
        return f"{value:.1e}"
    if value == int(value) or abs(value) >= 1000:
        return f"{round(value):,}"
    return f"{value:.{max(0, 2 - math.floor(math.log10(abs(value))))}f}"
