#include "bench/commands/command.h"
#include "bench/commands/options.h"
#include "bench/report/markdown.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iostream>
#include <iterator>
#include <sstream>

namespace winnow::bench {
namespace {

struct ResultsCommand {
  std::string from = "bench/results/results.json";
  std::string out = "bench/RESULTS.md";
  std::string readme = "README.md";
  bool check = false;

  void add_options(CLI::App& app) {
    option(app, "results", from, "results.json of a report");
    option(app, "--out", out, "Markdown file to write, with all tables");
    option(app, "--readme", readme,
           "File whose text between \"<!-- figures -->\" and \"<!-- end -->\" is replaced by one "
           "table");
    app.add_flag("--check", check,
                 "Change nothing; exit status 1 if a figure differs from the results");
  }
  [[nodiscard]] int run() const;

 private:
  [[nodiscard]] bool keep(const std::string& path, const std::string& is,
                          const std::string& should) const;
};

/// Returns the text, or an empty one if there is no such file.
std::string file_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Prints the first line that differs.
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
              << " differs from the results\n  is:     " << (more ? is_line : "the end")
              << "\n  should: " << (more_should ? should_line : "the end")
              << "\nrun `bench/run dev results` to write it again\n";
    return;
  }
}

/// Writes `should` unless the file has that text already. With --check nothing is written; returns
/// false if the text differs.
bool ResultsCommand::keep(const std::string& path, const std::string& is,
                          const std::string& should) const {
  if (is == should) return true;
  if (check) {
    print_difference(path, is, should);
    return false;
  }
  std::ofstream file(path, std::ios::binary);
  file << should;
  file.close();
  if (!file) throw ArgumentError("cannot write " + path + ": " + std::strerror(errno));
  std::cout << path << ": written\n";
  return true;
}

int ResultsCommand::run() const {
  const Results results = read_results(from);
  const bool same = keep(out, file_text(out), results_markdown(results));
  const std::string text = file_text(readme);
  if (text.empty()) throw ArgumentError(readme + " cannot be read");
  return keep(readme, text, with_figures(text, results)) && same ? kDone : kFailed;
}

}  // namespace

void add_results(CLI::App& app) {
  command<ResultsCommand>(app, "results",
                          "Writes the tables of a report's results.json as Markdown, and its main "
                          "figures into README.md");
}

}  // namespace winnow::bench
