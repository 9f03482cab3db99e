// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "chimera/base/testing/tree_path.h"
#include "chimera/catalogue/library.h"
#include "chimera/runtime/hosted/application_image.h"
#include "chimera/runtime/testing/spec_equal.h"
#include "chimera/units/testing/unit_samples.h"
#include "chimera/verify/verify.h"

namespace chimera {
namespace {

namespace fs = std::filesystem;

TEST(ImageOfTheLessons, EveryLegalDescriptionComesBackAsItWas) {
  const std::string folders[] = {build_path("components")};
  const Library library = Library::make(folders, our_units());
  int legal = 0;
  for (const auto& entry : fs::recursive_directory_iterator(source_path("examples"))) {
    if (entry.path().extension() != ".yaml") continue;
    const Verdict verdict = verify(read_description_file(entry.path()), library);
    if (!verdict.configuration) continue;  // a lesson about what is refused
    SCOPED_TRACE(entry.path());
    ++legal;
    const ApplicationSpec& spec = verdict.configuration->spec();
    std::vector<ComponentPlace> places;
    for (const TaskSpec& task : spec.tasks) places.push_back({task.component, task.name.size()});
    const std::vector<std::byte> bytes = encode(spec, places, {});
    const auto image = ApplicationImage::decode(bytes);
    ASSERT_TRUE(image) << image.error().message.c_str();
    EXPECT_EQ(testing::first_difference(image->spec(), spec), "");
    EXPECT_EQ(encode(image->spec(), image->places(), image->settings()), bytes);
  }
  EXPECT_GE(legal, 10);
}

}  // namespace
}  // namespace chimera
