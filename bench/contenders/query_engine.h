#pragma once

#include <winnow/core/aabb.h>
#include "bench/scenes/question_set.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>

namespace winnow::bench {

/// How questions are put: each by a call of its own, or many by one call.
enum class Asking { single, batch };

/// An engine that does not answer a question it takes; says why.
class Refusal : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Anything that answers questions about boxes: a partition of winnow or another library. The
/// harness times `run` from outside, so whatever a user would have to pay for an answer (sorting
/// hits, throwing out what does not overlap, building a structure over a batch) belongs inside.
///
/// An object is its row, 0..N-1. Calls come from one thread, inside a `tbb::task_arena` of the
/// thread count the engine was made for.
class QueryEngine {
 public:
  QueryEngine(const QueryEngine&) = delete;
  QueryEngine& operator=(const QueryEngine&) = delete;
  virtual ~QueryEngine() = default;

  /// Short and stable, e.g. "LinearBvh".
  [[nodiscard]] virtual std::string name() const = 0;

  /// True if there is a way to put these questions to it in this manner.
  [[nodiscard]] virtual bool takes(const QuestionSet& set, Asking asking) const = 0;

  /// How many questions of a set can be put to it in reasonable time.
  [[nodiscard]] virtual std::size_t most_questions() const {
    return std::numeric_limits<std::size_t>::max();
  }

  /// Takes the boxes (row = index) and makes everything ready. Called once, before any question;
  /// `boxes` outlives the engine.
  virtual void start(std::span<const Aabb> boxes) = 0;

  /// Answers the first `count` questions of the set; gives the number of objects found. Results
  /// are left where a caller could read them, and overwritten by the next question or batch.
  virtual std::uint64_t run(const QuestionSet& set, Asking asking, std::size_t count) = 0;

  /// The same, and keeps the answers. Not timed; on one thread if asked singly.
  [[nodiscard]] virtual Answers answers(const QuestionSet& set, Asking asking,
                                        std::size_t count) = 0;

 protected:
  QueryEngine() = default;
};

}  // namespace winnow::bench
