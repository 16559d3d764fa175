"""Runs the tests against each mutant: judge.py PROGRAMS MUTANTS SECONDS OUT [SUITES].

First every test suite runs once without a mutant and records which mutants it executes; a suite that fails
at the scale of WINNOW_TEST_SCALE, because too few of its cases are left, is run at larger scales. Each line
of digests.txt for the host's usual rounding counts as a suite. Then each mutant is run by the suites that
execute it until one fails, hangs or crashes, which kills it, or until SECONDS have been used for it: first
suites that killed other mutants of its file, then suites with few mutants for their run time. Prints the
survivors, with the reason in survivors.txt if there is one, and the score by group; writes all of it to OUT
as JSON. Mutants that survivors.txt calls equivalent are not counted. SUITES, a regular expression, selects
suites. All times are CPU times, since other processes may use the machine.
"""

import collections
import concurrent.futures
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

PROGRAMS = ["core", "partition", "query", "pipeline", "recording", "memory"]
HERE = pathlib.Path(__file__).parent
DIGESTS = HERE.parent / "digests" / "digests.txt"
# A process without CPU time for this many seconds is taken to hang.
MOST_IDLE = 60
# The tests replace operator delete, to count calls.
SANITIZER = "alloc_dealloc_mismatch=0:detect_leaks=0"
# Used if a suite fails at the given scale because it has too few cases.
LARGER_SCALES = ["0.3", "1"]


def suites_of(programs, files):
    """Returns the names of suites and the command of each. `files` is a folder for their input files."""
    suites = []
    for name in PROGRAMS:
        program = f"{programs}/winnow_{name}_tests"
        listed = subprocess.run([program, "--gtest_list_tests"], capture_output=True, text=True,
                                check=True).stdout
        suites += [(line.strip(), [program, f"--gtest_filter={line.strip()}*", "--gtest_brief=1",
                                   "--gtest_fail_fast"])
                   for line in listed.splitlines()
                   if line and not line.startswith(" ") and line.strip().endswith(".")]
    for line in DIGESTS.read_text().splitlines():
        mode, name, _ = line.split(" ", 2)
        if mode != "nearest":
            continue
        file = pathlib.Path(files) / name.replace("/", "-")
        file.write_text(line + "\n")
        suites.append((f"digest {name}", [f"{programs}/winnow_digests", "--check-once", str(file)]))
    return suites


def is_idle(process, used):
    """Returns whether a process that is not stopped has the CPU time `used`, as at the last call; and its
    CPU time."""
    try:
        fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text().rsplit(")", 1)[1].split()
    except OSError:
        return False, used
    now = int(fields[11]) + int(fields[12])
    return now == used and fields[0] not in "Tt", now


def run_suite(words, extra, limit):
    """Returns whether the tests pass within `limit` seconds, and the seconds that they took."""
    process = subprocess.Popen(["prlimit", f"--cpu={math.ceil(limit)}", *words],
                               env=dict(os.environ, ASAN_OPTIONS=SANITIZER, **extra),
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    used, idle, pause = -1, 0.0, 0.002
    while True:
        pid, code, usage = os.wait4(process.pid, os.WNOHANG)
        if pid != 0:
            process.returncode = code
            return code == 0, usage.ru_utime + usage.ru_stime
        still, used = is_idle(process, used)
        idle = idle + pause if still else 0.0
        if idle > MOST_IDLE:
            process.kill()
        time.sleep(pause)
        pause = min(2.0 * pause, 0.25)


def survey(name, words):
    """Returns the mutants that a suite executes, the scale at which it passes, and its run time."""
    for scale in [os.environ.get("WINNOW_TEST_SCALE", "0.1"), *LARGER_SCALES]:
        with tempfile.NamedTemporaryFile("r") as file:
            passed, took = run_suite(words, {"WINNOW_MUTANTS_REACHED": file.name,
                                             "WINNOW_TEST_SCALE": scale}, 600)
            reached = {int(line) for line in file}
        if passed:
            break
    return {"suite": name, "words": words, "scale": scale, "took": took, "passed": passed,
            "reached": reached}


def judge(mutant, suites, kills, budget):
    """Returns the suite that kills a mutant, or None if it survives; `ran_all` is false if the budget was used
    up before all suites that execute the mutant were run. `kills` counts, by file and suite, the mutants
    killed so far."""
    file_kills = kills[mutant["file"]]
    mine = sorted((s for s in suites if mutant["id"] in s["reached"]),
                  key=lambda s: (-file_kills[s["suite"]], s["took"] * len(s["reached"])))
    spent = 0.0
    for suite in mine:
        if spent > budget:
            return {"killed_by": None, "suites": len(mine), "ran_all": False}
        passed, took = run_suite(suite["words"], {"WINNOW_MUTANT": str(mutant["id"]),
                                                  "WINNOW_TEST_SCALE": suite["scale"]},
                                 10.0 * suite["took"] + 5.0)
        if not passed:
            file_kills[suite["suite"]] += 1
            return {"killed_by": suite["suite"], "suites": len(mine), "ran_all": True}
        spent += took
    return {"killed_by": None, "suites": len(mine), "ran_all": True}


def known_survivors():
    """Returns the reasons of survivors.txt by file, place and change."""
    known = {}
    for line in (HERE / "survivors.txt").read_text().splitlines():
        if line and not line.startswith("#"):
            rest, what, reason = line.rsplit(" | ", 2)
            file, place = rest.split(" | ", 1)
            known[file, place, what] = reason
    return known


def main():
    programs, mutants_file, budget, out = sys.argv[1:5]
    selected = re.compile(sys.argv[5] if len(sys.argv) > 5 else "")
    mutants = [m for m in json.loads(pathlib.Path(mutants_file).read_text())
               if not m.get("dropped")]
    with (concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool,
          tempfile.TemporaryDirectory() as files):
        jobs = [pool.submit(survey, name, words) for name, words in suites_of(programs, files)
                if selected.search(name)]
        suites = [job.result() for job in jobs]
        for suite in suites:
            if not suite["passed"]:
                print(f"without a mutant {suite['suite']} does not pass: left out", flush=True)
        suites = [s for s in suites if s["passed"]]
        print(f"{len(suites)} suites take {sum(s['took'] for s in suites):.0f} s", flush=True)
        kills = collections.defaultdict(collections.Counter)
        verdicts = []
        for verdict in pool.map(lambda m: judge(m, suites, kills, float(budget)), mutants):
            verdicts.append(verdict)
            killed = sum(v["killed_by"] is not None for v in verdicts)
            print(f"{killed} of {len(verdicts)} are killed", end="\r", file=sys.stderr, flush=True)

    known = known_survivors()
    counts = collections.defaultdict(collections.Counter)
    for mutant, verdict in zip(mutants, verdicts):
        mutant.update(verdict)
        count = counts[mutant["group"]]
        if verdict["killed_by"]:
            count["killed"] += 1
            continue
        reason = known.get((mutant["file"], mutant["place"], mutant["what"]), "")
        mutant["reason"] = reason
        count["equivalent" if reason.startswith("equivalent") else "survived"] += 1
        count["slower"] += reason.startswith("only time")
        where = "" if verdict["suites"] else ", no suite comes by it"
        where += "" if verdict["ran_all"] else ", not all suites were run"
        print(f"{mutant['file']} | {mutant['place']} | {mutant['what']} | "
              f"{reason or 'no reason is known'} (line {mutant['line']}{where})")
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
            f"{count['equivalent']} equivalent besides, {count['slower']} survivors only take longer")


if __name__ == "__main__":
    main()
