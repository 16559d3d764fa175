#pragma once

#include <string>

#include "tests/pipeline/pair_scenes.h"

namespace winnow::test {

/// The pair as an entry of a file for `winnow query`, to be asked again.
[[nodiscard]] std::string reproduction(const PairScene& scene, BodyPair pair);

}  // namespace winnow::test
