// SPDX-License-Identifier: Apache-2.0
// Good and faulty objects: chimera/load/testing.
#include "chimera/load/shared_object.h"

#include <elf.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <sstream>

#include "chimera/base/testing/tree_path.h"
#include "chimera/load/component_state.h"

namespace chimera {
namespace {

std::string object(const std::string& name) { return build_path("chimera/load/test_objects/" + name); }

/// A file that is removed at the end of the test.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& text) {
    const int file = ::mkstemp(path_);
    EXPECT_GE(file, 0);
    ::close(file);
    write(text);
  }
  ~TemporaryFile() { ::unlink(path_); }
  void write(const std::string& text) { std::ofstream(path_, std::ios::binary) << text; }
  std::string path() const { return path_; }

 private:
  char path_[32] = "/tmp/shared_object_XXXXXX";
};

std::string contents(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

std::string refusal(const std::string& path) {
  const auto opened = SharedObject::open(path);
  if (opened) return "opened";
  EXPECT_EQ(opened.error().where.view(), path.substr(0, 200));
  return std::string(opened.error().message.view());
}

/// The answer of inspect(), which runs no code of the file.
std::string inspection(const std::string& path, const std::string& component = "counter") {
  const auto sound = SharedObject::inspect(path, component);
  return sound ? "sound" : std::string(sound.error().message.view());
}

std::string rebuild(const std::string& path, const std::string& clause) {
  return path.substr(path.rfind('/') + 1) + " " + clause + ". Rebuild the component.";
}

/// Runs one cycle of counter.so and returns the count of its object.
std::int32_t count_once(const chimera_component& component, ComponentState& instance) {
  std::int32_t count = 0;
  const chimera_port_decl& port = component.ports[0];
  reinterpret_cast<chimera_port*>(static_cast<std::byte*>(instance.state()) + port.live_offset)->value = &count;
  chimera_call call{};
  chimera_fault fault{};
  call.fault = &fault;
  EXPECT_EQ(component.methods[CHIMERA_CYCLE](instance.state(), &call), CHIMERA_OK);
  return count;
}

TEST(SharedObject, OffersItsComponents) {
  const auto opened = SharedObject::open(object("counter.so"));
  ASSERT_TRUE(opened) << opened.error().message.view();
  ASSERT_EQ(opened->components().size(), 1u);
  EXPECT_STREQ(opened->components()[0]->name, "counter");
  EXPECT_TRUE(opened->component("counter"));
}

TEST(SharedObject, RefusesAFileThatIsNotThere) {
  EXPECT_EQ(refusal("/nowhere/at/all.so"), "cannot be opened: No such file or directory");
  EXPECT_EQ(SharedObject::open("/nowhere/at/all.so").error().code, ErrorCode::kNotFound);
}

TEST(SharedObject, RefusesAFileThatIsNoSharedObject) {
  const TemporaryFile text("subsystem: puma\n"), empty("");
  EXPECT_EQ(refusal(text.path()), rebuild(text.path(), "is not a shared object: it does not begin with the ELF mark"));
  EXPECT_EQ(refusal(empty.path()), rebuild(empty.path(), "is empty (0 bytes)"));
  EXPECT_EQ(refusal("/tmp"), "is no ordinary file but a folder");
}

TEST(SharedObject, RefusesAnObjectCutShortAtAnyPlace) {
  const std::string whole = contents(object("counter.so"));
  for (std::size_t size = 4; size < whole.size(); size += 97) {
    const TemporaryFile cut(whole.substr(0, size));
    ASSERT_EQ(refusal(cut.path()), rebuild(cut.path(), "is truncated (" + std::to_string(size) + " bytes)"));
    ASSERT_EQ(inspection(cut.path()), refusal(cut.path()));
  }
}

TEST(SharedObject, RefusesAnObjectForAnotherMachine) {
  std::string other = contents(object("counter.so"));
  other[18] = '\x03';  // e_machine: 80386
  const TemporaryFile machine(other);
  EXPECT_EQ(refusal(machine.path()),
            rebuild(machine.path(), "was built for another kind of processor; this machine is x86-64"));
  other = contents(object("counter.so"));
  other[16] = '\x01';  // e_type: relocatable
  const TemporaryFile kind(other);
  EXPECT_EQ(refusal(kind.path()), rebuild(kind.path(), "is not a shared object: it is another kind of ELF file"));
}

TEST(SharedObject, RefusesAnObjectThatCannotBeLinked) {
  EXPECT_EQ(refusal(object("unresolved.so")), "cannot be loaded: undefined symbol: chimera_test_that_nobody_has");
}

TEST(SharedObject, RefusesAnObjectWithoutComponents) {
  EXPECT_EQ(refusal(object("no_symbol.so")),
            "no_symbol.so offers no components: it has no symbol chimera_components, so no CHIMERA_COMPONENT or "
            "PBO_MODULE was built into it. Rebuild the component.");
  EXPECT_EQ(refusal(object("nothing_offered.so")), "nothing_offered.so offers no component. Rebuild the component.");
}

TEST(SharedObject, RefusesAnObjectThatMakesRealTimeThreadsWait) {
  const std::string tls = rebuild("thread_local.so",
                                  "has a thread_local variable, whose first use in a real-time thread asks the heap: "
                                  "make it a member of the component, or give it "
                                  "__attribute__((tls_model(\"initial-exec\")))");
  EXPECT_EQ(refusal(object("thread_local.so")), tls);
  EXPECT_EQ(inspection(object("thread_local.so")), tls);
  std::string marked = contents(object("marked_tls.so"));
  const std::uint64_t mark = CHIMERA_THREAD_MARK;
  const std::size_t at = marked.find(std::string_view(reinterpret_cast<const char*>(&mark), sizeof mark));
  ASSERT_NE(at, std::string::npos);
  EXPECT_EQ(inspection(object("marked_tls.so")),  // inspect() goes on behind it
            rebuild("marked_tls.so", "offers no components: it has no symbol " CHIMERA_COMPONENTS_SYMBOL));
  marked[at] ^= 1;
  const TemporaryFile other(marked);
  EXPECT_NE(inspection(other.path()).find("has a thread_local variable"), std::string::npos);
  const std::string text = rebuild(
      "text_relocations.so",
      "has text relocations, so its code is written when it is loaded: compile all of it with -fPIC");
  EXPECT_EQ(refusal(object("text_relocations.so")), text);
  EXPECT_EQ(inspection(object("text_relocations.so")), text);
  EXPECT_EQ(inspection(object("static_tls.so")),  // inspect() goes on behind it
            rebuild("static_tls.so", "offers no components: it has no symbol " CHIMERA_COMPONENTS_SYMBOL));
}

TEST(SharedObject, RefusesAnotherVersionOfTheInterface) {
  EXPECT_EQ(refusal(object("other_abi.so")),
            "other_abi.so was built for another ABI; this chimera needs ABI 1. Rebuild the component.");
}

TEST(SharedObject, IsInspectedWithoutBeingRun) {
  EXPECT_EQ(inspection(object("counter.so")), "sound");
  EXPECT_EQ(inspection(object("counter.so"), "kounter"),
            "counter.so is not the object of kounter: that name does not stand in it. Rebuild the component.");
  EXPECT_EQ(inspection(object("no_symbol.so"), "no_symbol"),
            "no_symbol.so offers no components: it has no symbol chimera_components. Rebuild the component.");
  EXPECT_EQ(inspection("/nowhere/at/all.so"), "all.so is missing. Rebuild the component.");
  const TemporaryFile empty("");
  EXPECT_EQ(inspection(empty.path()), rebuild(empty.path(), "is empty (0 bytes)"));
  EXPECT_EQ(inspection("/tmp"), "is no ordinary file but a folder");
}

TEST(SharedObject, InspectionStandsAnyDamage) {
  const std::string whole = contents(object("counter.so"));
  std::string damaged = whole;
  TemporaryFile file(whole);
  for (std::size_t at = 0; at < 64; ++at) {  // the header, byte by byte
    for (const char byte : {'\0', '\x7f', '\xff'}) {
      damaged[at] = byte;
      file.write(damaged);
      EXPECT_FALSE(inspection(file.path()).empty());
    }
    damaged[at] = whole[at];
  }
  Elf64_Ehdr head{};
  std::memcpy(&head, whole.data(), sizeof head);
  for (std::size_t at = head.e_shoff; at < whole.size(); ++at) {  // the table of sections
    damaged[at] = '\xff';
    file.write(damaged);
    EXPECT_FALSE(inspection(file.path()).empty());
    damaged[at] = whole[at];
  }
}

TEST(SharedObject, NamesItsComponentsInPlaceOfAnUnknownOne) {
  const auto opened = SharedObject::open(object("counter.so"));
  ASSERT_TRUE(opened);
  EXPECT_EQ(opened->component("kounter").error().message.view(), "has no component kounter; it offers counter");
}

TEST(SharedObject, MatchesItsOwnDescriptorAndNamesThePortThatDiffers) {
  const auto opened = SharedObject::open(object("counter.so"));
  ASSERT_TRUE(opened);
  Descriptor file = describe(**opened->component("counter")).value();
  EXPECT_TRUE(opened->matching(file));
  file.ports[0].unit = "m";
  const auto differs = opened->matching(file);
  ASSERT_FALSE(differs);
  const std::string_view said = differs.error().message.view();
  EXPECT_NE(said.find("port count"), std::string_view::npos) << said;
  EXPECT_EQ(differs.error().where.view(), object("counter.so").substr(0, 200));
  file.name = "other";
  EXPECT_EQ(opened->matching(file).error().message.view(), "has no component other; it offers counter");
}

TEST(SharedObject, IsNotChangedByOverwritingItsFile) {
  TemporaryFile file(contents(object("counter.so")));
  const auto opened = SharedObject::open(file.path());
  ASSERT_TRUE(opened);
  file.write(std::string(contents(object("counter.so")).size(), '\0'));
  const auto component = opened->component("counter");
  ASSERT_TRUE(component);
  auto instance = ComponentState::make(**component);
  ASSERT_TRUE(instance);
  EXPECT_EQ(count_once(**component, *instance), 1);
}

TEST(SharedObject, OpenedTwiceSharesNothing) {
  const auto first = SharedObject::open(object("counter.so"));
  const auto second = SharedObject::open(object("counter.so"));
  ASSERT_TRUE(first && second);
  const auto one = first->component("counter"), two = second->component("counter");
  ASSERT_TRUE(one && two);
  EXPECT_NE(*one, *two);
  auto a = ComponentState::make(**one), b = ComponentState::make(**two);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(count_once(**one, *a), 1);
  EXPECT_EQ(count_once(**one, *a), 2);
  EXPECT_EQ(count_once(**two, *b), 1);
}

TEST(ComponentState, CarriesTheTextOfAConstructorThatRefuses) {
  const auto opened = SharedObject::open(object("broken_state.so"));
  ASSERT_TRUE(opened);
  EXPECT_EQ(ComponentState::make(*opened->components()[0]).error().message.view(),
            "component broken_state cannot be made: no");
}

TEST(ComponentState, IsZeroedAndMovesAsAHandle) {
  const auto opened = SharedObject::open(object("counter.so"));
  ASSERT_TRUE(opened);
  auto made = ComponentState::make(*opened->components()[0]);
  ASSERT_TRUE(made);
  void* const state = made->state();
  for (std::uint32_t i = 0; i < made->component().state_size; ++i)
    ASSERT_EQ(static_cast<std::byte*>(state)[i], std::byte{0}) << i;
  const ComponentState moved = std::move(*made);
  EXPECT_EQ(moved.state(), state);
  EXPECT_EQ(made->state(), nullptr);
}

}  // namespace
}  // namespace chimera
