// SPDX-License-Identifier: Apache-2.0
// Writes readings a thousand numbers at a time.
#include "chimera/manager/answer/large_readings.h"

#include "chimera/manager/answer/value_json.h"
#include "chimera/text/json.h"
#include "chimera/text/json_text.h"

namespace chimera::manager {
namespace {

constexpr std::size_t kValuesOfPiece = 1000;

}  // namespace

std::size_t bytes_of(const ManagerState& state, const std::vector<VariableId>& variables) {
  std::size_t bytes = 0;
  for (const VariableId variable : variables) {
    const ValueForm form = state.readings->form(variable);
    bytes += std::size_t{form.count} * form.element_bytes;
  }
  return bytes;
}

bool LargeReadings::append_to(std::string& text) {
  if (!begin_.empty()) text += std::exchange(begin_, {}) + "{";
  if (text_ || value_)
    go_on_with_reading(text);
  else if (next_ < variables_.size())
    begin_reading(text);
  if (text_ || value_ || next_ < variables_.size()) return true;
  text += "}" + end_;
  return false;
}

void LargeReadings::begin_reading(std::string& text) {
  const VariableId variable = variables_[next_];
  reading_ = state_.readings->read(variable);
  text += (next_ == 0 ? "" : ",") + json_string(state_.readings->configured(variable).name) + ":";
  ++next_;
  std::string head = reading_head_json(state_, variable, reading_, now()).dump();
  if (reading_.is_valid) {
    head.pop_back();  // "text" and "value" follow
    text += head + R"(,"text":")";
    text_.emplace(reading_.form, reading_.value, ValueRenderer::As::kText);
    value_.emplace(reading_.form, reading_.value, ValueRenderer::As::kJson);
  } else {
    text += head;
  }
}

void LargeReadings::go_on_with_reading(std::string& text) {
  if (text_) {
    std::string part;
    if (!text_->append_to(part, kValuesOfPiece)) text_.reset();
    const std::string quoted = json_string(part);
    text.append(quoted, 1, quoted.size() - 2);
    if (!text_) text += R"(","value":)";
    return;
  }
  if (value_->append_to(text, kValuesOfPiece)) return;
  value_.reset();
  text += "}";
}

}  // namespace chimera::manager
