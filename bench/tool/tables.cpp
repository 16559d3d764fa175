#include "report/readme.h"
#include "tool/command.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iostream>
#include <iterator>
#include <sstream>

namespace winnow::bench {
namespace {

struct Tables {
  std::string results = "bench/results/results.json";
  std::string readme = "README.md";
  bool check = false;

  int run() const;
};

std::string readme_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw ArgumentError(path + " cannot be read");
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The first line in which they differ.
void print_difference(const std::string& path, const std::string& is, const std::string& should) {
  std::istringstream is_lines(is);
  std::istringstream should_lines(should);
  std::string is_line;
  std::string should_line;
  for (std::size_t number = 1;; ++number) {
    const bool more = static_cast<bool>(std::getline(is_lines, is_line));
    const bool more_should = static_cast<bool>(std::getline(should_lines, should_line));
    if (more && more_should && is_line == should_line) continue;
    std::cout << path << ":" << number
              << " is not what the results say\n  is:     " << (more ? is_line : "the end")
              << "\n  should: " << (more_should ? should_line : "the end")
              << "\nbench/run tables writes it anew\n";
    return;
  }
}

int Tables::run() const {
  const std::string is = readme_text(readme);
  const std::string should = readme_with_tables(is, read_results(results));
  if (is == should) return kDone;
  if (check) {
    print_difference(readme, is, should);
    return kFailed;
  }
  std::ofstream file(readme, std::ios::binary);
  file << should;
  file.close();
  if (!file) throw ArgumentError("cannot write " + readme + ": " + std::strerror(errno));
  std::cout << readme << ": tables written anew\n";
  return kDone;
}

}  // namespace

Command add_tables(CLI::App& app) {
  auto tables = std::make_shared<Tables>();
  CLI::App* sub = app.add_subcommand(
      "tables", "Writes the tables of figures in the readme anew, from a report's results.json");
  sub->add_option("results", tables->results, "results.json of a report")->capture_default_str();
  sub->add_option("readme", tables->readme, "A text with \"<!-- table NAME -->\" in it")
      ->capture_default_str();
  sub->add_flag("--check", tables->check,
                "Change nothing: end with 1 if a table is not what the results say");
  return {sub, [tables] { return tables->run(); }};
}

}  // namespace winnow::bench
