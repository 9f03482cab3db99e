// SPDX-License-Identifier: Apache-2.0
// A resource port: init opens the file it names and refuses when it cannot; kill closes it.
#include <cstdio>

#include "chimera/task/component.h"

using namespace chimera;

struct ResourceReader {
  Resource file{"file", shared, doc = "a file that begins with a number"};
  Out<double> number{"number", "1", initial = 0.0, doc = "the number"};
  Out<Text<64>> name{"name", initial = "", doc = "what the resource says"};

  Outcome init() {
    open_ = std::fopen(file.c_str(), "r");
    if (open_ == nullptr) return fault("the file cannot be opened", 2);
    if (std::fscanf(open_, "%lf", &read_) != 1) return fault("the file does not begin with a number", 3);
    return ok();
  }
  void cycle() {
    *number = read_;
    *name = Text<64>(file.text());
  }
  void kill() {
    if (open_ != nullptr) std::fclose(open_);
    open_ = nullptr;
  }
  std::FILE* open_ = nullptr;
  double read_ = 0;
};
CHIMERA_COMPONENT(ResourceReader, "t_resource", "Reads a number from a file.", rate = 100.0);
