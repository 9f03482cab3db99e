// SPDX-License-Identifier: Apache-2.0
// Reads a file through a library that uses the locale of the process, which any component may have set.
#pragma once

#include <clocale>
#include <locale>
#include <string>

namespace chimera {

/// Numbers have a decimal point for C and C++ during its lifetime; the end restores what was set before.
/// Context: setup; may block.
class ClassicLocale {
 public:
  ClassicLocale() : c_(std::setlocale(LC_ALL, nullptr)), cpp_(std::locale::global(std::locale::classic())) {
    std::setlocale(LC_ALL, "C");
  }
  ClassicLocale(const ClassicLocale&) = delete;
  ClassicLocale& operator=(const ClassicLocale&) = delete;
  ~ClassicLocale() {
    std::locale::global(cpp_);
    std::setlocale(LC_ALL, c_.c_str());
  }

 private:
  std::string c_;
  std::locale cpp_;
};

}  // namespace chimera
