#include "bench/commands/arguments.h"
#include "bench/commands/command.h"
#include "bench/commands/rows_run.h"
#include "bench/common/json.h"
#include "bench/questions/questions.h"
#include "bench/rows/hard_case_rows.h"

#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>

namespace winnow::bench {
namespace {

const std::map<std::string, NarrowTier> kTiers{{"fast", NarrowTier::fast},
                                               {"robust", NarrowTier::robust},
                                               {"reference", NarrowTier::reference}};

struct Query {
  std::string file;
  std::string tier = "robust";
  Choice choice;
  std::string json;
  bool judge = false;

  [[nodiscard]] int run() const {
    choose_isa(choice.isa);
    std::ifstream in(file);
    if (!in) throw ArgumentError("cannot read " + file);
    Json questions;
    try {
      questions = Json::parse(in);
    } catch (const Json::exception& error) {
      std::cerr << "winnow: " << file << ": " << error.what() << '\n';
      return kFailed;
    }
    if (!questions.is_array()) {
      std::cerr << "winnow: " << file << ": not an array of questions\n";
      return kFailed;
    }
    if (judge) {
      RowsRun run(1);
      declare_hard_cases(run.results());
      run.step(file, [&](Results& results) {
        add_hard_cases(results, std::filesystem::path(file).stem().string(), questions, true);
      });
      run.print("hard_cases");
      return run.end(json);
    }
    const Json answers = answer(questions, kTiers.at(tier));
    if (json.empty()) {
      std::cout << answers.dump(1) << '\n';
    } else {
      write_json(json, answers);
    }
    return kDone;
  }
};

}  // namespace

Command add_query(CLI::App& app) {
  auto query = std::make_shared<Query>();
  CLI::App* sub =
      app.add_subcommand("query", "Answers a file of questions about pairs of shapes and rays");
  sub->add_option("file", query->file, "JSON: an array of questions")->required();
  sub->add_option("--tier", query->tier, "How exact: fast, robust or reference")
      ->check(CLI::IsMember(kTiers))
      ->capture_default_str();
  sub->add_flag("--judge", query->judge,
                "Of hard cases, which say what they expect: counts what each tier and other "
                "libraries have right, instead of answering");
  add_isa_option(*sub, query->choice);
  sub->add_option("--json", query->json, "Write the answers to this file instead of printing them");
  return {sub, [query] { return query->run(); }};
}

}  // namespace winnow::bench
