// SPDX-License-Identifier: Apache-2.0
#include "chimera/catalogue/library.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "chimera/catalogue/descriptor_json.h"
#include "chimera/units/testing/unit_samples.h"

namespace chimera {
namespace {

Descriptor component(const std::string& name, const std::string& unit = "m") {
  Descriptor d;
  d.name = name;
  d.methods[CHIMERA_CYCLE] = true;
  d.ports = {{.name = "x", .unit = unit}};
  EXPECT_TRUE(complete(d));
  return d;
}

/// Two folders under the test's own temporary one.
struct Folders : ::testing::Test {
  std::string root = testing::TempDir() + "chimera_library_" + std::to_string(::getpid()) + "/";
  void SetUp() override {
    std::filesystem::create_directories(root + "one");
    std::filesystem::create_directories(root + "two");
  }
  void TearDown() override { std::filesystem::remove_all(root); }
  void write(const std::string& file, const std::string& text) { std::ofstream(root + file) << text; }
  Library make() {
    const std::string folders[] = {root + "one", root + "nowhere", root + "two"};
    return Library::make(folders, our_units());
  }
};

TEST_F(Folders, TheFirstFolderCounts) {
  write("one/gain.component.json", to_json(component("gain", "m")));
  write("two/gain.component.json", to_json(component("gain", "kg")));
  write("two/add.component.json", to_json(component("add")));
  const Library library = make();
  ASSERT_EQ(library.entries().size(), 2u);
  EXPECT_EQ(library.entries()[0].descriptor.name, "add");
  ASSERT_NE(library.find("gain"), nullptr);
  EXPECT_EQ(library.find("gain")->descriptor.ports[0].unit, "m");
  EXPECT_EQ(library.find("gain")->object_file, root + "one/gain.so");
  EXPECT_EQ(library.find("nothing"), nullptr);
  EXPECT_EQ(library.nearest_name("gian"), "gain");
  EXPECT_TRUE(library.faults().empty());
  ASSERT_EQ(library.hidden().size(), 1u);
  EXPECT_EQ(library.hidden()[0].name, "gain");
  EXPECT_EQ(library.hidden()[0].file, root + "two/gain.component.json");
}

TEST_F(Folders, ReportsBadFilesAndGoesOn) {
  write("one/broken.component.json", "{");
  write("one/other.component.json", to_json(component("gain")));
  write("one/torque.component.json", to_json(component("torque", "Nm")));
  write("two/gain.component.json", to_json(component("gain")));
  const Library library = make();
  EXPECT_EQ(library.entries().size(), 1u);
  ASSERT_EQ(library.faults().size(), 3u);
  EXPECT_EQ(library.faults()[0].where.view(), root + "one/broken.component.json");
  EXPECT_EQ(library.faults()[1].message.view(), "describes the component gain, expected other");
  EXPECT_EQ(library.faults()[2].message.view(),
            "component torque: port x: \"Nm\" is no known unit; did you mean \"N.m\"?");
}

TEST_F(Folders, AFolderThatIsNamedTwiceIsReadOnce) {
  write("one/broken.component.json", "{");
  write("one/gain.component.json", to_json(component("gain")));
  write("one/buildable.txt", "limit\n");
  const std::string folders[] = {root + "one", root + "two/../one"};
  const Library library = Library::make(folders, our_units());
  EXPECT_EQ(library.entries().size(), 1u);
  EXPECT_EQ(library.faults().size(), 1u);
  EXPECT_EQ(library.n_unbuilt(), 1u);
  EXPECT_TRUE(library.hidden().empty());
}

TEST_F(Folders, KnowsTheComponentsThatItsBuildTreeLacks) {
  write("one/buildable.txt", "gain\nlimit\nadd\n");
  write("one/gain.component.json", to_json(component("gain")));
  write("two/add.component.json", to_json(component("add")));
  const Library library = make();
  EXPECT_TRUE(library.is_unbuilt("limit"));
  EXPECT_FALSE(library.is_unbuilt("gain"));
  EXPECT_FALSE(library.is_unbuilt("add"));  // another folder has it
  EXPECT_FALSE(library.is_unbuilt("nothing"));
  EXPECT_EQ(library.n_unbuilt(), 1u);
}

TEST(Library, TakesDescriptorsWithoutFiles) {
  const Library library = Library::of({component("b"), component("a")}, our_units());
  ASSERT_EQ(library.entries().size(), 2u);
  EXPECT_EQ(library.entries()[0].descriptor.name, "a");
}

TEST(Library, ThePathComesBeforeTheInstalledFolders) {
  const std::string installed[] = {"/usr/lib/chimera"};
  ::setenv("CHIMERA_PATH", "/a::/b", 1);
  EXPECT_EQ(component_folders(installed), (std::vector<std::string>{"/a", "/b", "/usr/lib/chimera"}));
  ::unsetenv("CHIMERA_PATH");
  EXPECT_EQ(component_folders(installed), (std::vector<std::string>{"/usr/lib/chimera"}));
}

}  // namespace
}  // namespace chimera
