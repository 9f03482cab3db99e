// SPDX-License-Identifier: Apache-2.0
// Components compiled with CHIMERA_BARE and without, from the same sources: the same specification gives both the same
// places, publishes the same bytes from both, and gives both the same faults. This program must not make a component in
// C++ itself: inline functions of the two compilations have the same names.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "chimera/runtime/testing/test_application.h"
#include "tests/conformance/runner.h"

extern "C" {
extern const chimera_component chimera_component_t_beyond;
extern const chimera_component chimera_component_t_constants;
extern const chimera_component chimera_component_t_extent;
extern const chimera_component chimera_component_t_generic;
extern const chimera_component chimera_component_t_parts;
extern const chimera_component chimera_component_t_repeat;
extern const chimera_component chimera_component_t_resource;
extern const chimera_component chimera_component_t_source;
extern const chimera_component chimera_component_t_struct;
extern const chimera_component chimera_component_t_tderiv;
extern const chimera_component chimera_component_t_values;
}

namespace chimera::toy::bare_faces_test {
namespace {

const chimera_component* loaded(const std::string& name) {
  void* const object = ::dlopen((std::string(COMPONENTS "/") + name + ".so").c_str(), RTLD_NOW | RTLD_LOCAL);
  if (object == nullptr) ADD_FAILURE() << ::dlerror(), std::abort();
  std::uint32_t count = 0;
  const auto all = reinterpret_cast<chimera_components_fn>(::dlsym(object, CHIMERA_COMPONENTS_SYMBOL));
  return all(CHIMERA_ABI_VERSION, &count)[0];
}

/// One component, both ways.
struct Both {
  explicit Both(const chimera_component& of) : name(of.name), bare(of), hosted(*loaded(of.name)) {}

  std::string name;
  const chimera_component& bare;
  const chimera_component& hosted;
};

const std::deque<Both>& components() {
  static const std::deque<Both> all = [] {
    std::deque<Both> made;
    for (const chimera_component* one :
         {&chimera_component_t_beyond, &chimera_component_t_constants, &chimera_component_t_extent,
          &chimera_component_t_generic, &chimera_component_t_parts, &chimera_component_t_repeat,
          &chimera_component_t_resource, &chimera_component_t_source, &chimera_component_t_struct,
          &chimera_component_t_tderiv, &chimera_component_t_values})
      made.emplace_back(*one);
    return made;
  }();
  return all;
}

/// A task of each component, named like it; all from the declarations of the loaded ones.
class Scene {
 public:
  explicit Scene(bool is_bare) : is_bare_(is_bare) {
    for (const Both& one : components()) app_.add(one.name.c_str(), &one.hosted);
    for (std::size_t task = 0; task < components().size(); ++task) link_outputs(task);
    const std::pair<const char*, const char*> second[] = {
        {"t_repeat.in", "t_source.x"}, {"t_repeat.out", "t_repeat.out.2"}, {"t_beyond.in", "t_source.x"},
        {"t_parts.in", "t_beyond.list"}, {"t_parts.gain", ""}, {"t_parts.out", "t_parts.out.2"},
        {"t_parts.label", "t_parts.label.2"}};
    for (const auto& [many, to] : second) app_.add_instance(place(many).first, place(many).second, to);
    // Outputs of this scene that have at least as many bytes. A pose is made of numbers.
    const std::pair<const char*, const char*> readers[] = {
        {"t_repeat.in", "t_source.x"}, {"t_beyond.in", "t_source.x"}, {"t_tderiv.x", "t_source.x"},
        {"t_generic.x", "t_source.x"}, {"t_parts.x", "t_source.x"}, {"t_values.real", "t_source.x"},
        {"t_parts.in", "t_beyond.list"}, {"t_extent.q", "t_beyond.list"}, {"t_struct.pose", "t_extent.outer"},
        {"t_parts.pose", "t_extent.outer"}, {"t_parts.m", "t_extent.identity"}, {"t_values.flag", "t_source.expired"},
        {"t_values.small", "t_constants.inits"}, {"t_values.large", "t_beyond.errors"},
        {"t_values.single", "t_values.single_half"}, {"t_values.text", "t_values.echo"}};
    for (const auto& [reader, to] : readers) link(reader, to);
    for (const char* x : {"t_generic.x", "t_generic.y", "t_parts.x", "t_parts.y"}) port(x).type = CHIMERA_FLOAT64;
    for (const char* own : {"t_constants.joints", "t_constants.scale", "t_source.start", "t_source.slope",
                            "t_source.spend", "t_parts.gain"})
      link(own, "");
    set_extents();
    port("t_resource.file").value = std::as_bytes(std::span(file()));
    for (std::size_t task = 0; task < app_.tasks.size(); ++task) fill(task);
  }

