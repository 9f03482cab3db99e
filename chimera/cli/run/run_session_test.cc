// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/run/run_session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

namespace chimera::cli {
namespace {

/// A run that comes to its end at `end_at`, its values being the milliseconds since the start.
class FakeTarget final : public RunTarget {
 public:
  Result<void> start() override {
    return is_refused ? Result<void>(Error{ErrorCode::kRefused, {"no"}, {}}) : Result<void>();
  }
  int refuse(const Error&) override { return 7; }
  std::optional<RunEnd> advance(Nanoseconds until) override {
    now_ = std::min(until, end_at);
    if (now_ == end_at) return end;
    return until == duration ? std::optional(RunEnd::kTime) : std::nullopt;
  }
  Nanoseconds now() const override { return now_; }
  Nanoseconds printed_until() const override { return printed; }
  bool shows_values_at(RunEnd) const override { return shows_end; }
  bool draws(Nanoseconds) override { return false; }
  std::vector<Reading> read(const std::vector<std::string>& names) override {
    const double ms = static_cast<double>(now_.count / 1'000'000);
    return {names.size(), Reading{{true, std::to_string(now_.count / 1'000'000), {ms}}, "1", "0"}};
  }
  void finish(RunReport& report) override { ran = report.ran; }
  bool is_output_complete(const RunReport&) override { return is_complete; }

  bool is_refused = false, shows_end = false, is_complete = true;
  Nanoseconds duration = milliseconds(25), end_at = kNever, printed, ran;
  RunEnd end = RunEnd::kStopped;

 private:
  Nanoseconds now_;
};

/// The exit code, and the lines of --watch.
std::pair<int, std::string> run(FakeTarget& target, const std::vector<std::string>& expect = {}) {
  RunRequest request;
  request.duration = target.duration;
  request.every = milliseconds(10);
  request.watch = {"v"};
  std::vector<Expectation> expectations;
  for (const std::string& text : expect) expectations.push_back(*Expectation::with_bound(text, {20}));
  char* text = nullptr;
  std::size_t size = 0;
  std::FILE* out = ::open_memstream(&text, &size);
  const int code = RunSession(request, std::move(expectations), target, out, out).run();
  std::fclose(out);
  std::string lines(text, size);
  std::free(text);
  return {code, lines.substr(0, lines.find("\nran"))};
}

std::string watched(FakeTarget& target) {
  const std::string printed = run(target).second;
  std::string lines;
  for (std::size_t at = 0; printed.compare(at, 2, "t ") == 0;) {
    const std::size_t end = std::min(printed.find('\n', at), printed.size());
    lines += printed.substr(at, end - at) + "\n";
    at = end + 1;
    if (at >= printed.size()) break;
  }
  return lines;
}

TEST(RunSession, PrintsAtEveryPeriodUntilTheEnd) {
  FakeTarget target;
  EXPECT_EQ(watched(target), "t 0.010 s  v 10\nt 0.020 s  v 20\n");
  EXPECT_EQ(target.ran, milliseconds(25));
}

TEST(RunSession, PrintsTheEndWhereTheTargetShowsIt) {
  FakeTarget target;
  target.shows_end = true;
  EXPECT_EQ(watched(target), "t 0.010 s  v 10\nt 0.020 s  v 20\nt 0.025 s  v 25\n");
  target.end_at = milliseconds(13);
  EXPECT_EQ(watched(target), "t 0.010 s  v 10\nt 0.013 s  v 13\n");
}

TEST(RunSession, ALineThatIsDueAtTheEndIsPrintedOnce) {
  FakeTarget target;
  target.duration = milliseconds(20);
  EXPECT_EQ(watched(target), "t 0.010 s  v 10\nt 0.020 s  v 20\n");
  target.shows_end = true;
  EXPECT_EQ(watched(target), "t 0.010 s  v 10\nt 0.020 s  v 20\n");
}

TEST(RunSession, DoesNotPrintALineTwice) {
  FakeTarget target;
  target.printed = milliseconds(15);
  EXPECT_EQ(watched(target), "t 0.020 s  v 20\n");
}

TEST(RunSession, TheExitCodeIsOfStartExpectationsAndOutput) {
  FakeTarget target;
  EXPECT_EQ(run(target).first, kOk);
  EXPECT_EQ(run(target, {"v <= 20"}).first, kRefused) << "25 at the end";
  EXPECT_EQ(run(target, {"v >= 20"}).first, kOk);
  target.is_complete = false;
  EXPECT_EQ(run(target).first, kRefused);
  target.is_refused = true;
  EXPECT_EQ(run(target).first, 7);
}

}  // namespace
}  // namespace chimera::cli
