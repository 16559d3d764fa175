// Computes the recommendation at the top of a report: ranks the partitions by the geometric mean of
// their frame times relative to the fastest of each race, and formats the sentences.

#include "bench/report/recommendation.h"

#include "bench/common/table.h"
#include "bench/peers/yardstick.h"
#include "bench/rows/machine.h"
#include "bench/rows/template_text.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <vector>

namespace winnow::bench {
namespace {

constexpr const char* kRanking = "advice_ranking";
constexpr const char* kChoosesItself = "AutoPartition";
// A ratio below this may be reversed by another run.
constexpr double kTooClose = 1.05;
constexpr double kNone = std::numeric_limits<double>::infinity();

/// Results of one partition over all races.
struct Record {
  std::string partition;
  std::size_t races = 0;
  std::size_t won = 0;
  double worst = 1.0;
  double log_sum = 0.0;

  void add(double ratio) {
    ++races;
    won += ratio <= 1.0 ? 1 : 0;
    worst = std::max(worst, ratio);
    log_sum += std::log(ratio);
  }
  [[nodiscard]] double mean() const { return std::exp(log_sum / static_cast<double>(races)); }
};

std::string plain(double value) {
  return shown(value, "number");
}

/// Returns the key of a race: scene, objects and threads.
std::string race_of(const Json& row) {
  return key_text(row["scene"]) + "/" + key_text(row["objects"]) + "/" + key_text(row["threads"]);
}

/// Partitions that ran in every race, best first. AutoPartition is kept apart in `chooser`.
struct Standings {
  std::vector<Record> chosen;
  std::optional<Record> chooser;
  std::size_t races = 0;
};

Standings standings_of(const std::vector<const Json*>& rows) {
  std::map<std::string, double> best;
  for (const Json* row : rows) {
    if ((*row)["partition"] == kChoosesItself) continue;
    double& least = best.try_emplace(race_of(*row), kNone).first->second;
    least = std::min(least, value_of(*row, "frame_ms"));
  }
  std::map<std::string, Record> records;
  for (const Json* row : rows) {
    const auto least = best.find(race_of(*row));
    const double ms = value_of(*row, "frame_ms");
    if (least == best.end() || !(least->second > 0.0) || !std::isfinite(ms)) continue;
    const std::string name = (*row)["partition"];
    Record& record = records.try_emplace(name, Record{name}).first->second;
    record.add(ms / least->second);
  }
  Standings standings;
  standings.races = best.size();
  for (const auto& [name, record] : records) {
    if (record.races != best.size()) continue;
    if (name == kChoosesItself) {
      standings.chooser = record;
    } else {
      standings.chosen.push_back(record);
    }
  }
  std::stable_sort(standings.chosen.begin(), standings.chosen.end(),
                   [](const Record& a, const Record& b) { return a.log_sum < b.log_sum; });
  return standings;
}

std::string because(const Record& best, const std::vector<const Json*>& rows) {
  const auto all = [&](const std::string& key) {
    std::vector<std::string> texts;
    for (const Json& value : distinct(rows, key)) texts.push_back(member_text(key, value));
    return listed(texts);
  };
  const std::string where = all("scene") + "; " + all("objects") + " objects; " + all("threads");
  if (best.races == 1) return "no partition takes less time for a frame (" + where + ")";
  std::string text = "it takes the least time for a frame in " + grouped(best.won) + " of " +
                     grouped(best.races) + " races";
  if (best.won < best.races) {
    text += " and at most " + plain(best.worst) + " times the least in the others";
  }
  return text + " (" + where + ")";
}

/// Formats the range of a value over rows, for example "0.21 to 1.3".
std::string range_of(const std::vector<const Json*>& rows, const std::string& value) {
  double low = kNone;
  double high = -kNone;
  for (const Json* row : rows) {
    const double x = value_of(*row, value);
    if (!std::isfinite(x)) continue;
    low = std::min(low, x);
    high = std::max(high, x);
  }
  if (!(low <= high)) return "-";
  const std::string from = plain(low);
  const std::string to = plain(high);
  return from == to ? from : from + " to " + to;
}

/// Keeps the rows with the most objects and the fewest threads.
std::vector<const Json*> largest(std::vector<const Json*> rows) {
  const auto keep = [&](const std::string& key, const auto& better) {
    const auto values = distinct(rows, key);
    if (values.empty()) return;
    const Json kept = *std::min_element(values.begin(), values.end(), better);
    std::erase_if(rows, [&](const Json* row) { return (*row)[key] != kept; });
  };
  keep("objects", std::greater<>());
  keep("threads", std::less<>());
  return rows;
}

std::string price(const std::vector<const Json*>& all) {
  const auto rows = largest(all);
  if (rows.empty()) return "";
  const Json& any = *rows.front();
  return range_of(rows, "frame_ms") + " ms a frame and " + range_of(rows, "first_ms") +
         " ms for the first one, " + range_of(rows, "bytes_per_object") + " bytes an object (" +
         member_text("objects", any["objects"]) + " objects, " +
         member_text("threads", any["threads"]) + ")";
}

std::string next(const std::vector<Record>& chosen) {
  if (chosen.size() < 2) return "";
  const double times = chosen[1].mean() / chosen[0].mean();
  if (times < kTooClose) return chosen[1].partition + ", too close to rank";
  return chosen[1].partition + ", " + plain(times) + " times its time on average";
}

bool is_library(const Json& row) {
  const std::string name = row["partition"];
  return is_peer(name) && name != kYardstickName;
}

/// Compares the partition with the fastest other library of each scene, at the largest number of
/// objects that other libraries were measured with.
std::string others(const Results& results, const std::string& take) {
  auto of_others = results.rows("throughput", {{"isa", results.document()["machine"]["isa"]}});
  std::erase_if(of_others, [](const Json* row) { return !is_library(*row); });
  of_others = largest(of_others);
  if (of_others.empty()) return "";
  const Json& any = *of_others.front();
  const auto rows =
      results.rows("throughput",
                   {{"isa", any["isa"]}, {"objects", any["objects"]}, {"threads", any["threads"]}});
  double least = kNone;
  double most = 0.0;
  std::vector<std::string> fastest;
  for (const Json& scene : distinct(rows, "scene")) {
    double own = kNone;
    double best = kNone;
    std::string name;
    for (const Json* row : rows) {
      if ((*row)["scene"] != scene) continue;
      const double ms = value_of(*row, "frame_ms");
      if ((*row)["partition"] == take) own = ms;
      if (!is_library(*row) || !(ms < best)) continue;
      best = ms;
      name = (*row)["partition"];
    }
    if (!std::isfinite(own) || name.empty()) continue;
    least = std::min(least, best / own);
    most = std::max(most, best / own);
    if (std::ranges::find(fastest, name) == fastest.end()) fastest.push_back(name);
  }
  if (fastest.empty()) return "";
  return "the fastest of each scene takes " + plain(least) +
         (least < most ? " to " + plain(most) : "") + " times its time (" + listed(fastest) + "; " +
         member_text("objects", any["objects"]) + " objects, " +
         member_text("threads", any["threads"]) + ")";
}

}  // namespace

std::optional<Recommendation> recommend(const Results& results) {
  const auto rows = results.rows(kRanking);
  const Standings standings = standings_of(rows);
  if (standings.chosen.empty()) return std::nullopt;
  const Record& best = standings.chosen.front();
  Recommendation recommendation;
  recommendation.take = best.partition;
  recommendation.because = because(best, rows);
  recommendation.price = price(results.rows(kRanking, {{"partition", best.partition}}));
  recommendation.next = next(standings.chosen);
  if (standings.chooser) {
    recommendation.varying = std::string(kChoosesItself) + ", which chooses by itself, takes " +
                             plain(standings.chooser->mean()) +
                             " times the least on average, and at most " +
                             plain(standings.chooser->worst);
  }
  recommendation.others = others(results, best.partition);
  if (const Json* advice = results.row("advice", {{"take", best.partition}})) {
    recommendation.code = advice->value("code", "");
  }
  return recommendation;
}

}  // namespace winnow::bench
