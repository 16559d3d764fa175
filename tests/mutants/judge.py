"""Runs the tests against each mutant: judge.py PROGRAMS MUTANTS SECONDS OUT [SUITES].

First every suite of tests runs once without a mutant, and tells which mutants it comes by; one that does
not pass at the scale of WINNOW_TEST_SCALE, as too few of its cases are left, is run at larger ones. Then each
mutant is run by the suites that come by it until one fails, hangs or crashes, which kills it, or until
SECONDS have passed for it: those first that killed others of its file, then those that come by few mutants
for the time that they take. Prints the survivors, with the reason that survivors.txt
gives where it knows one, and the score by group; OUT gets all of it as JSON. Equivalent mutants, as that
file calls them, are not counted. SUITES, a regular expression, takes those suites alone.
"""

import collections
import concurrent.futures
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

PROGRAMS = ["core", "partition", "query", "pipeline", "recording"]
HERE = pathlib.Path(__file__).parent
# Of tests, where the one that was asked for leaves a suite too little to find.
LARGER_SCALES = ["0.3", "1"]


def suites_of(program):
    listed = subprocess.run([program, "--gtest_list_tests"], capture_output=True, text=True,
                            check=True).stdout
    return [line.strip() for line in listed.splitlines() if line and not line.startswith(" ")
            and line.strip().endswith(".")]


def run_suite(program, suite, extra, limit):
    """True if the tests pass within so many seconds. What takes longer is run once more: the machine may
    have been busy, and a mutant is to be killed by tests alone."""
    environment = dict(os.environ, **extra)
    words = [program, f"--gtest_filter={suite}*", "--gtest_brief=1", "--gtest_fail_fast"]
    for _ in range(2):
        try:
            done = subprocess.run(words, env=environment, timeout=limit, stdout=subprocess.DEVNULL,
                                  stderr=subprocess.DEVNULL, check=False)
        except subprocess.TimeoutExpired:
            continue
        return done.returncode == 0
    return False


def survey(program, suite):
    """What a suite comes by without a mutant, at which scale, and how long it takes."""
    for scale in [os.environ.get("WINNOW_TEST_SCALE", "0.1"), *LARGER_SCALES]:
        with tempfile.NamedTemporaryFile("r") as file:
            start = time.monotonic()
            passed = run_suite(program, suite, {"WINNOW_MUTANTS_REACHED": file.name,
                                                "WINNOW_TEST_SCALE": scale}, 600)
            took = time.monotonic() - start
            reached = {int(line) for line in file}
        if passed:
            break
    return {"program": program, "suite": suite, "scale": scale, "took": took, "passed": passed,
            "reached": reached}


def judge(mutant, suites, kills, budget):
    """The suite that kills it, None if it survives, and whether all that come by it were run. `kills` counts
    by file and suite what was killed so far."""
    file_kills = kills[mutant["file"]]
    mine = sorted((s for s in suites if mutant["id"] in s["reached"]),
                  key=lambda s: (-file_kills[s["suite"]], s["took"] * len(s["reached"])))
    spent = 0.0
    for suite in mine:
        if spent > budget:
            return {"killed_by": None, "suites": len(mine), "ran_all": False}
        start = time.monotonic()
        limit = 10.0 * suite["took"] + 5.0
        if not run_suite(suite["program"], suite["suite"],
                         {"WINNOW_MUTANT": str(mutant["id"]), "WINNOW_TEST_SCALE": suite["scale"]},
                         limit):
            file_kills[suite["suite"]] += 1
            return {"killed_by": suite["suite"] + "*", "suites": len(mine), "ran_all": True}
        spent += time.monotonic() - start
    return {"killed_by": None, "suites": len(mine), "ran_all": True}


def known_survivors():
    """Reasons by file, what was written and what became of it."""
    known = {}
    for line in (HERE / "survivors.txt").read_text().splitlines():
        if line and not line.startswith("#"):
            file, was, what, reason = (part.strip() for part in line.split(" | "))
            known[file, was, what] = reason
    return known


def one_line(text):
    return " ".join(text.split())


def main():
    programs, mutants_file, budget, out = sys.argv[1:5]
    wanted = re.compile(sys.argv[5] if len(sys.argv) > 5 else "")
    mutants = [m for m in json.loads(pathlib.Path(mutants_file).read_text())
               if not m.get("dropped")]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        jobs = []
        for name in PROGRAMS:
            program = f"{programs}/winnow_{name}_tests"
            jobs += [pool.submit(survey, program, suite) for suite in suites_of(program)
                     if wanted.search(suite)]
        suites = [job.result() for job in jobs]
        for suite in suites:
            if not suite["passed"]:
                print(f"without a mutant {suite['suite']}* does not pass: left out", flush=True)
        suites = [s for s in suites if s["passed"]]
        print(f"{len(suites)} suites take {sum(s['took'] for s in suites):.0f} s", flush=True)
        kills = collections.defaultdict(collections.Counter)
        verdicts = list(pool.map(lambda m: judge(m, suites, kills, float(budget)), mutants))

    known = known_survivors()
    counts = collections.defaultdict(collections.Counter)
    for mutant, verdict in zip(mutants, verdicts):
        mutant.update(verdict)
        count = counts[mutant["group"]]
        if verdict["killed_by"]:
            count["killed"] += 1
            continue
        reason = known.get((mutant["file"], one_line(mutant["was"]), mutant["what"]), "")
        mutant["reason"] = reason
        count["equivalent" if reason.startswith("equivalent") else "survived"] += 1
        where = "" if verdict["suites"] else " (no suite comes by it)"
        where += "" if verdict["ran_all"] else " (not all suites were run)"
        print(f"{mutant['file']}:{mutant['line']} | {one_line(mutant['was'])} | {mutant['what']}"
              f"{where} | {reason or 'no reason is known'}")
    total = collections.Counter()
    for group, count in counts.items():
        total.update(count)
        print(f"{group:8} {score(count)}")
    print(f"{'all':8} {score(total)}")
    pathlib.Path(out).write_text(json.dumps(
        {"mutants": mutants, "total": total, "groups": counts}, indent=1))


def score(count):
    judged = count["killed"] + count["survived"]
    share = 100.0 * count["killed"] / judged if judged else 0.0
    return (f"{count['killed']:4} of {judged:4} killed, {share:5.1f} %, "
            f"{count['equivalent']} equivalent")


if __name__ == "__main__":
    main()
