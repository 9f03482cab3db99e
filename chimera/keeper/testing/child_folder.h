// SPDX-License-Identifier: Apache-2.0
// For tests: the folder in which the children of child.cc find their orders and write their messages.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace chimera::testing {

/// A folder that is removed with the object. Every child that this process starts from now on uses it.
class ChildFolder {
 public:
  ChildFolder() {
    char name[] = "/tmp/keeper_test_XXXXXX";
    path_ = ::mkdtemp(name);
    ::setenv("CHIMERA_TEST_LOG", (path_ + "/log").c_str(), 1);
    ::setenv("CHIMERA_TEST_ORDERS", path_.c_str(), 1);
    ::unsetenv("CHIMERA_TEST_DEAF");
  }
  ~ChildFolder() { std::filesystem::remove_all(path_); }
  ChildFolder(const ChildFolder&) = delete;
  ChildFolder& operator=(const ChildFolder&) = delete;

  /// `who`: a peer ("1"), one incarnation of it ("1.2"), or the run client ("face").
  void order(const std::string& who, const std::string& what) const {
    std::ofstream(path_ + "/" + who, std::ios::app) << what << "\n";
  }
  /// All lines so far.
  std::string log() const {
    std::stringstream all;
    all << std::ifstream(path_ + "/log").rdbuf();
    return all.str();
  }

  void clear_log() const { std::filesystem::remove(path_ + "/log"); }

 private:
  std::string path_;
};

}  // namespace chimera::testing
