// SPDX-License-Identifier: Apache-2.0
#include "chimera/load/sealed_objects.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>

#include "chimera/base/testing/tree_path.h"

namespace chimera {
namespace {

struct SealedObjectsTest : ::testing::Test {
  SealedObjectsTest() { EXPECT_NE(::mkdtemp(folder.data()), nullptr); }
  ~SealedObjectsTest() override { std::filesystem::remove_all(folder); }
  std::string copy_of(const std::string& name) {
    const std::string path = folder + "/" + name;
    std::filesystem::copy_file(build_path("chimera/load/test_objects/" + name), path);
    return path;
  }
  std::vector<std::byte> packed(const std::vector<std::string>& paths) {
    auto bytes = SealedObjects::pack(paths);
    EXPECT_TRUE(bytes) << bytes.error().message.view();
    return bytes ? *std::move(bytes) : std::vector<std::byte>();
  }
  std::string folder = "/tmp/sealed_objects_XXXXXX";
};

TEST_F(SealedObjectsTest, LinkTheContentFromTheTimeOfPacking) {
  const std::string counter = copy_of("counter.so"), other = copy_of("nothing_offered.so");
  const auto bytes = packed({counter, other, counter});
  std::ofstream(counter, std::ios::binary) << "built anew, and not finished";
  std::filesystem::remove(other);
  const auto objects = SealedObjects::open(bytes);
  ASSERT_TRUE(objects);
  const auto linked = objects->link(counter);
  ASSERT_TRUE(linked) << linked.error().message.view();
  EXPECT_TRUE(linked->component("counter"));
  EXPECT_EQ(linked->path(), counter);
  const auto refused = objects->link(other);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message.view(), "nothing_offered.so offers no component. Rebuild the component.");
}

TEST_F(SealedObjectsTest, AnObjectThatIsNamedTwiceIsPackedOnce) {
  const std::string counter = copy_of("counter.so");
  EXPECT_EQ(packed({counter, counter}).size(), packed({counter}).size());
}

TEST_F(SealedObjectsTest, RefuseFilesThatAreNotThereAndPathsThatWereNotPacked) {
  const std::vector<std::string> paths = {folder + "/none.so"};
  const auto refused = SealedObjects::pack(paths);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kNotFound);
  EXPECT_EQ(refused.error().where.view(), paths[0]);
  const auto bytes = packed({});
  const auto stranger = SealedObjects::open(bytes)->link("a.so");
  ASSERT_FALSE(stranger);
  EXPECT_EQ(stranger.error().message.view(), "is not among the objects of this run");
}

TEST_F(SealedObjectsTest, RefuseToBeCutShortAnywhere) {
  const auto bytes = packed({copy_of("counter.so")});
  const std::size_t first = 8 + 16 + folder.size() + std::string("/counter.so").size();
  for (std::size_t size = 0; size < bytes.size(); size += size < first + 20 ? 1 : 997) {
    const auto cut = SealedObjects::open(std::span(bytes).first(size));
    EXPECT_EQ(cut.has_value(), size == 8) << size;  // 8 bytes: an empty pack
  }
}

}  // namespace
}  // namespace chimera
