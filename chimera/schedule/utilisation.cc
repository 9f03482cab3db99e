// SPDX-License-Identifier: Apache-2.0
#include "chimera/schedule/utilisation.h"

#include <string_view>

#include "chimera/base/assert.h"

namespace chimera {
namespace {

// Text without heap or locale.
class Line {
 public:
  Line& operator<<(std::string_view text) noexcept {
    for (const char c : text) {
      if (size_ < sizeof bytes_) bytes_[size_++] = c;
    }
    return *this;
  }
  Line& operator<<(std::int64_t number) noexcept {
    char digits[20];
    std::size_t n = 0;
    for (; number > 0 || n == 0; number /= 10) digits[n++] = static_cast<char>('0' + number % 10);
    while (n > 0) *this << std::string_view(&digits[--n], 1);
    return *this;
  }
  // Three decimals, rounded up: a sum just above the limit never reads as the limit.
  Line& operator<<(double number) noexcept {
    auto thousandths = static_cast<std::int64_t>(number * 1000.0);
    if (static_cast<double>(thousandths) < number * 1000.0 - 1e-6) ++thousandths;
    *this << thousandths / 1000 << ".";
    for (std::int64_t unit = 100, rest = thousandths % 1000; unit > 0; rest %= unit, unit /= 10) *this << rest / unit;
    return *this;
  }
  Line& operator<<(Nanoseconds time) noexcept {
    if (time.count % 1'000'000 == 0) return *this << time.count / 1'000'000 << " ms";
    if (time.count % 1'000 == 0) return *this << time.count / 1'000 << " us";
    return *this << time.count << " ns";
  }
  std::string_view view() const noexcept { return {bytes_, size_}; }

 private:
  char bytes_[400];
  std::size_t size_ = 0;
};

double share(const TaskSpec& task) noexcept {
  return static_cast<double>(task.budget.count) / static_cast<double>(task.period.count);
}

Error refusal(const Utilisation& u, const TaskSpec& largest) noexcept {
  Line text, place;
  text << "the tasks that go ON ask for " << u.sum << " of the processor, at most " << kMaxUtilisation
       << " can be promised; the largest is '" << largest.name << "' with " << share(largest) << " (" << largest.budget
       << " every " << largest.period << ")";
  const double room = kMaxUtilisation - (u.sum - share(largest));
  const auto fits = static_cast<std::int64_t>(room * static_cast<double>(largest.period.count) / 1000.0);
  if (fits > 0) text << ", which fits with a budget of at most " << microseconds(fits);
  place << "cpu " << static_cast<std::int64_t>(u.cpu);
  return Error{ErrorCode::kRefused, text.view(), place.view()};
}

}  // namespace

Utilisation utilisation(std::span<const TaskSpec> tasks, std::span<const TaskId> on,
                        std::span<const std::uint32_t> cpu_of, std::uint32_t cpu) noexcept {
  Utilisation u;
  u.cpu = cpu;
  double largest = 0;
  for (const TaskId id : on) {
    const TaskSpec& task = tasks[id.index];
    CHIMERA_ASSERT(task.rtpu.index < cpu_of.size() && task.period > Nanoseconds{});
    if (cpu_of[task.rtpu.index] != cpu) continue;
    if (task.budget == Nanoseconds{}) ++u.unstated;
    u.sum += share(task);
    if (share(task) > largest) {
      largest = share(task);
      u.largest = id;
    }
  }
  return u;
}

Result<void> admit(std::span<const TaskSpec> tasks, std::span<const TaskId> on,
                   std::span<const std::uint32_t> cpu_of) noexcept {
  for (const std::uint32_t cpu : cpu_of) {
    const Utilisation u = utilisation(tasks, on, cpu_of, cpu);
    if (u.sum > kMaxUtilisation + 1e-9) return refusal(u, tasks[u.largest.index]);
  }
  return {};
}

}  // namespace chimera
