// SPDX-License-Identifier: Apache-2.0
#include "chimera/text/value_renderer.h"

#include <gtest/gtest.h>

#include <vector>

namespace chimera {
namespace {

/// All of it, at most `values` at a time; `parts` counts the times.
std::string in_parts(const ValueForm& form, std::span<const std::byte> bytes, ValueRenderer::As as, std::size_t values,
                     int& parts) {
  ValueRenderer renderer(form, bytes, as);
  std::string text;
  for (parts = 1; renderer.append_to(text, values);) ++parts;
  return text;
}

void expect_same_in_parts(const ValueForm& form, std::span<const std::byte> bytes, int parts_of_one) {
  int parts = 0;
  EXPECT_EQ(in_parts(form, bytes, ValueRenderer::As::kText, 1, parts), value_text(form, bytes));
  EXPECT_EQ(parts, parts_of_one);
  EXPECT_EQ(in_parts(form, bytes, ValueRenderer::As::kJson, 3, parts), value_json(form, bytes));
  EXPECT_EQ(parts, (parts_of_one + 2) / 3);
}

TEST(ValueRenderer, WritesAListInPartsAsItIsWrittenWhole) {
  ValueForm form;
  form.count = 7;
  form.is_scalar = false;
  form.unit = "rad";
  const double values[7] = {1, -2.5, 1e300, 0, 4, 5, 6};
  expect_same_in_parts(form, std::as_bytes(std::span(values)), 7);
}

TEST(ValueRenderer, StopsInTheMiddleOfAStruct) {
  struct Sample {
    double x;
    std::int32_t n[3];
    char name[4];
  } samples[2] = {{1.5, {1, 2, 3}, "a\"b"}, {2.5, {4, 5, 6}, "cd"}};
  ValueForm form;
  form.type = CHIMERA_STRUCT;
  form.element_bytes = sizeof(Sample);
  form.count = 2;
  form.is_scalar = false;
  form.fields = {FieldDescriptor{}, FieldDescriptor{}, FieldDescriptor{}};
  form.fields[0].name = "x", form.fields[0].unit = "m", form.fields[0].size = 8;
  form.fields[0].type = CHIMERA_FLOAT64, form.fields[0].count = 1;
  form.fields[1].name = "n", form.fields[1].unit = "1", form.fields[1].size = 4, form.fields[1].offset = 8;
  form.fields[1].type = CHIMERA_INT32, form.fields[1].count = 3;
  form.fields[2].name = "name", form.fields[2].unit = "1", form.fields[2].size = 4, form.fields[2].offset = 20;
  form.fields[2].type = CHIMERA_STRING, form.fields[2].count = 1;
  expect_same_in_parts(form, std::as_bytes(std::span(samples)), 10);
}

TEST(ValueRenderer, APartOfEnoughValuesIsTheLast) {
  ValueForm form;
  const double value = 3;
  int parts = 0;
  EXPECT_EQ(in_parts(form, std::as_bytes(std::span(&value, 1)), ValueRenderer::As::kJson, 1, parts), "3.0");
  EXPECT_EQ(parts, 1);
}

}  // namespace
}  // namespace chimera
