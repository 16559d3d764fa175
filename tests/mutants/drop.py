"""Removes mutants that do not compile: drop.py TREE MUTANTS LOG. Ends with 1 if there are none."""

import json
import pathlib
import re
import sys

from rewrite import write


def main():
    tree = pathlib.Path(sys.argv[1]).resolve()
    file = pathlib.Path(sys.argv[2])
    mutants = json.loads(file.read_text())
    log = pathlib.Path(sys.argv[3]).read_text()
    # Includes the instantiations of templates with a mutant: takes the lines of all error messages.
    places = set(re.findall(r"([\w./-]+):(\d+):(?:\d+:)? +(?:error|required|note|  )", log))
    lines = {(name, int(line)) for name, line in places}
    dropped = 0
    for mutant in mutants:
        last = mutant["line"] + mutant["was"].count("\n")
        near = any(name.endswith(mutant["file"]) and mutant["line"] <= line <= last
                   for name, line in lines)
        if near and not mutant.get("dropped"):
            mutant["dropped"] = True
            dropped += 1
    write(tree, mutants)
    file.write_text(json.dumps(mutants, indent=1))
    print(f"{dropped} mutants do not compile")
    sys.exit(0 if dropped else 1)


if __name__ == "__main__":
    main()
