// SPDX-License-Identifier: Apache-2.0
// Writes a value in parts, so that other work need not wait until a large value is written whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "chimera/text/value_text.h"

namespace chimera {

/// Context: setup.
class ValueRenderer {
 public:
  enum class As : std::uint8_t {
    kText,  ///< as value_text()
    kJson,  ///< as value_json()
  };

  /// `form` and `bytes` outlive it. Requires: form.count * form.element_bytes bytes.
  ValueRenderer(const ValueForm& form, std::span<const std::byte> bytes, As as) noexcept
      : form_(form), bytes_(bytes), is_json_(as == As::kJson) {}

  /// Appends the next numbers, truth values and texts, at most `values` of them. False: that was the end of the value;
  /// nothing more may be asked for.
  bool append_to(std::string& text, std::size_t values);

 private:
  void append_next(std::string& text);
  void begin_field(std::string& text) const;
  void end_field(std::string& text);
  bool is_shown_otherwise() const;
  const char* between() const noexcept { return is_json_ ? ", " : " "; }

  const ValueForm& form_;
  std::span<const std::byte> bytes_;
  bool is_json_;
  bool has_begun_ = false;
  std::uint32_t element_ = 0, field_ = 0, item_ = 0;  // what comes next
};

}  // namespace chimera
