// SPDX-License-Identifier: Apache-2.0
#include "chimera/catalogue/workplace.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "chimera/base/testing/tree_path.h"

namespace chimera {
namespace {

TEST(Workplace, SearchesThePathBeforeTheFoldersOfTheProgram) {
  ::setenv("CHIMERA_PATH", "/mine:/ours", 1);
  const Workplace place = Workplace::around("/opt/chimera/bin/chimera");
  ::unsetenv("CHIMERA_PATH");
  EXPECT_EQ(place.component_folders,
            (std::vector<std::string>{"/mine", "/ours", "/opt/chimera/components",
                                      "/opt/chimera/lib/chimera/components"}));
  EXPECT_EQ(place.unit_files, (std::vector<std::string>{"/opt/chimera/share/chimera/units.xml",
                                                        "/opt/chimera/../../share/chimera/units.xml"}));
  EXPECT_EQ(place.documents, "/opt/chimera/share/chimera");
}

TEST(Workplace, KnowsTheDocumentsOfTheCheckoutAroundABuildTree) {
  const std::string documents = Workplace::around(program_path().substr(0, program_path().find("/build/")) +
                                                  "/build/any/bin/chimera").documents;
  EXPECT_EQ(documents + "/build", program_path().substr(0, documents.size() + 6));
}

TEST(Workplace, WithoutAPathOnlyTheProgramsOwnFolders) {
  ::unsetenv("CHIMERA_PATH");
  EXPECT_EQ(Workplace::around("/usr/bin/chimera").component_folders,
            (std::vector<std::string>{"/usr/components", "/usr/lib/chimera/components"}));
}

TEST(Workplace, RefusesToGuessUnits) {
  Workplace place;
  place.unit_files = {"/nowhere/units.xml"};
  const auto library = place.library();
  ASSERT_FALSE(library);
  EXPECT_NE(std::string(library.error().message.view()).find("/nowhere/units.xml"), std::string::npos)
      << library.error().message.c_str();
}

TEST(Workplace, FindsTheComponentsThatAreBuiltBesideADescription) {
  const std::filesystem::path folder = testing::TempDir() + "workplace_beside";
  std::filesystem::create_directories(folder / "build/components");
  std::ofstream(folder / "build/components/cut.component.json") << "{";
  Workplace place;
  place.unit_files = {source_path("share/chimera/units.xml")};
  const auto found = [&](const std::string& description) { return place.library(description)->faults().size(); };
  EXPECT_EQ(found((folder / "app.yaml").string()), 1u) << "the cut descriptor is read";
  EXPECT_EQ(found((folder / "build/app.yaml").string()), 0u);
  std::filesystem::remove_all(folder);
}

TEST(ProgramPath, IsThisProgram) { EXPECT_NE(program_path().find("/catalogue_test"), std::string::npos); }

}  // namespace
}  // namespace chimera
