"use strict";
// Views: the contents of the sections of the page. A view draws rows of a family by a declaration of Chart.js;
// keys that its chart does not show become selections, as do its fields if there are several.

const unit_of = (list, field) => field === "real_time" ? `time, ${list[0]?.time_unit}` : label(field);

const by_bars = (key) => ({keys: [key], draw: (list, field) =>
  bars(list, key, [field].flat(), Array.isArray(field) ? "sum of the parts" : unit_of(list, field))});
const by_lines = (by, x, x_title, line = true, also = []) => ({keys: [by, x, ...also], draw: (list, field) =>
  curves(list, by, x, field, x_title, unit_of(list, field), line)});
// Stacks the rows that differ only in `by`.
const by_stacks = (key, by) => ({keys: [key, by], draw: (list, field) => {
  const merged = distinct(list, key).map((name) => Object.assign({[key]: name, run_name: name},
    ...list.filter((row) => row[key] === name).map((row) => ({[row[by]]: row[field]}))));
  return bars(merged, key, distinct(list, by), unit_of(list, field));
}});

const views = [];
const view = (section, title, family, fields, chart, text, where = () => true) =>
  views.push({section, title, family, fields, text, where, ...chart});

const ERRORS = ["worst_error", "p99_error", "median_error", "worst_distance", "worst_depth", "worst_degrees"];

let in_section = "Frames of partitions";
view(in_section, "Time of a frame", "throughput",
  ["real_time", "us_per_object", "first_ms", "update_ms", "update_share", "worst_ms", "pairs_per_s", "bytes_per_object", "pairs"],
  by_bars("partition"),
  "A frame updates all boxes that moved, rebuilds the structure if necessary and writes all overlapping pairs. Contenders take turns. Embree uses all threads, CGAL too if that is faster; other libraries use one.");
view(in_section, "Growth with the number of objects", "throughput", ["us_per_object", "real_time", "first_ms", "bytes_per_object"],
  by_lines("partition", "objects", "objects"), "A level line means that the time of an object does not depend on the number of objects.");
view(in_section, "Exponent of growth", "throughput_growth", ["exponent"], by_bars("partition"),
  "With an exponent of 1, twice the objects take twice the time. Fitted to all measured sizes.");
view(in_section, "Every scene: median, worst and first frame", "every_scene",
  ["real_time", "worst_ms", "first_ms", "worst_ratio", "over_yardstick", "pairs"], by_bars("partition"),
  "All built-in scenes, also those without temporal coherence. The yardstick is a blocked sweep without state between frames.");
view(in_section, "One partition in every scene", "every_scene", ["real_time", "worst_ms", "first_ms", "worst_ratio", "over_yardstick"], by_bars("scene"), "");
view(in_section, "First frames of new partitions", "cold",
  ["real_time", "ready_ms", "reserved_ms", "insert_ms", "build_ms", "pairs_ms", "reserve_ms", "pages_ms", "over_pages", "over_yardstick", "yardstick_ms"],
  by_bars("partition"), "Insertion, build and all pairs. Untouched memory costs page faults; ready: after a reserve that touches memory.");
view(in_section, "Two threads against one", "throughput_threads", ["speedup"], by_bars("partition"), "Times as fast; medians of one race.");
view(in_section, "Instruction sets", "throughput_simd", ["speedup"], by_bars("partition"), "Times as fast as on the narrowest instruction set.");
view(in_section, "Distance from a lower bound", "limits",
  ["ratio", "real_time", ["bandwidth_ms", "sort_ms", "permute_ms", "emission_ms"], "limit_ms"], by_bars("scene"),
  "A method without state must read and write all boxes, sort a key of each, fetch the boxes in that order, and write the pairs: the bound is the sum of these four. A partition that keeps its order can be faster.");