  PortSpec& port(const char* where) {
    const auto [task, index] = place(where);
    return app_.port(task, index);
  }
  Result<std::unique_ptr<HeapTaskSet>> build() {
    const ApplicationSpec& spec = app_.make();
    if (is_bare_)
      for (std::size_t task = 0; task < components().size(); ++task) app_.components[task] = &components()[task].bare;
    return HeapTaskSet::create(spec, app_.components);
  }

 private:
  /// "task.port"
  static std::pair<std::size_t, std::size_t> place(const std::string& where) {
    const std::size_t dot = where.find('.');
    for (std::size_t task = 0; task < components().size(); ++task) {
      const Both& one = components()[task];
      for (std::size_t p = 0; one.name == where.substr(0, dot) && p < one.hosted.n_ports; ++p)
        if (one.hosted.ports[p].name == where.substr(dot + 1)) return {task, p};
    }
    ADD_FAILURE() << where;
    std::abort();
  }
  /// Each out-var makes a variable of its own: "task.port".
  void link_outputs(std::size_t task) {
    const Both& one = components()[task];
    for (std::size_t p = 0; p < one.hosted.n_ports; ++p)
      if (one.hosted.ports[p].kind == CHIMERA_OUT_VAR)
        app_.link(task, p, names_.emplace_back(one.name + "." + one.hosted.ports[p].name));
  }
  void link(const char* where, std::string_view to) {
    const auto [task, index] = place(where);
    app_.link(task, index, to);
  }
  void set_extents() {
    for (const char* of_ndof : {"t_constants.length", "t_extent.length", "t_extent.q", "t_extent.arc"}) {
      const auto [task, index] = place(of_ndof);
      app_.extend(task, index, 10, "ndof");
    }
    port("t_extent.outer").extent[0].max = port("t_extent.outer").extent[1].max = 3;
    for (const char* three : {"t_extent.last", "t_beyond.list"}) port(three).extent[0].max = 3;
    port("t_extent.identity").extent[0].max = port("t_extent.identity").extent[1].max = 3;
    port("t_beyond.matrix").extent[0].max = port("t_beyond.matrix").extent[1].max = 2;
    port("t_values.words").extent[0].max = port("t_parts.in").extent[0].max = 2;
    port("t_parts.m").extent[0].max = 3, port("t_parts.m").extent[1].max = 2;
    port("t_parts.sizes").extent[0].max = 6;
  }
  /// One initial value stands for all elements.
  void fill(std::size_t task) {
    for (std::size_t p = 0; p < components()[task].hosted.n_ports; ++p) {
      PortSpec& port = app_.port(task, p);
      if (port.kind == CHIMERA_RESOURCE || port.value.empty() || port.value.size() >= port.max_bytes()) continue;
      std::vector<std::byte>& all = values_.emplace_back();
      while (all.size() < port.max_bytes()) all.insert(all.end(), port.value.begin(), port.value.end());
      port.value = all;
    }
  }
  static const std::string& file() {
    static const std::string path = [] {
      std::string made = ::testing::TempDir() + "bare_faces_number";
      std::FILE* const to = std::fopen(made.c_str(), "w");
      std::fputs("2.5", to);
      std::fclose(to);
      return made;
    }();
    return path;
  }

