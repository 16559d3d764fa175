#pragma once

#include "bench/common/json.h"
#include "bench/rows/results.h"

namespace winnow::bench {

/// Results of all tests that try to break winnow, with their dates:
///
///   { "format": "winnow trust 1", "rows": [{"name", "what", "command", "date", "commit",
///     "covers": [folders], "trees": {folder: its git tree}, "figures": [{"name", "value"}],
///     "note"}] }
///
/// `bench/trust/record` writes rows; tests/house/ledger checks that no row is too old for its code.
/// Tests are named as `Suite.test`. `note` is optional.
extern const char* const kLedgerJson;

[[nodiscard]] const Json& ledger();

void add_ledger(Results& results);

}  // namespace winnow::bench
