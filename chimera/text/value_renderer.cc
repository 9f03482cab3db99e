// SPDX-License-Identifier: Apache-2.0
// Writes the bytes of a value as text or JSON, one number after the other.
#include "chimera/text/value_renderer.h"

#include <cstring>

#include "chimera/base/hosted/wording.h"
#include "chimera/task/number_at.h"
#include "chimera/text/json_text.h"

namespace chimera {
namespace {

template <class T>
T read(const std::byte* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

std::string text_of(const std::byte* at, std::uint32_t bytes) {
  const char* text = reinterpret_cast<const char*>(at);
  return {text, ::strnlen(text, bytes)};
}

bool is_float(std::uint32_t type) { return type == CHIMERA_FLOAT32 || type == CHIMERA_FLOAT64; }

std::string plain(std::uint32_t type, const std::byte* at, std::uint32_t bytes, bool is_json) {
  if (type == CHIMERA_STRING) return is_json ? json_string(text_of(at, bytes)) : "\"" + text_of(at, bytes) + "\"";
  if (type == CHIMERA_BOOL) return read<std::uint8_t>(at) != 0 ? "true" : "false";
  if (type == CHIMERA_INT32) return std::to_string(read<std::int32_t>(at));
  if (type == CHIMERA_INT64) return std::to_string(read<std::int64_t>(at));
  if (is_json) return json_number(number_at(type, at));
  return formatted("%.6g", number_at(type, at));
}

void append_unit(std::string& text, const std::string& unit) {
  if (unit != "1") text += " " + unit;
}

}  // namespace

bool ValueRenderer::append_to(std::string& text, std::size_t values) {
  if (!has_begun_ && !form_.is_scalar) text += "[";
  has_begun_ = true;
  for (; element_ < form_.count; --values) {
    if (values == 0) return true;
    append_next(text);
  }
  if (!form_.is_scalar) text += "]";
  if (!is_json_ && form_.type != CHIMERA_STRUCT) append_unit(text, is_shown_otherwise() ? form_.shown : form_.unit);
  return false;
}

bool ValueRenderer::is_shown_otherwise() const { return !is_json_ && !form_.shown.empty() && is_float(form_.type); }

void ValueRenderer::append_next(std::string& text) {
  const std::byte* at = bytes_.data() + std::size_t{element_} * form_.element_bytes;
  if (element_ > 0 && field_ == 0 && item_ == 0) text += between();
  if (form_.type != CHIMERA_STRUCT) {
    text += is_shown_otherwise() ? formatted("%.6g", number_at(form_.type, at) * form_.factor + form_.offset)
                                 : plain(form_.type, at, form_.element_bytes, is_json_);
    ++element_;
  } else if (form_.fields.empty()) {
    text += "{}";
    ++element_;
  } else {
    const FieldDescriptor& field = form_.fields[field_];
    begin_field(text);
    text += plain(field.type, at + field.offset + std::size_t{item_} * field.size, field.size, is_json_);
    if (++item_ == field.count) end_field(text);
  }
}

void ValueRenderer::begin_field(std::string& text) const {
  if (item_ > 0) {
    text += between();
    return;
  }
  const FieldDescriptor& field = form_.fields[field_];
  text += (field_ == 0 ? "{" : ", ") + (is_json_ ? json_string(field.name) : field.name) + ": ";
  if (field.count > 1) text += "[";
}

void ValueRenderer::end_field(std::string& text) {
  const FieldDescriptor& field = form_.fields[field_];
  if (field.count > 1) text += "]";
  if (!is_json_) append_unit(text, field.unit);
  item_ = 0;
  if (++field_ < form_.fields.size()) return;
  field_ = 0;
  text += "}";
  ++element_;
}

}  // namespace chimera
