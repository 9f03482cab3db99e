// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "chimera/description/testing/edit_campaign.h"

namespace chimera {
namespace {

TEST(EditCampaign, ChangesOnlyWhatEachEditAsks) {
  const auto texts = texts_to_edit();
  ASSERT_GE(texts.size(), 50u);
  unsigned seed = 1;
  for (const auto& [path, text] : texts)
    EXPECT_EQ(EditCampaign(text, seed++).run(60), "") << path << ", seed " << seed - 1;
}

}  // namespace
}  // namespace chimera
