// SPDX-License-Identifier: Apache-2.0
#include "chimera/web/library_pages.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>

#include "chimera/base/testing/tree_path.h"
#include "chimera/units/testing/unit_samples.h"
#include "chimera/web/fitting_ports.h"

namespace chimera::web {
namespace {

namespace fs = std::filesystem;

PortDescriptor port(const std::string& name, std::uint32_t kind, const std::string& unit, const std::string& shape = {},
                    std::uint32_t type = CHIMERA_FLOAT64) {
  PortDescriptor made;
  made.name = name, made.kind = kind, made.unit = unit, made.shape = shape, made.type = type;
  if (type == CHIMERA_ANY) made.type_name = "T";
  made.extents = *parse_shape(shape);
  return made;
}

LibraryEntry entry(const std::string& folder, const std::string& name, std::vector<PortDescriptor> ports) {
  Descriptor d;
  d.name = name, d.doc = "Does " + name + ".", d.ports = std::move(ports);
  d.methods[CHIMERA_CYCLE] = true;
  return {d, folder + "/" + name + ".component.json", folder + "/" + name + ".so"};
}

constexpr const char* kSheet =
    "# pid\n\nControls speed. Über 9 rad.\n\n## Execution time\n\n38 ns typical, 70 ns worst: `chimera test pid`.\n\n"
    "## Source\n\n[Meier 1999](../../docs/papers.md#meier-1999), [b](../../docs/papers.md#b), "
    "[Meier](../../docs/papers.md#meier-1999).\n";

struct LibraryPagesTest : ::testing::Test {
  void SetUp() override {
    char made[] = "/tmp/chimera-pages-XXXXXX";
    place = ::mkdtemp(made);
    put("components/pid.md", kSheet);
    put("library/pid/README.md", kSheet);
    put("library/pid/pid.cc", "// code\n");
    put("library/pid/response.svg", "<svg/>");
    put("library/pid/pid_test.cc", "// not installed\n");
    put("library/pid/testing/rig.h", "// not of the component\n");
    put("examples/02_b/README.md", "# The second\n");
    put("examples/02_b/b.yaml",
        "tasks:\n  loop: {component: pid, constants: {low: [1 V, 2 V]}, alias: {kp: gain, in: [a, b]}}\n"
        "  pid: {constants: {low: 3 V}}\n  other: {component: arm, constants: {low: 4 V}}\n"
        "operator: {gain: 0.5 V.s/rad, kp: 7}\nconstants: {in: 9}\n");
    put("examples/01_a/a.yaml", "tasks: {pid: {constants: {low: 3 V}}}\n");
    put("examples/01_a/broken.yaml", "tasks: {pid: [");
    put("examples/01_a/README.md", "# The first\n");
    put("components/pid.test.yaml", "tasks: {pid: }\noperator: {kp: \"1, 2\"}\nconstants: {low: 1 V}\n");
    pages.emplace(place);
    const std::string folder = place + "/components";
    library.emplace(
        Library::of_entries({entry(folder, "pid",
                                   {port("low", CHIMERA_IN_CONST, "V"), port("kp", CHIMERA_IN_VAR, "V.s/rad"),
                                    port("in", CHIMERA_IN_VAR, "U", "[n...<=64]"), port("out", CHIMERA_OUT_VAR, "V")}),
                             entry(folder, "speed", {port("speed", CHIMERA_OUT_VAR, "rad/s", "[2]")})},
                            our_units()));
  }
  void TearDown() override { fs::remove_all(place); }
  void put(const std::string& name, const std::string& text) const {
    fs::create_directories(fs::path(place + "/" + name).parent_path());
    std::ofstream(place + "/" + name) << text;
  }
  std::string values(const std::string& of) {
    const auto answer = pages->values(*library, "pid", of);
    std::string text;
    for (const Json& one : (*answer.result)["values"])
      text += one["value"].as_string() + " <- " + one["origin"].as_string() + "\n";
    return text;
  }

