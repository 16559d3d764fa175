// Untrusted files of queries and hard cases are processed, or refused with an error that
// names the file and its fault.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "bench/common/errors.h"
#include "bench/common/json.h"
#include "bench/questions/hard_cases.h"
#include "bench/questions/questions.h"
#include "tests/fuzz/target.h"

namespace winnow::test {
namespace {

using bench::Json;

/// Returns whether there are numbers that JSON cannot represent. Ids are ignored: the caller
/// chooses them.
bool has_nulls(const Json& value) {
  if (value.is_array()) {
    return std::any_of(value.begin(), value.end(),
                       [](const Json& one) { return one.is_null() || has_nulls(one); });
  }
  if (!value.is_object()) return false;
  const auto members = value.items();
  return std::any_of(members.begin(), members.end(),
                     [](const auto& one) { return one.key() != "id" && has_nulls(one.value()); });
}

/// Calls the code of `winnow query` and `winnow query --judge`.
void query(const Json& questions) {
  for (const NarrowTier tier : {NarrowTier::robust, NarrowTier::reference}) {
    const Json answers = bench::answer(questions, tier);
    WINNOW_REQUIRE(answers.size() == questions.size());
    WINNOW_REQUIRE(!has_nulls(answers));
    const Json turned = bench::answer(bench::exchanged(questions), tier);
    WINNOW_REQUIRE(turned.size() == questions.size());
    for (std::size_t i = 0; i < questions.size(); ++i) {
      // If both shapes are invalid, the first shape determines the status. The two statuses may
      // therefore differ, but both are errors.
      WINNOW_REQUIRE((answers[i]["status"] == "ok") == (turned[i]["status"] == "ok"));
      if (bench::member(questions[i], "expect").is_null()) continue;
      (void)bench::check_hard_case(questions[i], answers[i], bench::guaranteed_error(tier));
    }
  }
}

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

void fuzz(std::span<const std::uint8_t> input) {
  const ScratchFile file(input, ".json");
  Json document;
  try {
    document = bench::read_json(file.path());
  } catch (const bench::ArgumentError& error) {
    WINNOW_REQUIRE(std::string(error.what()).find(file.path()) == 0);
    return;
  }
  if (document.is_array()) query(document);
}

std::vector<std::string> fuzz_seeds() {
  std::vector<std::string> seeds{"", "[]", "{}", "[[[[[[1]]]]]]", "[1e999, -1e999, \"nan\"]"};
  // Seeds that are short enough for a fuzzer: the first six queries of each file one by one, and
  // the same queries without one member and with a wrong member.
  for (const auto& entry : std::filesystem::directory_iterator(WINNOW_HARD_CASES)) {
    const std::string text = text_of(entry.path());
    const Json questions = Json::parse(text);
    for (std::size_t i = 0; i < questions.size() && i < 6; ++i) {
      seeds.push_back(Json::array({questions[i]}).dump());
      // Removes or replaces each member in turn.
      for (const auto& [name, value] : questions[i].items()) {
        Json less = questions[i];
        less.erase(name);
        Json other = questions[i];
        other[name] = Json::array({1});
        seeds.push_back(Json::array({less, other}).dump());
      }
    }
  }
  return seeds;
}

}  // namespace winnow::test
