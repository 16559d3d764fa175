#include "bench/report/markdown.h"

#include "bench/common/errors.h"
#include "bench/common/table.h"
#include "bench/report/page.h"
#include "bench/rows/machine.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace winnow::bench {
namespace {

const std::string kFiguresBegin = "<!-- figures -->\n";
const std::string kFiguresEnd = "<!-- end -->";

std::string line_of(const std::vector<std::string>& cells) {
  std::string line = "|";
  for (const std::string& one : cells) line += one.empty() ? " |" : " " + one + " |";
  return line + "\n";
}

std::string table_of(const std::vector<std::string>& header,
                     const std::vector<std::vector<std::string>>& rows) {
  std::string text = line_of(header) + "|";
  for (std::size_t i = 0; i < header.size(); ++i) text += "---|";
  text += "\n";
  for (const auto& row : rows) text += line_of(row);
  return text + "\n";
}

/// The document in the making.
class Markdown {
 public:
  explicit Markdown(const Results& results)
      : results_(results), isa_(results.document()["machine"]["isa"]) {}

  void heading(const std::string& text) { text_ += "## " + text + "\n\n"; }
  void paragraph(const std::string& text) { text_ += text + "\n\n"; }

  void table(const std::string& text) { text_ += text; }
  /// The best of each column is bold.
  void add(const Pivot& of) {
    const PageTable table = pivot(results_, of);
    if (table.rows.empty()) return;
    std::vector<std::string> header = table.header;
    header.front() = table.caption;
    std::vector<std::vector<std::string>> rows;
    for (const auto& row : table.rows) {
      rows.emplace_back();
      for (const PageCell& one : row)
        rows.back().push_back(one.best ? "**" + one.text + "**" : one.text);
    }
    text_ += table_of(header, rows);
  }

  /// Rows as they are: all keys, and these values.
  void add_rows(const std::string& name, const std::vector<std::string>& values) {
    const Json* table = results_.table(name);
    const auto found = results_.rows(name);
    if (found.empty()) return;
    std::vector<std::string> header;
    for (const Json& key : (*table)["keys"]) header.push_back(key);
    for (const std::string& value : values) {
      header.push_back(heading_of(*results_.column(name, value)));
    }
    std::vector<std::vector<std::string>> rows;
    for (const Json* row : found) {
      rows.emplace_back();
      for (const std::string key : (*table)["keys"]) rows.back().push_back(key_text((*row)[key]));
      for (const std::string& value : values) {
        rows.back().push_back(cell(results_, name, row, value).text);
      }
    }
    text_ += table_of(header, rows);
  }

  /// A table of one value by partition and scene at the largest size.
  void add_largest(const std::string& table, const std::string& value, Json where,
                   const std::string& caption) {
    const Json size = largest(table);
    if (size.is_null()) return;
    if (results_.row(table, {{"objects", size}, {"isa", isa_}}) != nullptr) where["isa"] = isa_;
    where["objects"] = size;
    add({table, where, "partition", "scene", value,
         caption + ", " + grouped(size.get<std::size_t>()) + " objects"});
  }

