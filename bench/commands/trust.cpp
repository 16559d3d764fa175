#include "bench/commands/command.h"
#include "bench/commands/options.h"
#include "bench/common/table.h"
#include "bench/trust/ledger.h"

#include <iostream>
#include <string>

namespace winnow::bench {
namespace {

struct TrustCommand {
  std::string json;

  void add_options(CLI::App& app) { add_json_option(app, json); }
  [[nodiscard]] int run() const;
};

void print(const Json& row) {
  std::cout << "\n"
            << row["name"].get<std::string>() << ": " << row["what"].get<std::string>() << "\n";
  Table table({"  figure", "found"});
  table.flush_left(1);
  for (const Json& figure : row["figures"]) {
    table.add({"  " + figure["name"].get<std::string>(), figure["value"].get<std::string>()});
  }
  std::cout << table;
  const Json& note = member(row, "note");
  if (!note.is_null()) std::cout << "  " << note.get<std::string>() << "\n";
  std::cout << "  " << row["date"].get<std::string>() << ", commit "
            << row["commit"].get<std::string>() << ": " << row["command"].get<std::string>()
            << "\n";
}

int TrustCommand::run() const {
  std::cout << "Tests that try to break winnow, and their results.\n";
  for (const Json& row : ledger()["rows"]) print(row);
  write_json(json, ledger());
  return kDone;
}

}  // namespace

void add_trust(CLI::App& app) {
  command<TrustCommand>(app, "trust",
                        "Prints the results of tests, fuzzers and checks, with their dates and the "
                        "commands that repeat them");
}

}  // namespace winnow::bench
