// SPDX-License-Identifier: Apache-2.0
// Sets the locale of its process in init, for C from the environment and for C++, as libraries with windows do.
#include <clocale>
#include <locale>
#include <string>

#include "chimera/task/component.h"

using namespace chimera;

namespace {

struct Comma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

struct SetsLocale {
  Out<double> half{"half", "1", initial = 0.5};

  void init(Cycle c) {
    std::setlocale(LC_ALL, "");
    std::locale::global(std::locale(std::locale::classic(), new Comma));
    c.note((std::string("the locale is ") + std::setlocale(LC_NUMERIC, nullptr)).c_str());
  }
  void cycle() { *half = 0.5; }
};

CHIMERA_COMPONENT(SetsLocale, "t_locale", "Sets the locale of its process.", rate = 100.0);

}  // namespace