  [[nodiscard]] Json largest(const std::string& table) const {
    const auto sizes = distinct(results_.rows(table), "objects");
    return sizes.empty() ? Json() : *std::max_element(sizes.begin(), sizes.end());
  }
  [[nodiscard]] const Results& results() const noexcept { return results_; }
  [[nodiscard]] const Json& isa() const noexcept { return isa_; }
  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  const Results& results_;
  Json isa_;
  std::string text_;
};

void add_throughput(Markdown& to) {
  to.heading("Frames");
  to.paragraph(
      "Milliseconds of a frame: boxes that moved are brought in, and all pairs written to an "
      "array. "
      "Of other libraries Embree uses all threads, and CGAL where that is faster for it.");
  const auto rows = to.results().rows("throughput", {{"isa", to.isa()}});
  for (const Json& objects : distinct(rows, "objects")) {
    for (const Json& threads : distinct(rows, "threads")) {
      const Json where{{"objects", objects}, {"threads", threads}, {"isa", to.isa()}};
      to.add(
          {"throughput", where, "partition", "scene", "frame_ms",
           grouped(objects.get<std::size_t>()) + " objects, " + threads_text(threads.get<int>())});
    }
  }
  const Json one{{"threads", 1}};
  to.add_largest("throughput", "first_ms", one, "first frame, which builds, ms, 1 thread");
  to.add_largest("throughput", "bytes_per_object", one, "bytes an object, 1 thread");
  to.add_largest("throughput_simd", "speedup", one,
                 "times as fast as the narrowest instruction set");
  to.add_largest("throughput_threads", "speedup", Json::object(), "times as fast as on 1 thread");
  to.add({"throughput_growth", one, "partition", "scene", "exponent",
          "time = a * objects^exponent, 1 thread"});
  for (const char* mode : {"bulk", "single"}) {
    to.add({"keys",
            {{"order", "insertion"}, {"mode", mode}},
            "partition",
            "operation",
            "ns",
            std::string("ns an object, ") + mode});
  }
}

void add_limits(Markdown& to) {
  if (to.results().rows("limits").empty()) return;
  to.heading("How far from the limit");
  to.paragraph(
      "The best partition beside what a frame must do on one thread if everything moves and "
      "nothing is "
      "kept from the frame before, each as a plain loop: boxes read, written and read again, one "
      "key "
      "an object sorted, boxes fetched in another order than they lie in, pairs written. What is "
      "kept "
      "from frame to frame takes the sort away and most of the fetching: the sum is no lower bound "
      "for a coherent scene, but what a program that starts anew in every frame cannot beat. Only "
      "`mixed` is further than 2.5 times from it, because of its tests: with 9.3 pairs an object, "
      "6.7 "
      "to 7.5 tests of 16 boxes an object are the least that any partition was brought to.");
  to.add_rows("limits", {"bandwidth_ms", "sort_ms", "permute_ms", "emission_ms", "limit_ms",
                         "partition", "frame_ms", "ratio"});
}

void add_volumes_tables(Markdown& to) {
  to.heading("Memory, volumes and margins");
  for (const Json& scene : distinct(to.results().rows("memory"), "scene")) {
    to.add({"memory",
            {{"scene", scene}},
            "partition",
            "objects",
            "reserved",
            "reserved bytes an object, " + key_text(scene)});
  }
  const Json where{{"partition", "LinearBvh"}};
  for (const char* value : {"false_positives", "found_ms", "sum_ms", "pays_from_ns"}) {
    to.add({"volumes", where, "volume", "objects_are", value});
  }
  to.paragraph("Rotated cubes with a margin, by the edges that they go in a frame:");
  to.add({"margins", Json::object(), "volume", "step", "broad_ms", "broad phase, ms"});
}

void add_pairs(Markdown& to) {
  to.heading("Pairs of shapes");
  for (const char* level : {"boolean", "distance", "manifold"}) {
    to.add({"narrow_speed",
            {{"level", level}},
            "kind",
            "engine",
            "ns",
            std::string("ns a pair, ") + level,
            false});
  }
  to.add_rows("narrow_best", {"best_peer", "speedup"});
  const Json distance{{"level", "distance"}};
  to.add({"narrow_error", distance, "kind", "engine", "wrong", "wrong verdicts, distance", false});
  to.add({"narrow_error", distance, "kind", "engine", "worst_error",
          "worst error of the distance over the size", false});
  to.add({"hard_cases_all", Json::object(), "engine", "answer", "cases", "hard cases", false});
}

void add_queries_tables(Markdown& to) {
  to.heading("Queries");
  for (const Json& scene : distinct(to.results().rows("queries"), "scene")) {
    for (const char* asked : {"single", "batch"}) {
      to.add({"queries",
              {{"scene", scene}, {"asked", asked}, {"threads", 1}},
              "engine",
              "set",
              "ns",
              "ns a question, " + key_text(scene) + ", " + asked});
    }
  }
  to.add({"frusta", Json::object(), "engine", "set", "ms", "ms a frustum", false});
}

void add_pipeline_tables(Markdown& to) {
  to.heading("Whole scenes, meshes, a simulation");
  to.add_rows("whole_scenes", {"bodies", "triangles", "ms", "touching", "points"});
  to.add(
      {"scene_levels", Json::object(), "level", "scene", "ms", "ms by how much is asked", false});
  to.add({"tori", Json::object(), "engine", "pose", "ms", "two tori, ms by pose"});
  to.add_rows("mesh_builds", {"ms", "bytes_per_triangle"});
  to.add({"phases", Json::object(), "phase", "shape", "ms", "granular flow, ms a step", false});
}

/// One line of the main figures: winnow's row, and the best of other libraries.
struct MainFigure {
  std::string what;
  const Json* own = nullptr;
  const Json* peer = nullptr;
  std::string value;  ///< of both
  std::string unit;
};

/// The least value among rows of winnow, or of other libraries.
const Json* least_of(const Results& results, const std::string& table, const Json& where,
                     const std::string& key, const std::string& value, bool peers) {
  const Json* best = nullptr;
  for (const Json* row : results.rows(table, where)) {
    if (is_peer((*row)[key].get<std::string>()) != peers || row->value("right", "yes") != "yes")
      continue;
    if (best == nullptr || value_of(*row, value) < value_of(*best, value)) best = row;
  }
  return best;
}

std::vector<MainFigure> main_figures(const Results& results) {
  std::vector<MainFigure> figures;
  const auto add = [&](const std::string& what, const std::string& table, const Json& where,
                       const std::string& key, const std::string& value, const std::string& unit) {
    figures.push_back({what, least_of(results, table, where, key, value, false),
                       least_of(results, table, where, key, value, true), value, unit});
  };
  const auto frames = results.rows("throughput", {{"isa", results.document()["machine"]["isa"]}});
  const auto sizes = distinct(frames, "objects");
  const auto threads = distinct(frames, "threads");
  for (const Json& scene : distinct(frames, "scene")) {
    const Json where{{"scene", scene},
                     {"objects", *std::max_element(sizes.begin(), sizes.end())},
                     {"threads", *std::max_element(threads.begin(), threads.end())}};
    add(key_text(scene) + ", " + grouped(where["objects"].get<std::size_t>()) + " boxes, " +
            threads_text(where["threads"].get<int>()),
        "throughput", where, "partition", "frame_ms", "ms a frame");
  }
  for (const char* set : {"ray closest", "ray all near", "box 5"}) {
    add(std::string(set) + ", 1 thread", "queries",
        {{"scene", "uniform"}, {"set", set}, {"asked", "single"}, {"threads", 1}}, "engine", "ns",
        "ns a question");
  }
  for (const char* kind : {"sphere-capsule", "box-box", "hull16-hull16"}) {
    add(std::string(kind) + " manifold, 1 thread", "narrow_speed",
        {{"kind", kind}, {"level", "manifold"}}, "engine", "ns", "ns a pair");
    figures.back().own =
        results.row("narrow_speed", {{"kind", kind}, {"level", "manifold"}, {"engine", "robust"}});
  }
  for (const char* scene : {"pile", "terrain"}) {
    add(std::string(scene) + " of bodies, moving, 1 thread", "whole_scenes",
        {{"scene", scene}, {"motion", "moving a little"}, {"threads", 1}}, "engine", "ms",
        "ms a frame");
  }
  std::erase_if(figures, [](const MainFigure& one) { return one.own == nullptr; });
  return figures;
}

std::string figures_table(const Results& results) {
  std::vector<std::vector<std::string>> rows;
  for (const MainFigure& one : main_figures(results)) {
    const auto name = [](const Json& row) {
      return key_text(row.contains("partition") ? row["partition"] : row["engine"]);
    };
    const double own = value_of(*one.own, one.value);
    const double peer = one.peer == nullptr ? std::numeric_limits<double>::quiet_NaN()
                                            : value_of(*one.peer, one.value);
    rows.push_back(
        {one.what, one.unit, shown(own, "number") + " (" + name(*one.own) + ")",
         one.peer == nullptr ? "-" : shown(peer, "number") + " (" + name(*one.peer) + ")",
         std::isnan(peer) ? "-" : shown(peer / own, "number")});
  }
  return table_of({"what", "unit", "winnow", "best other library", "times"}, rows);
}

/// Every partition and library on every scene, at the largest size and on most threads.
std::string frames_table(const Results& results) {
  const auto all = results.rows("throughput", {{"isa", results.document()["machine"]["isa"]}});
  if (all.empty()) throw ArgumentError("the results have no frames to show");
  const auto most = [&](const char* key) {
    const auto values = distinct(all, key);
    return *std::max_element(values.begin(), values.end());
  };
  Json where{{"isa", results.document()["machine"]["isa"]},
             {"objects", most("objects")},
             {"threads", most("threads")}};
  PageTable table = pivot(results, {"throughput", where, "partition", "scene", "frame_ms"});
  table.header.front() = grouped(where["objects"].get<std::size_t>()) + " objects, " +
                         threads_text(where["threads"].get<int>());
  table.header.emplace_back("most bytes/object");
  std::vector<std::vector<std::string>> rows;
  for (const auto& row : table.rows) {
    const std::string name = row.front().text;
    rows.push_back({is_peer(name) ? name : "`" + name + "`"});
    for (std::size_t c = 1; c < row.size(); ++c) rows.back().push_back(row[c].text);
    where["partition"] = name;
    double bytes = 0.0;
    for (const Json* one : results.rows("throughput", where)) {
      bytes = std::fmax(bytes, value_of(*one, "bytes_per_object"));
    }
    rows.back().push_back(shown(bytes, "number"));
  }
  return table_of(table.header, rows);
}

std::string machine_text(const Results& results) {
  const Json& machine = results.document()["machine"];
  std::string text;
  for (const char* fact : {"processor", "cores", "isa", "commit"}) {
    text += (text.empty() ? "" : ", ") + key_text(machine.value(fact, Json("unknown"))) +
            (fact == std::string("cores") ? " cores" : "");
  }
  return text;
}

}  // namespace

