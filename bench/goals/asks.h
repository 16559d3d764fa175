#pragma once

#include <array>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// What is asked of winnow, by topic.
inline constexpr std::array<std::string_view, 6> kTopics{"engine",   "queries", "narrow",
                                                         "pipeline", "choice",  "report"};

/// The text of goals/goals.json.
extern const char* const kGoalsJson;

/// One entry of goals.json: a kind, which says how it is measured, and that kind's parameters.
/// The getters throw, naming the entry, if a member is missing or of another type.
class Ask {
 public:
  Ask(std::size_t index, nlohmann::json members);

  [[nodiscard]] const std::string& topic() const noexcept { return topic_; }
  [[nodiscard]] const std::string& kind() const noexcept { return kind_; }
  [[nodiscard]] bool has(const char* member) const { return members_.contains(member); }

  template <typename T>
  [[nodiscard]] T get(const char* member) const {
    try {
      return members_.at(member).template get<T>();
    } catch (const nlohmann::json::exception& error) {
      fail(std::string(member) + ": " + error.what());
    }
  }
  [[nodiscard]] std::string text(const char* member) const { return get<std::string>(member); }
  [[nodiscard]] double number(const char* member) const { return get<double>(member); }
  [[nodiscard]] std::size_t count(const char* member) const { return get<std::size_t>(member); }
  [[nodiscard]] int threads() const { return get<int>("threads"); }

  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::size_t index_;
  nlohmann::json members_;
  std::string topic_;
  std::string kind_;
};

/// All asks. Throws if the text is not what it should be.
[[nodiscard]] std::vector<Ask> parse_asks(std::string_view json);

}  // namespace winnow::bench
