#include "report/report.h"
#include "tool/table.h"

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
  std::cout << text;
}

}  // namespace

void print_summary(const Results& results) {
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
  for (const Json& missing : results.document()["missing"]) {
    std::cout << missing.get<std::string>() << '\n';
  }
  for (const Json& problem : results.document()["problems"]) {
    std::cout << "problem: " << problem.get<std::string>() << '\n';
  }
}

}  // namespace winnow::bench