  std::string place;
  std::optional<LibraryPages> pages;
  std::optional<Library> library;
};

TEST_F(LibraryPagesTest, GivesPortsWordsPapersAndTimeOfEachComponent) {
  const Json answer = pages->library(*library);
  const Json& pid = answer["components"][0];
  EXPECT_EQ(pid["name"], Json("pid"));
  EXPECT_EQ(pid["file"], Json(place + "/components/pid.so"));
  EXPECT_EQ(pid["time"], Json("38 ns typical, 70 ns worst"));
  EXPECT_EQ(pid["papers"].dump(), R"(["b","meier-1999"])");
  EXPECT_EQ(pid["words"].as_string().substr(0, 34), "1999 38 70 9 chimera controls docs");
  EXPECT_TRUE(pid["words"].as_string().ends_with(" typical worst Über")) << pid["words"];
  EXPECT_EQ(pid["ports"][2].dump(Json::Style::kAsMade),
            R"({"port":"in","kind":"in-var","type":"float64","unit":"U","shape":"[n...<=64]",)"
            R"("repeated":false,"doc":""})");
  EXPECT_TRUE(answer["components"][1]["time"].is_null());
  EXPECT_EQ(answer["documents"].dump(Json::Style::kAsMade),
            R"([{"name":"examples/01_a/README.md","title":"The first"},)"
            R"({"name":"examples/02_b/README.md","title":"The second"},)"
            R"({"name":"library/pid/README.md","title":"pid"}])");
}

TEST_F(LibraryPagesTest, NamesDescriptorsThatCannotBeReadWithTheReason) {
  const std::string folder = place + "/components";
  put("components/bad.component.json", "{");
  const std::string folders[] = {folder};
  const Json faults = pages->library(Library::make(folders, our_units()))["faults"];
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0]["file"], Json(folder + "/bad.component.json"));
  EXPECT_FALSE(faults[0]["message"].as_string().empty());
}

TEST_F(LibraryPagesTest, GivesSheetSourcesLessonsAndFittingPortsOfAComponent) {
  const Json sheet = *pages->sheet(*library, "pid").result;
  EXPECT_EQ(sheet["text"], Json(kSheet));
  EXPECT_EQ(sheet["document"], Json("library/pid/README.md"));
  EXPECT_EQ(sheet["sources"].dump(), R"(["library/pid/pid.cc"])");
  EXPECT_EQ(sheet["lessons"].dump(Json::Style::kAsMade),
            R"([{"document":"examples/01_a/README.md","title":"The first"},)"
            R"({"document":"examples/02_b/README.md","title":"The second"}])");
  EXPECT_EQ(sheet["fits"].dump(Json::Style::kAsMade),
            R"([{"port":"in","with":[{"component":"pid","port":"out"},{"component":"speed","port":"speed"}],"more":0},)"
            R"({"port":"out","with":[{"component":"pid","port":"in"}],"more":0}])");
  put("components/pid.md", "# another component of that name\n");
  const Json other = *pages->sheet(*library, "pid").result;
  EXPECT_TRUE(other["document"].is_null());
  EXPECT_EQ(other["sources"].size(), 0u);
  EXPECT_TRUE((*pages->sheet(*library, "speed").result)["text"].is_null());
}

TEST_F(LibraryPagesTest, RefusesAnUnknownNameWithTheNearest) {
  EXPECT_EQ(pages->sheet(*library, "pdi").message, "no component 'pdi'; did you mean 'pid'?");
  EXPECT_EQ(pages->values(*library, "pod", "low").detail("nearest"), "pid");
  EXPECT_EQ(pages->values(*library, "pid", "kq").message, "no port 'kq'; did you mean 'kp'?");
  const auto answer = pages->document("library/pid/READM.md");
  EXPECT_EQ(answer.code, control::kUnknown);
  EXPECT_EQ(answer.detail("nearest"), "library/pid/README.md");
  EXPECT_EQ(pages->document("../../etc/passwd").code, control::kUnknown);
}

