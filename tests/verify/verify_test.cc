// SPDX-License-Identifier: Apache-2.0
// Each NAME.yaml of faulty/ and good/ is read, verified against components/, and judged for the executors; its whole
// report must be NAME.expected to the letter. UPDATE=1 writes them: read the difference before it is committed.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "chimera/analysis/schedule_report.h"
#include "chimera/base/testing/tree_path.h"
#include "chimera/catalogue/library.h"
#include "chimera/units/testing/unit_samples.h"
#include "chimera/verify/verify.h"

namespace chimera {
namespace {

namespace fs = std::filesystem;

fs::path folder() { return source_path("tests/verify"); }

const Library& library() {
  static const Library kLibrary = [] {
    const std::string folders[] = {folder() / "components"};
    Library made = Library::make(folders, our_units());
    for (const Error& fault : made.faults()) ADD_FAILURE() << fault.where.view() << ": " << fault.message.view();
    return made;
  }();
  return kLibrary;
}

std::string contents(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream out;
  out << stream.rdbuf();
  return out.str();
}

std::vector<fs::path> descriptions(const char* kind) {
  std::vector<fs::path> out;
  for (const auto& entry : fs::directory_iterator(folder() / kind))
    if (entry.path().extension() == ".yaml") out.push_back(entry.path());
  std::sort(out.begin(), out.end());
  return out;
}

std::string name_of(const testing::TestParamInfo<fs::path>& info) { return info.param.stem().string(); }

/// Output of `check`, and below "run:" the refusals of `run`.
std::string judged(const fs::path& path) {
  ReadDescription reading = read_description(contents(path), path.filename().string());
  const Verdict verdict = verify(reading, library());
  EXPECT_EQ(verdict.configuration.has_value(), verdict.report.is_legal());
  std::string out = verdict.report.text();
  if (!verdict.configuration) return out;
  Report run = unsupported(*verdict.configuration, Executor::kProcesses);
  if (run.is_legal()) run.add_all(unschedulable(*verdict.configuration, schedule_report(*verdict.configuration, {})));
  return run.is_legal() ? out + "legal\n" : out + "run:\n" + run.text();
}

struct Description : ::testing::TestWithParam<fs::path> {};
struct FaultyDescription : Description {};
struct GoodDescription : Description {};

void compare(const fs::path& path, const std::string& report) {
  const fs::path expected = fs::path(path).replace_extension(".expected");
  if (std::getenv("UPDATE") != nullptr) std::ofstream(expected, std::ios::binary) << report;
  EXPECT_EQ(report, contents(expected)) << path;
}

TEST_P(FaultyDescription, HasExactlyItsReport) {
  const std::string report = judged(GetParam());
  compare(GetParam(), report);
  EXPECT_NE(report.find('['), std::string::npos) << "a faulty description without a fault";
}

TEST_P(GoodDescription, IsLegal) {
  const std::string report = judged(GetParam());
  compare(GetParam(), report);
  EXPECT_EQ(report.substr(0, report.find("run:\n")).find("error:"), std::string::npos) << report;
}

INSTANTIATE_TEST_SUITE_P(Verify, FaultyDescription, ::testing::ValuesIn(descriptions("faulty")), name_of);
INSTANTIATE_TEST_SUITE_P(Verify, GoodDescription, ::testing::ValuesIn(descriptions("good")), name_of);

}  // namespace
}  // namespace chimera
