#include "bench/commands/options.h"
#include "bench/commands/rows_command.h"
#include "bench/questions/query_format.h"
#include "bench/questions/questions.h"
#include "bench/rows/rows.h"

#include <filesystem>
#include <iostream>
#include <map>

namespace winnow::bench {
namespace {

const std::map<std::string, NarrowTier> kTiersByName{{"robust", NarrowTier::robust},
                                                     {"reference", NarrowTier::reference}};

class Query final : public RowsCommand {
 public:
  void add_options(CLI::App& app) {
    app.add_option("file", file_, "JSON: an array of queries, in the format below")->required();
    option(app, "--tier", tier_, "Tier: robust or reference")->check(CLI::IsMember(kTiersByName));
    app.add_flag("--contacts", contacts_,
                 "Add the contacts of each pair that does not move: normals, distances, points");
    app.add_flag("--judge", judge_,
                 "For files of hard cases with expected results: count the correct answers of each "
                 "tier and of other libraries, instead of answering");
    add_rows_options(app);
  }

 private:
  void measure() override {
    const Json queries = read_json(file_);
    if (!queries.is_array()) throw ArgumentError(file_ + ": expected an array of queries");
    if (!judge_) {
      answers_ = answer(queries, kTiersByName.at(tier_), contacts_);
      explain_refusals(queries);
      if (!is_written()) std::cout << answers_.dump(1) << '\n';
      return;
    }
    plan(1);
    step(file_, [&] {
      add_hard_cases(results, std::filesystem::path(file_).stem().string(), queries, true);
    });
    print("hard_cases");
  }
  /// Prints the fault of each query without an answer, and makes the command fail if there is one.
  void explain_refusals(const Json& queries) {
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const std::string status = answers_[i]["status"];
      if (status == to_string(Status::ok)) continue;
      fail();
      std::cerr << "winnow: " << file_ << ": [" << i << "]";
      if (const auto fault = fault_of(queries[i])) {
        std::cerr << (fault->member.empty() ? "" : ".") << fault->member << ": expected "
                  << fault->expected << ", given " << fault->given;
      }
      std::cerr << " (" << status << ")\n";
    }
  }
  [[nodiscard]] Json document() override { return judge_ ? RowsCommand::document() : answers_; }

  std::string file_;
  std::string tier_ = "robust";
  bool contacts_ = false;
  bool judge_ = false;
  Json answers_;
};

}  // namespace

void add_query(CLI::App& app) {
  command<Query>(app, "query",
                 "Answers a JSON file of queries about pairs of shapes, rays and motions",
                 query_format());
}

}  // namespace winnow::bench
