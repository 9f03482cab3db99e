// SPDX-License-Identifier: Apache-2.0
// Faults for shared objects that cannot be components. load/shared_object_test.cc tests the objects themselves.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>

#include "chimera/base/testing/tree_path.h"
#include "chimera/catalogue/descriptor_json.h"
#include "chimera/catalogue/library.h"
#include "chimera/load/shared_object.h"
#include "chimera/units/testing/unit_samples.h"
#include "chimera/verify/verify.h"

namespace chimera {
namespace {

namespace fs = std::filesystem;

fs::path test_object(const std::string& name) { return build_path("chimera/load/test_objects/" + name); }

/// A folder with the descriptor of `counter` and the files that a test writes.
class FaultyObjects : public ::testing::Test {
 protected:
  FaultyObjects() {
    const auto object = SharedObject::open(test_object("counter.so"));
    std::ofstream(folder_ / "counter.component.json") << to_json(*describe(**object->component("counter")));
  }
  ~FaultyObjects() override { fs::remove_all(folder_); }
  void object(const std::string& bytes) { std::ofstream(folder_ / "counter.so", std::ios::binary) << bytes; }
  void copy(const std::string& name) {
    fs::copy_file(test_object(name), folder_ / "counter.so", fs::copy_options::overwrite_existing);
  }
  std::string said() {
    const std::string folders[] = {folder_};
    const Library library = Library::make(folders, our_units());
    const Verdict verdict =
        verify(read_description("subsystem: demo\ntasks:\n  first: {component: counter, rate: 1 kHz}\n"
                                "  second: {component: counter, rate: 1 kHz, alias: {count: other}}\n",
                                "app.yaml"),
               library);
    EXPECT_TRUE(verdict.configuration) << verdict.report.text();
    return verdict.configuration ? faulty_objects(*verdict.configuration, library).text() : "";
  }
  /// The single line for a faulty object, even if several tasks use it.
  std::string line(const std::string& what) {
    return "app.yaml:3:22: error: task 'first': counter.so " + what +
           " [component-object]\n  rebuild the component: " + (folder_ / "counter.so").string() +
           " is what would be loaded\n";
  }
  fs::path folder_{[] {
    char path[] = "/tmp/chimera_objects_XXXXXX";
    return std::string(::mkdtemp(path));
  }()};
};

TEST_F(FaultyObjects, AnObjectThatCannotRunIsReportedOnceWithItsPlace) {
  EXPECT_EQ(said(), line("is missing"));
  object("");
  EXPECT_EQ(said(), line("is empty (0 bytes)"));
  object("subsystem: demo");
  EXPECT_EQ(said(), line("is not a shared object: it does not begin with the ELF mark"));
  copy("counter.so");
  EXPECT_EQ(said(), "");
  fs::resize_file(folder_ / "counter.so", 4000);
  EXPECT_EQ(said(), line("is truncated (4000 bytes)"));
  copy("broken_state.so");
  EXPECT_EQ(said(), line("is not the object of counter: that name does not stand in it"));
  copy("no_symbol.so");
  EXPECT_EQ(said(), line("offers no components: it has no symbol chimera_components"));
}

}  // namespace
}  // namespace chimera
