#include "bench/commands/options.h"
#include "bench/commands/rows_command.h"
#include "bench/questions/questions.h"
#include "bench/rows/hard_case_rows.h"

#include <filesystem>
#include <iostream>
#include <map>

namespace winnow::bench {
namespace {

const std::map<std::string, NarrowTier> kTiersByName{{"robust", NarrowTier::robust},
                                                     {"reference", NarrowTier::reference}};

Json read_questions(const std::string& path) {
  Json questions = read_json(path);
  if (!questions.is_array()) throw ArgumentError(path + ": not an array of questions");
  return questions;
}

class Query final : public RowsCommand {
 public:
  void add_options(CLI::App& app) {
    app.add_option("file", file_, "JSON: an array of questions")->required();
    option(app, "--tier", tier_, "Tier: robust or reference")->check(CLI::IsMember(kTiersByName));
    app.add_flag("--judge", judge_,
                 "For files of hard cases with expected results: count the correct answers of each "
                 "tier and of other libraries, instead of answering");
    add_rows_options(app);
  }

 private:
  void measure() override {
    const Json questions = read_questions(file_);
    if (!judge_) {
      answers_ = answer(questions, kTiersByName.at(tier_));
      if (!is_written()) std::cout << answers_.dump(1) << '\n';
      return;
    }
    plan(1);
    step(file_, [&] {
      add_hard_cases(results, std::filesystem::path(file_).stem().string(), questions, true);
    });
    print("hard_cases");
  }
  [[nodiscard]] Json document() override {
    return judge_ ? RowsCommand::document() : answers_;
  }

  std::string file_;
  std::string tier_ = "robust";
  bool judge_ = false;
  Json answers_;
};

}  // namespace

Command add_query(CLI::App& app) {
  return command<Query>(app, "query",
                        "Answers a JSON file of questions about pairs of shapes, rays and motions "
                        "(see pipeline/FORMATS.md)");
}

}  // namespace winnow::bench
