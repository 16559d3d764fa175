#include "query/questions.h"
#include "tool/arguments.h"
#include "tool/command.h"
#include "tool/measure_hard_cases.h"
#include "tool/output.h"
#include "tool/table.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>

namespace winnow::bench {
namespace {

std::string exponent_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", value);
  return std::isnan(value) ? "-" : text;
}

const std::map<std::string, NarrowTier> kTiers{{"fast", NarrowTier::fast},
                                               {"robust", NarrowTier::robust},
                                               {"reference", NarrowTier::reference}};

void print_judged(const Json& questions) {
  Table table({"by", "right", "wrong", "wrong verdicts", "not taken", "worst error",
               "over what is allowed", "what"});
  table.flush_left(7);
  for (const HardCaseTally& one : judge_hard_cases(questions, true)) {
    table.add({one.engine, std::to_string(one.right), std::to_string(one.wrong),
               std::to_string(one.wrong_verdicts), std::to_string(one.not_taken),
               exponent_number(one.worst_error), exponent_number(one.worst_over_allowed),
               one.faults_text()});
  }
  std::cout << table;
}

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
      print_judged(questions);
      return kDone;
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