  bool is_bare_;
  testing::TestApplication app_;
  std::deque<std::string> names_;
  std::deque<std::vector<std::byte>> values_;
};

std::ptrdiff_t place_in(const Task& task, const chimera_port* port) {
  return reinterpret_cast<const std::byte*>(port) - static_cast<const std::byte*>(task.instance);
}

void expect_equal(const TaskSet& a, const TaskSet& b, std::size_t task) {
  SCOPED_TRACE(components()[task].name);
  const Task &one = a.tasks()[task], &other = b.tasks()[task];
  ASSERT_EQ(one.outputs.size(), other.outputs.size());
  ASSERT_EQ(one.state, other.state);
  const chimera_slot &slot = *one.group.published(), &other_slot = *other.group.published();
  EXPECT_EQ(slot.sequence, other_slot.sequence);
  EXPECT_EQ(slot.valid, other_slot.valid);
  for (std::size_t i = 0; i < one.outputs.size(); ++i) {
    const Output& output = one.outputs[i];
    ASSERT_EQ(output.offset, other.outputs[i].offset);
    ASSERT_EQ(place_in(one, output.port), place_in(other, other.outputs[i].port));
    EXPECT_EQ(std::memcmp(reinterpret_cast<const std::byte*>(&slot + 1) + output.offset,
                          reinterpret_cast<const std::byte*>(&other_slot + 1) + output.offset, output.bytes), 0)
        << "out-var " << i;
  }
  for (std::size_t i = 0; i < one.inputs.size(); ++i)
    EXPECT_EQ(place_in(one, one.inputs[i].port), place_in(other, other.inputs[i].port));
  EXPECT_EQ(one.faults.count, other.faults.count);
  EXPECT_EQ(one.faults.method, other.faults.method);
  EXPECT_EQ(one.faults.at, other.faults.at);
  EXPECT_EQ(one.faults.last.code, other.faults.last.code);
  EXPECT_STREQ(one.faults.last.text, other.faults.last.text);
}

TEST(BareFaces, PublishTheBytesAndHaveTheFaultsOfTheLoadedOnes) {
  Scene scenes[2] = {Scene(false), Scene(true)};
  const auto first = scenes[0].build(), second = scenes[1].build();
  ASSERT_TRUE(first) << first.error().message.c_str();
  ASSERT_TRUE(second) << second.error().message.c_str();
  Runner one(**first, Kind::kExecutiveOnTwin), other(**second, Kind::kExecutiveOnTwin);
  ASSERT_TRUE(one.start());
  ASSERT_TRUE(other.start());
  for (std::int64_t n = 1; n <= 30; ++n) {
    one.run(milliseconds(n)), other.run(milliseconds(n));
    for (std::size_t task = 0; task < components().size(); ++task) expect_equal(**first, **second, task);
  }
  const Task& beyond = (*second)->tasks()[0];
  EXPECT_EQ(beyond.faults.count, 7u);
  EXPECT_STREQ(beyond.faults.last.text, "index 31 of a port that has 3");
  EXPECT_EQ(beyond.state, chimera::State::kOn);
}

/// The refusal of a specification that `change` makes wrong.
std::string refusal(bool is_bare, const std::function<void(Scene&)>& change) {
  Scene scene(is_bare);
  change(scene);
  const auto made = scene.build();
  return made ? "accepted" : std::string(made.error().where.view()) + ": " + std::string(made.error().message.view());
}

TEST(BareFaces, RefuseTheSpecificationsThatTheLoadedOnesRefuse) {
  const std::function<void(Scene&)> changes[] = {
      [](Scene& scene) { scene.port("t_repeat.in").kind = CHIMERA_OUT_VAR; },
      [](Scene& scene) { scene.port("t_values.large").element_bytes = 4; },
      [](Scene& scene) { scene.port("t_repeat.out").instance = 4; },
      [](Scene& scene) { scene.port("t_struct.battery").element_bytes = 8; },
      [](Scene& scene) { scene.port("t_struct.battery").declared = 4; }};
  for (const auto& change : changes) {
    const std::string bare = refusal(true, change);
    EXPECT_EQ(bare, refusal(false, change));
    EXPECT_NE(bare.find("was it built from another source than its descriptor?"), std::string::npos) << bare;
  }
}

}  // namespace
}  // namespace chimera::toy::bare_faces_test
