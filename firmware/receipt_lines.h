// SPDX-License-Identifier: Apache-2.0
// Sends the receipts of switches: docs/formats/image_output.md.
#pragma once

#include "chimera/base/number_text.h"
#include "chimera/runtime/application_spec.h"
#include "chimera/runtime/plan/switch_receipt.h"
#include "chimera/runtime/plan/switch_words.h"
#include "firmware/serial_text.h"

namespace chimera::firmware {

/// Context of everything: cycle boundary; wait-free.
class ReceiptLinesOut final : public ReceiptReader {
 public:
  explicit ReceiptLinesOut(const ApplicationSpec& spec) noexcept : spec_(spec) {}
  /// Instants are counted from here.
  void begin(Nanoseconds origin) noexcept { origin_ = origin; }

  void take(const SwitchReceipt& receipt) noexcept override {
    std::uint64_t lost = 0;
    for (const TaskPart& each : receipt.tasks) lost += each.lost;
    Message text;
    text << "switch " << receipt.number << " from " << name_of(receipt.before) << " to " << name_of(receipt.after)
         << " " << end_word(receipt.end) << " why " << reason_word(receipt.why) << " task " << name_of(receipt.task)
         << " lost " << lost;
    add(text, " asked ", receipt.asked);
    add(text, " armed ", receipt.armed);
    add(text, " committed ", receipt.at);
    add(text, " ended ", receipt.ended);
    send_line(text);
    if (!receipt.said.view().empty()) send_line(Message() << "said " << receipt.number << " " << receipt.said.view());
    if (receipt.end == SwitchEnd::kDone)
      for (const VariablePart& each : receipt.variables) send_step(receipt, each);
  }

 private:
  void send_step(const SwitchReceipt& receipt, const VariablePart& part) noexcept {
    Message text;
    text << "step " << receipt.number << " " << spec_.variables[part.handover.variable.index].name;
    add(text, " on ", part.step_of_on);
    add(text, " cycle ", part.step_of_cycle);
    add(text, " usual ", part.usual);
    send_line(text);
  }
  void add(Message& text, const char* what, Nanoseconds instant) const noexcept {
    text << what;
    if (instant == kNever) text << "-";
    else text << (instant - origin_).count;
  }
  static void add(Message& text, const char* what, const ValueStep& step) noexcept {
    text << what << (step.is_known ? number_text(step.size).view() : std::string_view("-"));
  }
  std::string_view name_of(std::uint32_t set) const noexcept { return set == kNoSet ? "-" : spec_.sets[set].name; }
  std::string_view name_of(TaskId task) const noexcept { return task.is_valid() ? spec_.tasks[task.index].name : "-"; }

  const ApplicationSpec& spec_;
  Nanoseconds origin_;
};

}  // namespace chimera::firmware
