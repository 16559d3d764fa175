#include "bench/commands/rows_run.h"

#include "bench/common/errors.h"
#include "bench/common/json.h"
#include "bench/rows/print.h"

#include <exception>
#include <iostream>

namespace winnow::bench {

void RowsRun::step(const std::string& what, const std::function<void(Results&)>& measure) {
  progress_.step(what);
  try {
    measure(results_);
  } catch (const ArgumentError&) {
    throw;
  } catch (const std::exception& error) {
    failed_ = true;
    progress_.clear();
    std::cerr << "winnow: " << what << ": " << error.what() << '\n';
  }
}

void RowsRun::print(const std::string& table, const std::vector<std::string>& values) {
  progress_.clear();
  print_rows(std::cout, results_, table, values);
}

int RowsRun::end(const std::string& json) {
  progress_.clear();
  if (!json.empty()) write_json(json, all_rows_of(results_));
  return failed_ ? kFailed : kDone;
}

}  // namespace winnow::bench
