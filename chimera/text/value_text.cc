// SPDX-License-Identifier: Apache-2.0
// Writes the bytes of a value as text and JSON, element by element and field by field.
#include "chimera/text/value_text.h"

#include <cstdio>
#include <cstring>

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

std::string plain(std::uint32_t type, const std::byte* at, std::uint32_t bytes, bool as_json) {
  if (type == CHIMERA_STRING) return as_json ? json_string(text_of(at, bytes)) : "\"" + text_of(at, bytes) + "\"";
  if (type == CHIMERA_BOOL) return read<std::uint8_t>(at) != 0 ? "true" : "false";
  if (type == CHIMERA_INT32) return std::to_string(read<std::int32_t>(at));
  if (type == CHIMERA_INT64) return std::to_string(read<std::int64_t>(at));
  if (as_json) return json_number(number_at(type, at));
  char text[40];
  std::snprintf(text, sizeof text, "%.6g", number_at(type, at));
  return text;
}

std::string with_unit(const std::string& text, const std::string& unit) {
  return unit == "1" ? text : text + " " + unit;
}

std::string field_text(const FieldDescriptor& field, const std::byte* at, bool as_json) {
  std::string text;
  for (std::uint32_t i = 0; i < field.count; ++i)
    text += (i == 0 ? "" : as_json ? ", " : " ") + plain(field.type, at + i * field.size, field.size, as_json);
  if (field.count > 1) text = "[" + text + "]";
  return as_json ? text : with_unit(text, field.unit);
}

std::string element_text(const ValueForm& form, const std::byte* at, bool as_json) {
  if (form.type != CHIMERA_STRUCT) return plain(form.type, at, form.element_bytes, as_json);
  std::string text;
  for (const FieldDescriptor& field : form.fields)
    text += (text.empty() ? "" : ", ") + (as_json ? json_string(field.name) : field.name) + ": " +
            field_text(field, at + field.offset, as_json);
  return "{" + text + "}";
}

std::string render(const ValueForm& form, std::span<const std::byte> bytes, bool as_json) {
  std::string text;
  for (std::uint32_t i = 0; i < form.count; ++i)
    text += (i == 0 ? "" : as_json ? ", " : " ") + element_text(form, bytes.data() + i * form.element_bytes, as_json);
  return form.is_scalar ? text : "[" + text + "]";
}

}  // namespace

std::string value_text(const ValueForm& form, std::span<const std::byte> bytes) {
  const std::string text = render(form, bytes, false);
  return form.type == CHIMERA_STRUCT ? text : with_unit(text, form.unit);
}

std::string value_json(const ValueForm& form, std::span<const std::byte> bytes) { return render(form, bytes, true); }

std::vector<double> numbers(const ValueForm& form, std::span<const std::byte> bytes) {
  std::vector<double> all;
  for (std::uint32_t i = 0; i < form.count; ++i) {
    const std::byte* at = bytes.data() + i * form.element_bytes;
    if (form.type == CHIMERA_STRUCT) {
      for (const FieldDescriptor& field : form.fields)
        for (std::uint32_t k = 0; k < field.count && field.type != CHIMERA_STRING; ++k)
          all.push_back(number_at(field.type, at + field.offset + k * field.size));
    } else if (form.type != CHIMERA_STRING) {
      all.push_back(number_at(form.type, at));
    }
  }
  return all;
}

}  // namespace chimera
