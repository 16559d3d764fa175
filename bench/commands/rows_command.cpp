#include "bench/commands/rows_command.h"

#include "bench/commands/options.h"
#include "bench/common/json.h"
#include "bench/rows/machine.h"

#include <exception>
#include <iostream>

namespace winnow::bench {

void RowsCommand::add_rows_options(CLI::App& app) {
  add_isa_option(app, isa_);
  add_json_option(app, json_);
}

int RowsCommand::run() {
  choose_isa(isa_);
  results = Results();  // must be made after the instruction set is chosen, which it stores
  measure();
  if (!json_.empty()) write_json(json_, document());
  return failed_ ? kFailed : kDone;
}

void RowsCommand::step(const std::string& what, const std::function<void()>& measure_rows) {
  progress_->step(what);
  try {
    measure_rows();
  } catch (const ArgumentError&) {
    throw;
  } catch (const std::exception& error) {
    fail();
    progress_->clear();
    std::cerr << "winnow: " << what << ": " << error.what() << '\n';
  }
}

Json RowsCommand::document() {
  results.context() = machine_facts();
  return results.document();
}

void RowsCommand::print(const std::string& table, const std::vector<std::string>& values) {
  if (progress_) progress_->clear();
  print_rows(std::cout, results, table, values);
}

}  // namespace winnow::bench
