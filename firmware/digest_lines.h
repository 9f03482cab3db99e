// SPDX-License-Identifier: Apache-2.0
// Sends the digest of the run: "digest SECOND TASK PUBLICATIONS FAULTS HASH".
#pragma once

#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/record/digest.h"
#include "firmware/line.h"

namespace chimera::firmware {

/// Context of everything: cycle; wait-free.
class DigestLinesOut final : public DigestLines {
 public:
  explicit DigestLinesOut(const ApplicationSpec& spec) noexcept : spec_(spec) {}
  void take(const DigestLine& line) noexcept override {
    Line text;
    text << "digest " << static_cast<std::uint64_t>(line.second) << " " << spec_.tasks[line.task.index].name << " "
         << line.publications << " " << line.faults << " ";
    send(text.hex(line.hash));
  }

 private:
  const ApplicationSpec& spec_;
};

}  // namespace chimera::firmware
