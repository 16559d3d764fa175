#include "bench/trust/ledger.h"

namespace winnow::bench {

const Json& ledger() {
  static const Json document = Json::parse(kLedgerJson);
  return document;
}

void add_ledger(Results& results) {
  for (const Json& row : ledger()["rows"]) {
    for (const Json& figure : row["figures"]) {
      results.add("trust", {{"row", row["name"]},
                            {"figure", figure["name"]},
                            {"value", figure["value"]},
                            {"date", row["date"]},
                            {"commit", row["commit"]},
                            {"command", row["command"]}});
    }
  }
}

}  // namespace winnow::bench
