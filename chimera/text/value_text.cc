// SPDX-License-Identifier: Apache-2.0
// Writes values whole, and takes their numbers out.
#include "chimera/text/value_text.h"

#include <cstdint>

#include "chimera/task/number_at.h"
#include "chimera/text/value_renderer.h"

namespace chimera {
namespace {

std::string whole(const ValueForm& form, std::span<const std::byte> bytes, ValueRenderer::As as) {
  std::string text;
  ValueRenderer(form, bytes, as).append_to(text, SIZE_MAX);
  return text;
}

}  // namespace

std::string value_text(const ValueForm& form, std::span<const std::byte> bytes) {
  return whole(form, bytes, ValueRenderer::As::kText);
}

std::string value_json(const ValueForm& form, std::span<const std::byte> bytes) {
  return whole(form, bytes, ValueRenderer::As::kJson);
}

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