view(in_section, "Pairs that all contenders found", "throughput", ["pairs"], by_bars("partition"), "Equal fingerprints are equal sets of pairs.");
view(in_section, "Insert, update, remove", "keys", ["each"], by_bars("partition"), "A tenth of the objects, in one call or one by one.");
view(in_section, "Filters", "filter", ["real_time"], by_bars("partition"), "Layers and masks, against the same query without filters.");
view(in_section, "Job systems", "hosts", ["over_arena", "real_time"], by_bars("partition"), "A plain pool of threads over oneTBB.");
view(in_section, "Not run: too slow at this size", "throughput_skipped", ["objects"], by_bars("partition"), "");

in_section = "Memory";
view(in_section, "Memory by purpose", "memory",
  [["bounds", "keys", "client_data", "structure", "scratch", "results"], "reserved", "used", "peak_first", "peak_later", "pair_buffer"],
  by_bars("partition"), "Bytes of an object after some frames. The caller's array of pairs is not included.");
view(in_section, "Memory by number of objects", "memory", ["reserved", "used", "peak_first", "peak_later"], by_lines("partition", "objects", "objects"), "");
view(in_section, "Three measurements of it", "memory_check", ["bytes_per_object"], by_bars("partition"),
  "footprint() returns it, the memory resource counts it, and the resident set of a process shrinks by it.");
view(in_section, "Resident set over footprint()", "memory_ratio", ["ratio"], by_bars("partition"), "Below 1: reserved memory that was not written yet.");

in_section = "Bounding volumes";
view(in_section, "Time and tests of volumes", "volume",
  [["make_ms", "broad_ms", "narrow_ms"], "false_positives", "broad_ms", "found_ms", "reported", "pays_from_ns", "bytes_per_object"],
  by_bars("volume"), "A volume that fits better reports fewer pairs that do not touch, each of which costs an exact test.");
view(in_section, "False positives against time", "volume", ["false_positives"], by_lines("volume", "broad_ms", "broad phase, ms a frame", false, ["partition"]), "Each mark is a partition.");
view(in_section, "Margins by speed", "volume", ["broad_ms", "real_time"], by_lines("volume", "step", "distance in a frame, edges"),
  "With a margin an object can move a short way without an update.", (row) => row.setting === "cubes");

in_section = "Pairs of shapes";
view(in_section, "Time of a pair", "pair", ["each", "contacts", "disagree", "other_depth", "recomputed"], by_bars("engine"),
  "Random pairs, every second one overlapping. robust and reference are winnow's tiers.");
view(in_section, "Error against time", "error", ERRORS, by_lines("engine", "each", "ns a pair", false, ["kind"]),
  "Each mark is a kind of pair: lower is more exact, left is faster. Errors are relative to size + |distance|; the truth is computed with 100 digits.", (row) => !("gap" in row));
view(in_section, "Errors of a kind of pair", "error", ["wrong", ...ERRORS, "normals_off", "missing", "beyond_bound", "recomputed", "each"], by_bars("engine"),
  "Half of the pairs overlap, and half nearly touch, down to a millionth of their size. wrong: verdicts.", (row) => !("gap" in row));
view(in_section, "Error against distance", "error", ERRORS, by_lines("engine", "gap", "|distance| / size, from here to ten times as much"), "", (row) => "gap" in row);
view(in_section, "robust against the best library", "narrow_best", ["speedup"], by_bars("kind"), "Times as fast as the fastest library that is right.");

in_section = "Numerical stability";
view(in_section, "Hard cases, all", "hard_cases_all", ["cases"], by_stacks("engine", "answer"),
  "Queries with results derived on paper: shapes that touch, are flat, thin, tiny, huge, far away, and bugs reported to other projects.",
  (row) => row.answer !== "of_them_verdicts");
view(in_section, "Hard cases of a family", "hard_cases", [["right", "wrong", "not_taken"], "wrong", "worst_over_allowed", "worst_error"], by_bars("engine"), "worst over allowed: above 1 is wrong.");
view(in_section, "Pairs that get harder and harder", "stability", ["worst_error", "median_error", "wrong", "missing"], by_lines("engine", "parameter", "parameter of the curve"),
  "A level line is not affected; a rising line loses digits. angle: nearly parallel edges. ratio: a small shape beside a large one. offset: far from the origin. thinness: needle triangles.");

