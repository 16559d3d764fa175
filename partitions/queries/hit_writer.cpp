#include <winnow/partitions/queries/hit_writer.h>

#include <algorithm>

namespace winnow {
namespace {

constexpr std::size_t kQuestionsPerTask = 64;

constexpr std::uint64_t order_of(const Pair& found) noexcept {
  return static_cast<std::uint64_t>(found.second) << 32U | found.first;
}

}  // namespace

bool HitWriter::write(HitBuffer& out, const KeyTable& keys,
                      const Column<std::uint64_t>& found) noexcept {
  if (!out.hits_.resize(found.size())) return false;
  out.start_[1] = found.size();
  for (std::size_t i = 0; i < found.size(); ++i) out.hits_[i] = to_hit(keys, found[i]);
  return true;
}

bool HitWriter::finish(HitBuffer& out, const KeyTable& keys, const Execution& execution) noexcept {
  for (std::size_t i = 1; i < out.start_.size(); ++i) out.start_[i] += out.start_[i - 1];
  Column<Pair>& found = out.found_.edit();
  if (!out.hits_.resize(found.size())) return false;
  const std::size_t questions = out.questions();
  const std::size_t tasks = (questions + kQuestionsPerTask - 1) / kQuestionsPerTask;
  execution.for_each(tasks, [&](std::size_t task) {
    const std::size_t end = std::min(questions, (task + 1) * kQuestionsPerTask);
    for (std::size_t q = task * kQuestionsPerTask; q < end; ++q) {
      std::sort(found.data() + out.start_[q], found.data() + out.start_[q + 1],
                [](const Pair& a, const Pair& b) { return order_of(a) < order_of(b); });
      for (std::size_t i = out.start_[q]; i < out.start_[q + 1]; ++i) {
        out.hits_[i] = to_hit(keys, order_of(found[i]));
      }
    }
  });
  return true;
}

}  // namespace winnow
