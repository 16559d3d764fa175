#include "bench/trust/ledger.h"

namespace winnow::bench {

const Json& ledger() {
  static const Json document = Json::parse(kLedgerJson);
  return document;
}

void declare_ledger(Results& results) {
  const auto text = [](const char* name, const char* label) {
    return ValueColumn{name, label, "", Better::neither, Format::text};
  };
  results.declare(
      {"trust",
       "trust",
       "what was found, when, of which commit and by what",
       {"row", "figure"},
       {text("value", "found"), text("date", "on"), text("commit", "of"), text("made_by", "by")}});
}

void add_ledger(Results& results) {
  for (const Json& row : ledger()["rows"]) {
    for (const Json& figure : row["figures"]) {
      results.add("trust", {{"row", row["name"]},
                            {"figure", figure["name"]},
                            {"value", figure["value"]},
                            {"date", row["date"]},
                            {"commit", row["commit"]},
                            {"made_by", row["command"]},
                            {"command", "bench/run dev trust"}});
    }
  }
}

}  // namespace winnow::bench
