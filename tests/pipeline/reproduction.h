#pragma once

#include <string>

#include "tests/pipeline/pair_scenes.h"

namespace winnow::test {

/// Returns the pair as an entry of an input file for `winnow query`.
[[nodiscard]] std::string reproduction(const PairScene& scene, BodyPair pair);

}  // namespace winnow::test
