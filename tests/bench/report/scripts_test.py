#!/usr/bin/env python3
"""Tests of the scripts that read results: bench/results/write, bench/results/compare and bench/goals/check."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
NAME = "throughput/uniform/objects:100000/threads:2/{}/isa:avx2"


def row(name, time, **values):
    return {"name": name, "run_type": "iteration", "iterations": 9, "real_time": time, "cpu_time": time,
            "time_unit": "ms", "real_time_min": 0.9 * time, "real_time_max": 2 * time, **values}


class Scripts(unittest.TestCase):
    def setUp(self):
        self.work = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.work.name)
        self.addCleanup(self.work.cleanup)

    def write(self, name, rows, **context):
        path = self.folder / name
        about = {"machine": "m", "num_cpus": 2, "isa": "avx2", "commit": "c", "reference_sweep_ms": 23.0, **context}
        path.write_text(json.dumps({"context": about, "benchmarks": rows}))
        return str(path)

    def run_script(self, script, *words):
        done = subprocess.run([sys.executable, str(ROOT / "bench" / script), *words], capture_output=True, text=True, check=False)
        self.assertEqual(done.stderr, "")
        return done.returncode, done.stdout

    def frames(self, linear, **values):
        return [row(NAME.format("linear_bvh"), linear, **values), row(NAME.format("embree"), 38.9)]

    def test_equal_results_pass_the_comparison(self):
        old = self.write("old.json", self.frames(2.0))
        self.assertEqual(self.run_script("results/compare", old, old)[0], 0)

    def test_slower_row_fails_the_comparison(self):
        old, new = self.write("old.json", self.frames(2.0)), self.write("new.json", self.frames(2.5))
        status, text = self.run_script("results/compare", old, new)
        self.assertEqual(status, 1)
        self.assertIn("WORSE", text)
        self.assertEqual(self.run_script("results/compare", new, old)[0], 0)

    def test_overlapping_samples_are_noise(self):
        old = self.write("old.json", self.frames(2.0))
        new = self.write("new.json", [{**self.frames(2.5)[0], "real_time_min": 1.9}, self.frames(2.5)[1]])
        self.assertEqual(self.run_script("results/compare", old, new)[0], 0)

    def test_slower_machine_scales_the_times(self):
        old = self.write("old.json", self.frames(2.0))
        new = self.write("new.json", [row(one["name"], 2 * one["real_time"]) for one in self.frames(2.0)],
                         machine="other", reference_sweep_ms=46.0)
        self.assertEqual(self.run_script("results/compare", old, new)[0], 0)

    def test_missing_row_other_pairs_and_wrong_answers_fail(self):
        old = self.write("old.json", self.frames(2.0, fingerprint="a", wrong=0))
        for rows in (self.frames(2.0, fingerprint="a", wrong=0)[1:], self.frames(2.0, fingerprint="b", wrong=0),
                     self.frames(2.0, fingerprint="a", wrong=1)):
            self.assertEqual(self.run_script("results/compare", old, self.write("new.json", rows))[0], 1)

    def test_names_are_compared_with_a_list(self):
        new = self.write("new.json", self.frames(2.0))
        names = self.folder / "names"
        names.write_text(NAME.format("linear_bvh") + "\n")
        self.assertEqual(self.run_script("results/compare", "--names", str(names), new)[0], 0)
        names.write_text("gone\n")
        self.assertIn("missing: gone", self.run_script("results/compare", "--names", str(names), new)[1])

    def test_documents_show_the_figures_of_the_rows(self):
        results = self.write("results.json", self.frames(2.0, bytes_per_object=88.5))
        page, readme = self.folder / "page.md", self.folder / "readme.md"
        readme.write_text("before\n<!-- figures -->\nold\n<!-- end -->\nafter\n")
        words = (results, str(page), str(readme))
        self.assertEqual(self.run_script("results/write", "--check", *words)[0], 1)
        self.assertEqual(self.run_script("results/write", *words)[0], 0)
        self.assertEqual(self.run_script("results/write", "--check", *words)[0], 0)
        self.assertIn("| uniform, 100,000 boxes, 2 threads | ms a frame | 2 (linear_bvh) | 38.9 (embree) | 19.4 |", page.read_text())
        text = readme.read_text()
        self.assertTrue(text.startswith("before\n") and text.endswith("<!-- end -->\nafter\n"))
        self.assertIn("| linear_bvh | 2 | 88.5 |", text)

    def test_goals_compare_rows_with_limits(self):
        for time, expected in ((2.0, "MISSED"), (0.1, "holds")):
            results = self.write("results.json", [row("whole_scenes/terrain/at_rest/winnow/threads:1", time)])
            text = self.run_script("goals/check", "--all", "--topic", "pipeline", results)[1]
            self.assertIn(expected, next(line for line in text.splitlines() if "terrain, at_rest, 1 threads" in line))

    def test_goals_without_rows_fail(self):
        self.assertEqual(self.run_script("goals/check", self.write("results.json", []))[0], 1)


if __name__ == "__main__":
    unittest.main()