std::string results_markdown(const Results& results) {
  Markdown to(results);
  to.paragraph("# Results");
  to.paragraph(
      "One run of `bench/run --with-peers report` (" + machine_text(results) +
      "), written by `bench/run results` from `bench/results/results.json`, in which every "
      "figure is a row. Other libraries are Debian packages at their best settings and with "
      "`-O3 -march=native`. Times are medians; the best of a column is bold.");
  to.heading("Main figures");
  to.table(figures_table(results));
  add_throughput(to);
  add_limits(to);
  add_volumes_tables(to);
  add_pairs(to);
  add_queries_tables(to);
  add_pipeline_tables(to);
  to.heading("Which partition");
  to.add_rows("advice", {"take", "next", "next_over_best", "auto_holds", "auto_over_best"});
  std::string text = to.text();
  while (text.ends_with("\n\n")) text.pop_back();
  return text;
}

std::string with_figures(const std::string& text, const Results& results) {
  const std::size_t begin = text.find(kFiguresBegin);
  if (begin == std::string::npos) return text;
  const std::size_t from = begin + kFiguresBegin.size();
  const std::size_t end = text.find(kFiguresEnd, from);
  if (end == std::string::npos) throw ArgumentError("figures without an end: " + kFiguresEnd);
  const std::string figures = "One run of `bench/run --with-peers report` (" +
                              machine_text(results) +
                              ").\nOf other libraries, at their best settings, Embree uses all "
                              "threads, and CGAL where that is "
                              "faster:\n\n" +
                              frames_table(results);
  return text.substr(0, from) + figures + text.substr(end);
}

}  // namespace winnow::bench
