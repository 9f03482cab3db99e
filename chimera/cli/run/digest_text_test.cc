// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/run/digest_text.h"

#include <filesystem>
#include <fstream>
#include <iterator>

#include "chimera/cli/run/run.h"
#include "chimera/cli/run/testing/test_application.h"

namespace chimera::cli::digest_text_test {
namespace {

std::string text_with(const std::string& k, const std::string& timing = "") {
  return "subsystem: small\ntasks:\n  counter: {component: t_counter, rate: 100 Hz" + timing +
         "}\n  gain: {rate: 50 Hz, constants: {k: " + k + "}}\noperator: {x: 3 rad}\n";
}

/// The digest of a run of the description, 1.5 s if nothing else is said.
std::string digest_of(const std::string& text, Nanoseconds duration = milliseconds(1500),
                      std::vector<std::string> at = {}, bool preemptive = false) {
  const TestFile file(text);
  RunRequest request;
  request.file = file.path();
  request.virtual_time = true;
  request.preemptive = preemptive;
  request.duration = duration;
  request.at = std::move(at);
  request.digest = file.path() + ".digest";
  std::FILE* out = std::tmpfile();
  EXPECT_EQ(run(request, test_place(), nullptr, out, out), kOk);
  std::fclose(out);
  std::ifstream stream(request.digest);
  const std::string digest{std::istreambuf_iterator<char>(stream), {}};
  std::filesystem::remove(request.digest);
  return digest;
}

TEST(DigestText, HasALineForEachSecondAndTask) {
  const std::string digest = digest_of(text_with("2 N.m/rad"));
  EXPECT_TRUE(digest.starts_with("second task publications faults hash\n0 counter 10")) << digest;
  EXPECT_NE(digest.find("\n0 gain 5"), std::string::npos) << digest;
  EXPECT_NE(digest.find("\n1 counter 50 0 "), std::string::npos) << digest;
  EXPECT_NE(digest.find("\n1 gain 25 0 "), std::string::npos) << digest;
  EXPECT_EQ(digest.find("\n2 "), std::string::npos) << digest;
}

TEST(DigestText, IsTheSameForTheSameRun) {
  EXPECT_EQ(digest_of(text_with("2 N.m/rad")), digest_of(text_with("2 N.m/rad")));
  EXPECT_EQ(digest_of(text_with("2 N.m/rad")), digest_of(text_with("2 N.m/rad"), milliseconds(1500), {}, true));
}

TEST(DigestText, JobsTakeNoTimeWhateverTheirBudgets) {
  const std::string once = digest_of(text_with("2 N.m/rad"));
  EXPECT_EQ(digest_of(text_with("2 N.m/rad", ", budget: 9 ms")), once);
}

TEST(DigestText, DiffersForTheLastBitOfAGainAndOneJobMore) {
  const std::string once = digest_of(text_with("2 N.m/rad"));
  EXPECT_NE(digest_of(text_with("2.0000000000000004 N.m/rad")), once);
  EXPECT_NE(digest_of(text_with("2 N.m/rad"), milliseconds(1501)), once);
  EXPECT_NE(digest_of(text_with("2 N.m/rad"), milliseconds(1500), {"1100 ms: off gain"}), once);
  EXPECT_NE(digest_of(text_with("2 N.m/rad"), milliseconds(1500), {"1100 ms: set x 4 rad"}), once);
}

}  // namespace
}  // namespace chimera::cli::digest_text_test