in_section = "Motion";
view(in_section, "Time of impact of a pair", "toi", ["each", "missed", "late", "loose", "worst_gap", "median_gap"], by_bars("engine"), "late: the shapes overlap before the reported time.");
view(in_section, "Gap against time", "toi", ["worst_gap", "median_gap"], by_lines("engine", "each", "ns a pair", false, ["kind"]), "Each mark is a kind of pair.");
view(in_section, "Features of meshes", "feature", ["each", "missed", "invented"], by_bars("steps"), "");
view(in_section, "Impacts of a heap", "continuous", ["real_time", "impacts", "pairs"], by_bars("what"), "");
view(in_section, "Barriers", "barriers", ["real_time", "passed", "impacts", "fastest", "cut_short", "stretch"], by_bars("scene"), "Fast bodies, a spinning blade, a cloth on a ball. passed: objects that tunnelled, counted by brute force.");

in_section = "Queries";
view(in_section, "Time of a query", "partition", ["each", "found", "differ", "wrong", "undecided"], by_bars("engine"), "Boxes are 1, 5 and 20 mean edges wide; a near ray is 10 long. Results are compared one by one.");
view(in_section, "Time against objects found", "partition", ["each"], by_lines("engine", "found", "objects found by a query", false, ["query"]), "Each mark is a kind of query.");
view(in_section, "Rays on meshes, two tori, builds", "mesh", ["real_time", "each", "pairs", "differ", "bytes_per_triangle"], by_bars("engine"), "");

in_section = "Whole scenes";
view(in_section, "From poses to contacts", "whole_scenes", ["real_time", "touching", "points"], by_bars("engine"), "At rest, contacts are carried over; libraries that cannot do this are omitted.");
view(in_section, "Two threads over one", "scene_ratios", ["ratio"], by_bars("engine"), "");
view(in_section, "Contact levels", "scene_levels", ["real_time", "touching", "points"], by_bars("level"), "One thread; bodies move slightly.");
view(in_section, "Memory of contacts, and margins", "scene_costs", ["bytes_per_contact", "real_time", "over_none"], by_bars("level"), "");
view(in_section, "A simulation: phases of a step", "phases", ["real_time", "share"], by_stacks("shape", "phase"), "Spheres and boxes fall through a funnel of triangles. The solver is not part of winnow.");
view(in_section, "A simulation: over time", "flow", ["balance", "kinetic", "potential", "elastic", "deepest", "pairs", "points"], by_lines("shape", "seconds", "simulated time, s"),
  "The total energy (balance) must never rise; a sudden peak of depth would be a late contact.");
view(in_section, "A simulation: summary", "flows", ["deepest", "rise", "pairs", "points"], by_bars("shape"), "");
view(in_section, "Structures that must stand", "standing", ["drift", "tilt", "deepest", "settled", "kept", "points"], by_bars("structure"), "After the springs have settled, nothing should move.");

in_section = "Many processes";
view(in_section, "Ghosts of an object", "cluster_runs", ["ghosts", "sent_bytes", "messages", "imbalance", "bytes_per_object"], by_lines("scene", "ranks", "ranks"), "A ghost is the copy of an object whose box overlaps another rank's region.");

in_section = "Choice of a partition";
view(in_section, "First against later frames", "advice_ranking", ["real_time"], by_lines("partition", "first_ms", "first frame, ms", false), "Lower and further left is better.");
view(in_section, "Ranking", "advice_ranking", ["real_time", "first_ms", "bytes_per_object"], by_bars("partition"), "");
view(in_section, "What the choice is worth", "advice", ["next_over_best", "auto_over_best", "moving", "pairs_per_object"], by_bars("scene"), "The next best and the automatic choice, over the best. The table has the reasons and the code.");

in_section = "Trust";
view(in_section, "Tests that try to break winnow", "trust", ["amount"], by_bars("figure"), "Results with their date, commit and command; not from this run.");
view(in_section, "Kernels", "kernel", ["real_time"], by_bars("kernel"), "");
