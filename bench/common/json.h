#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace winnow::bench {

/// Members stay in the order in which they are written.
using Json = nlohmann::ordered_json;

/// Writes to a file; does nothing for an empty path. Throws ArgumentError if it cannot.
void write_json(const std::string& path, const Json& value);

}  // namespace winnow::bench
