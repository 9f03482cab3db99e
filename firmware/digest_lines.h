// SPDX-License-Identifier: Apache-2.0
// Sends the digest of the run: "digest SECOND TASK PUBLICATIONS FAULTS HASH".
#pragma once

#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/record/digest.h"
#include "firmware/serial_text.h"

namespace chimera::firmware {

/// Context of everything: cycle; wait-free.
class DigestLinesOut final : public DigestLines {
 public:
  explicit DigestLinesOut(const ApplicationSpec& spec) noexcept : spec_(spec) {}
  void take(const DigestLine& line) noexcept override {
    Message text;
    text << "digest " << line.second << " " << spec_.tasks[line.task.index].name << " "
         << line.publications << " " << line.faults << " ";
    send_line(add_hex(text, line.hash, 16));
  }

 private:
  const ApplicationSpec& spec_;
};

}  // namespace chimera::firmware
