#include "bench/common/table.h"
#include "bench/report/report.h"

#include <iostream>

namespace winnow::bench {
namespace {

/// The best of each column of a pivot, with its row's name.
void print_best(const PageTable& table) {
  if (table.rows.empty()) return;
  std::vector<std::string> names{"best"};
  std::vector<std::string> values{table.caption};
  for (std::size_t c = 1; c < table.header.size(); ++c) {
    std::string name = "-";
    std::string value = "-";
    for (const auto& row : table.rows) {
      if (!row[c].best) continue;
      name = row.front().text;
      value = row[c].text;
    }
    names.push_back(name);
    values.push_back(value);
  }
  Table text(table.header);
  text.add(std::move(names));
  text.add(std::move(values));
  std::cout << '\n' << text;
}

void print_all(const PageTable& table) {
  if (table.rows.empty()) return;
  Table text(table.header);
  for (const auto& row : table.rows) {
    std::vector<std::string> cells;
    for (const PageCell& one : row) cells.push_back(one.text);
    text.add(std::move(cells));
  }
  std::cout << '\n' << table.caption << '\n' << text;
}

/// The last text of a key among the rows of a table: of the largest size, of most threads.
Json last_of(const Results& results, const std::string& table, const std::string& key) {
  const auto all = distinct(results.rows(table), key);
  return all.empty() ? Json() : all.back();
}

void print_throughput(const Results& results) {
  const auto rows = results.rows("throughput");
  for (const Json& objects : distinct(rows, "objects")) {
    for (const Json& threads : distinct(rows, "threads")) {
      const Json where{{"objects", objects},
                       {"threads", threads},
                       {"isa", results.document()["machine"]["isa"]}};
      PageTable best = pivot(results, {"throughput", where, "partition", "scene", "frame_ms"});
      if (best.rows.empty()) continue;
      best.header.front() = grouped(objects.get<std::size_t>()) + " objects, " + key_text(threads) +
                            (threads == 1 ? " thread" : " threads");
      print_best(best);
    }
  }
}

void print_speed_against_error(const Results& results) {
  print_all(pivot(results, {"memory",
                            {{"scene", last_of(results, "memory", "scene")},
                             {"threads", last_of(results, "memory", "threads")}},
                            "partition",
                            "objects",
                            "reserved",
                            "memory, bytes/object"}));
  print_all(pivot(results, {"volumes",
                            {{"partition", "LinearBvh"}},
                            "volume",
                            "objects_are",
                            "sum_ms",
                            "volumes: made, asked and tested exactly, ms a frame"}));
  const Json distances{{"level", "distance"}};
  print_all(pivot(results, {"narrow_error", distances, "kind", "engine", "ns",
                            "pairs of shapes, distance and points, ns/pair"}));
  print_all(pivot(
      results, {"narrow_error", distances, "kind", "engine", "wrong", "the same, wrong verdicts"}));
  print_all(pivot(results,
                  {"hard_cases_all", Json::object(), "engine", "answer", "cases", "hard cases"}));
}

void print_queries(const Results& results) {
  for (const Json& scene : distinct(results.rows("queries"), "scene")) {
    PageTable best = pivot(results, {"queries",
                                     {{"scene", scene}, {"asked", "single"}, {"threads", 1}},
                                     "engine",
                                     "set",
                                     "ns"});
    if (best.rows.empty()) continue;
    best.header.front() = "questions to " + key_text(scene);
    print_best(best);
  }
}

void print_advice(const Results& results) {
  const auto rows = results.rows("advice");
  if (rows.empty()) return;
  Table text({"take", "for", "objects", "threads"});
  for (const Json* row : rows) {
    text.add({row->value("take", "-"), key_text((*row)["scene"]),
              grouped((*row)["objects"].get<std::size_t>()), key_text((*row)["threads"])});
  }
  std::cout << '\n' << text;
}

}  // namespace

void print_summary(const Results& results) {
  print_throughput(results);
  print_speed_against_error(results);
  print_queries(results);
  print_advice(results);
  std::cout << '\n';
  for (const Json& missing : results.document()["missing"]) {
    std::cout << missing.get<std::string>() << '\n';
  }
  for (const Json& problem : results.document()["problems"]) {
    std::cout << "problem: " << problem.get<std::string>() << '\n';
  }
}

}  // namespace winnow::bench
