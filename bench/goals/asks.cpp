#include "goals/asks.h"

#include <algorithm>
#include <stdexcept>

namespace winnow::bench {

Ask::Ask(std::size_t index, nlohmann::json members)
    : index_(index), members_(std::move(members)), topic_(text("topic")), kind_(text("kind")) {
  if (std::find(kTopics.begin(), kTopics.end(), topic_) == kTopics.end()) {
    fail("unknown topic " + topic_);
  }
}

void Ask::fail(const std::string& what) const {
  throw std::runtime_error("goals.json, entry " + std::to_string(index_) + ": " + what);
}

std::vector<Ask> parse_asks(std::string_view json) {
  std::vector<Ask> asks;
  for (const nlohmann::json& entry : nlohmann::json::parse(json)) {
    asks.emplace_back(asks.size(), entry);
  }
  return asks;
}

}  // namespace winnow::bench