TEST_F(LibraryPagesTest, GivesATextAsItIsAndAPictureInBase64) {
  EXPECT_EQ((*pages->document("library/pid/pid.cc").result).dump(Json::Style::kAsMade),
            R"({"name":"library/pid/pid.cc","text":"// code\n"})");
  EXPECT_EQ((*pages->document("library/pid/response.svg").result).dump(Json::Style::kAsMade),
            R"({"name":"library/pid/response.svg","type":"image/svg+xml","base64":"PHN2Zy8+"})");
  fs::remove(place + "/library/pid/pid.cc");
  EXPECT_EQ(pages->document("library/pid/pid.cc").code, control::kRefused);
}

TEST_F(LibraryPagesTest, OffersTheValuesOfLessonsBeforeThoseOfTheTestOfTheComponent) {
  EXPECT_EQ(values("low"), "3 V <- examples/01_a/a.yaml\n[1 V, 2 V] <- examples/02_b/b.yaml\n1 V <- pid.test.yaml\n");
  EXPECT_EQ(values("kp"),
            "0.5 V.s/rad <- examples/02_b/b.yaml\n7 <- examples/02_b/b.yaml\n\"1, 2\" <- pid.test.yaml\n");
  EXPECT_EQ(values("in"), "9 <- examples/02_b/b.yaml\n");  // of the task without an alias
  EXPECT_EQ(values("out"), "");
}

/// Ports that fit `of` when the library has this port alone.
bool fits(const PortDescriptor& of, const PortDescriptor& other) {
  return !fitting_ports(Library::of_entries({entry("", "a", {other})}, our_units()), of, 9).with.empty();
}

TEST(FittingPorts, AgreeInTypeUnitAndShape) {
  const auto in = [](const char* unit, const char* shape = "", std::uint32_t type = CHIMERA_FLOAT64) {
    return port("x", CHIMERA_IN_VAR, unit, shape, type);
  };
  const auto out = [](const char* unit, const char* shape = "", std::uint32_t type = CHIMERA_FLOAT64) {
    return port("y", CHIMERA_OUT_VAR, unit, shape, type);
  };
  EXPECT_TRUE(fits(in("V"), out("V")));
  EXPECT_TRUE(fits(in("N.m"), out("kg.m2/s2")));
  EXPECT_FALSE(fits(in("V"), out("mV")));
  EXPECT_FALSE(fits(in("V"), out("A")));
  EXPECT_TRUE(fits(in("U/s"), out("m/s")));
  EXPECT_FALSE(fits(in("U2"), out("m")));
  EXPECT_TRUE(fits(in("U"), out("X")));
  EXPECT_FALSE(fits(in("V", "[3]"), out("V", "[4]")));
  EXPECT_FALSE(fits(in("V", "[3]"), out("V")));
  EXPECT_TRUE(fits(in("V", "[n<=10]"), out("V", "[6]")));
  EXPECT_FALSE(fits(in("V", "[n<=10]"), out("V", "[11]")));
  EXPECT_TRUE(fits(in("V", "[n...<=64]"), out("V", "[8][8]")));
  EXPECT_FALSE(fits(in("V", "[n...<=64]"), out("V", "[65]")));
  EXPECT_FALSE(fits(in("1", "", CHIMERA_BOOL), out("1")));
  EXPECT_TRUE(fits(in("1", "", CHIMERA_ANY), out("1", "", CHIMERA_BOOL)));
  EXPECT_FALSE(fits(in("1", "", CHIMERA_ANY), out("1", "", CHIMERA_STRUCT)));
  EXPECT_FALSE(fits(in("V"), in("V")));
  EXPECT_FALSE(fits(port("k", CHIMERA_IN_CONST, "V"), out("V")));
  EXPECT_TRUE(fits(port("k", CHIMERA_IN_CONST, "V"), port("k", CHIMERA_OUT_CONST, "V")));
  EXPECT_FALSE(fits(port("d", CHIMERA_RESOURCE, "1"), port("d", CHIMERA_RESOURCE, "1")));
}

TEST(FittingPorts, ListsPortsWithoutVariablesFirstAndCountsThoseLeftOut) {
  std::vector<LibraryEntry> entries;
  for (int i = 0; i < 9; ++i)
    entries.push_back(entry("", "c" + std::to_string(i), {port("y", CHIMERA_OUT_VAR, i == 7 ? "V" : "U")}));
  const Library library = Library::of_entries(std::move(entries), our_units());
  const auto found = fitting_ports(library, port("x", CHIMERA_IN_VAR, "V"), 3);
  EXPECT_EQ(found.with, (std::vector<FittingPort>{{"c7", "y"}, {"c0", "y"}, {"c1", "y"}}));
  EXPECT_EQ(found.n_more, 6u);
}

TEST(LibraryPages, OffersOfTheCheckoutComeFromItsLessons) {
  LibraryPages pages{source_path("")};
  const PortDescriptor kp = port("kp", CHIMERA_IN_VAR, "N.m/rad");
  const Library library = Library::of_entries({entry("", "pid_joint", {kp})}, our_units());
  const Json first = (*pages.values(library, "pid_joint", "kp").result)["values"][0];
  EXPECT_EQ(first["origin"], Json("examples/01_puma_pid/heavy.yaml"));
  EXPECT_TRUE(first["value"].as_string().starts_with("[")) << first;
}

}  // namespace
}  // namespace chimera::web
