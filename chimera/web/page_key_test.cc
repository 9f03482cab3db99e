// SPDX-License-Identifier: Apache-2.0
#include "chimera/web/page_key.h"

#include <gtest/gtest.h>

#include <set>

namespace chimera::web {
namespace {

TEST(PageKey, HasItsBitsInCharactersOfALink) {
  std::set<std::string> made;
  std::set<char> seen;
  for (int i = 0; i < 100; ++i) {
    const auto key = PageKey::make();
    ASSERT_TRUE(key);
    EXPECT_EQ(key->text().size(), 43u);
    made.insert(key->text());
    seen.insert(key->text().begin(), key->text().end());
    EXPECT_NE(std::string("AEIMQUYcgkosw048").find(key->text().back()), std::string::npos);  // four bits and two zeros
  }
  EXPECT_EQ(made.size(), 100u);
  EXPECT_EQ(seen.size(), 64u);
  for (const char c : seen) EXPECT_TRUE(std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_') << c;
}

TEST(PageKey, IsOnlyItself) {
  const auto key = PageKey::make(), other = PageKey::make();
  ASSERT_TRUE(key && other);
  const std::string text = key->text();
  EXPECT_TRUE(key->is(text));
  EXPECT_FALSE(key->is(""));
  EXPECT_FALSE(key->is(other->text()));
  EXPECT_FALSE(key->is(text + "A"));
  EXPECT_FALSE(key->is(text + std::string(1, '\0')));
  for (std::size_t i = 0; i < text.size(); ++i) {
    EXPECT_FALSE(key->is(text.substr(0, i))) << i;
    std::string changed = text;
    changed[i] = changed[i] == 'A' ? 'B' : 'A';
    EXPECT_FALSE(key->is(changed)) << i;
  }
}

}  // namespace
}  // namespace chimera::web
