// SPDX-License-Identifier: Apache-2.0
// For the tests of this folder: the components of this build tree, and descriptions written down in a test.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "chimera/base/testing/tree_path.h"
#include "chimera/catalogue/workplace.h"
#include "chimera/description/draft.h"
#include "chimera/verify/verify.h"

namespace chimera::cli {

/// A file of its own that is gone with the object. Context: setup.
class TestFile {
 public:
  explicit TestFile(const std::string& text) {
    const int fd = ::mkstemps(path_, 5);
    EXPECT_GE(fd, 0);
    std::ofstream(path_) << text;
    ::close(fd);
  }
  ~TestFile() { ::unlink(path_); }
  TestFile(const TestFile&) = delete;
  TestFile& operator=(const TestFile&) = delete;
  std::string path() const { return path_; }

 private:
  char path_[32] = "/tmp/chimera_file_XXXXXX.yaml";
};

inline Workplace test_place() {
  return {{build_path("components")}, {source_path("share/chimera/units.xml")}};
}

inline Library test_library() { return *test_place().library(); }

/// One task, whose outputs are count, dt, now, deadline, cycles, dropped and illegal.
inline constexpr const char* kCounterText = R"(subsystem: small
tasks:
  counter: {component: t_counter}
)";

/// The configuration that `text` describes.
inline Configuration test_configuration(const std::string& text, const Library& library) {
  const TestFile file(text);
  Verdict verdict = verify(read_description_file(file.path()), library);
  EXPECT_TRUE(verdict.configuration) << verdict.report.text();
  return *std::move(verdict.configuration);
}

}  // namespace chimera::cli
