// SPDX-License-Identifier: Apache-2.0
// Ends its process while its object is loaded, while it is made, or in a method, as CHIMERA_TEST_LOAD says:
// "load segv", "construct exit", "cycle hang" ...
#include <csignal>
#include <cstdlib>
#include <cstring>

#include <unistd.h>

#include "chimera/task/component.h"

using namespace chimera;

namespace {

void end_in(const char* place) {
  const char* told = std::getenv("CHIMERA_TEST_LOAD");
  const std::size_t length = std::strlen(place);
  if (told == nullptr || std::strncmp(told, place, length) != 0 || told[length] != ' ') return;
  const char* how = told + length + 1;
  if (std::strcmp(how, "segv") == 0) std::raise(SIGSEGV);
  if (std::strcmp(how, "abort") == 0) std::abort();
  if (std::strcmp(how, "exit") == 0) ::_exit(0);
  while (std::strcmp(how, "hang") == 0) ::pause();
}

int made = 0;

[[gnu::constructor]] void loaded() { end_in("load"); }

}  // namespace

struct Loaded {
  Out<double> y{"y", "1", initial = 0.0, doc = "nothing"};
  Loaded() { end_in(made++ == 0 ? "describe" : "construct"); }  // the first is that of its declaration
  void init() { end_in("init"); }
  void cycle() { end_in("cycle"); }
};
CHIMERA_COMPONENT(Loaded, "t_load", "Ends its process while it is loaded.", rate = 100.0);
