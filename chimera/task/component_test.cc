// SPDX-License-Identifier: Apache-2.0
// Methods and outcomes: the C++ interface turns a class into a component.
#include "chimera/task/component.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "chimera/task/rig.h"

namespace chimera {
namespace {

struct Minimal {
  void cycle() {}
};
CHIMERA_COMPONENT(Minimal, "minimal", "Nothing but a cycle.");

struct Complete {
  Outcome init() { return ok(); }
  void reinit() {}
  void on(Cycle) {}
  Outcome cycle(Cycle) { return aborted(); }
  bool sync() { return false; }
  void off() {}
  void kill() {}
  bool error() { return false; }
  bool clear() { return false; }
};
CHIMERA_COMPONENT(Complete, "complete", "All nine.", rate = 250.0, source = "A book");

struct Careless {
  InConst<int> how{"how", "1", initial = 0};
  Outcome init() { return aborted(); }
  Outcome on() { return no_event(); }
  Outcome cycle() {
    switch (*how) {
      case 0: throw std::runtime_error("the sensor is gone");
      case 1: throw 3;
      case 2: throw "plain text";
      case 3: return fault("too hot", 12);
      case 4: return fault(std::string(500, 'x'));
      default: return no_event();
    }
  }
};
CHIMERA_COMPONENT(Careless, "careless", "Fails.");

struct Observer {
  Out<double> dt{"dt", "s"};
  Out<std::int64_t> now{"now", "ns"};
  Out<bool> illegal{"illegal"};
  Out<int> dropped{"dropped", "1"};
  Out<std::int64_t> count{"count", "1"};
  Outcome cycle(Cycle c) {
    if (c.expired()) return aborted();
    *dt = c.dt();
    *now = c.now().count;
    *illegal = c.illegal();
    *dropped = static_cast<int>(c.dropped());
    *count = static_cast<std::int64_t>(c.count());
    c.spend(microseconds(30));
    c.signal(Signal::kOff, "pid");
    c.signal(Signal::kReinit);
    return ok();
  }
};
CHIMERA_COMPONENT(Observer, "observer", "Shows its cycle.");

struct Ordered {
  InConst<double> low{"low", "m", initial = 0.0};
  InConst<double> high{"high", "m", initial = 1.0, range(0, 9), at_least = "low"};
  InConst<Text<8>> mode{"mode", initial = "free", one_of = "free held"};
  void cycle() {}
};
CHIMERA_COMPONENT(Ordered, "ordered", "Says what holds between its constants.");

struct Unmakeable {
  Unmakeable() { throw std::runtime_error("the licence has run out"); }
  void cycle() {}
};
CHIMERA_COMPONENT(Unmakeable, "unmakeable", "Its constructor fails.");

int living = 0;
struct Living {
  Living() { ++living; }
  ~Living() { --living; }
  void cycle() {}
};
CHIMERA_COMPONENT(Living, "living", "Counts its instances.");

RigAnswer careless_cycle(int how) {
  Rig rig("careless");
  rig.set("how", how);
  return rig.cycle();
}

TEST(Component, HasOnlyTheMethodsThatAreWritten) {
  for (std::uint32_t m = 0; m < CHIMERA_METHODS; ++m) {
    EXPECT_EQ(linked_component("minimal").methods[m] != nullptr, m == CHIMERA_CYCLE) << m;
    EXPECT_NE(linked_component("complete").methods[m], nullptr) << m;
  }
}

TEST(Component, SaysItsNameAndExtras) {
  EXPECT_STREQ(linked_component("minimal").doc, "Nothing but a cycle.");
  EXPECT_STREQ(linked_component("minimal").source, "");
  EXPECT_EQ(linked_component("minimal").default_rate_hz, 0);
  EXPECT_STREQ(linked_component("complete").source, "A book");
  EXPECT_EQ(linked_component("complete").default_rate_hz, 250);
  EXPECT_EQ(linked_component("complete").abi_version, CHIMERA_ABI_VERSION);
}

TEST(Component, DeclaresTheRelationsOfItsConstants) {
  EXPECT_EQ(linked_component("minimal").n_orders, 0u);
  ASSERT_EQ(linked_component("ordered").n_orders, 1u);
  EXPECT_STREQ(linked_component("ordered").orders[0].lower, "low");
  EXPECT_STREQ(linked_component("ordered").orders[0].upper, "high");
  EXPECT_EQ(linked_component("minimal").n_choices, 0u);
  ASSERT_EQ(linked_component("ordered").n_choices, 1u);
  EXPECT_STREQ(linked_component("ordered").choices[0].port, "mode");
  EXPECT_STREQ(linked_component("ordered").choices[0].words, "free held");
}

TEST(Component, AnotherAbiVersionGetsNothing) {
  std::uint32_t count = 7;
  EXPECT_EQ(chimera_components(CHIMERA_ABI_VERSION + 1, &count), nullptr);
  EXPECT_EQ(count, 0u);
}

TEST(Component, AnEscapingExceptionIsAFaultWithItsText) {
  EXPECT_EQ(careless_cycle(0).status, CHIMERA_FAULT);
  EXPECT_EQ(careless_cycle(0).text, "the sensor is gone");
  EXPECT_EQ(careless_cycle(1).text, "an exception that is not a std::exception");
  EXPECT_EQ(careless_cycle(2).text, "plain text");
}

TEST(Component, AFaultCarriesTextAndCode) {
  const RigAnswer answer = careless_cycle(3);
  EXPECT_EQ(answer.status, CHIMERA_FAULT);
  EXPECT_EQ(answer.text, "too hot");
  EXPECT_EQ(answer.code, 12);
  EXPECT_EQ(careless_cycle(4).text, std::string(CHIMERA_FAULT_TEXT - 1, 'x'));
}

TEST(Component, AnAnswerThatTheMethodCannotGiveIsAFault) {
  EXPECT_EQ(careless_cycle(5).text, "only sync may answer no_event()");
  Rig rig("careless");
  EXPECT_EQ(rig.init().text, "only cycle may answer aborted()");
  EXPECT_EQ(rig.on().text, "only sync may answer no_event()");
}

TEST(Component, NoMeansTheRightThingInEachMethod) {
  Rig rig("complete");
  EXPECT_EQ(rig.sync().status, CHIMERA_NO_EVENT);
  EXPECT_EQ(rig.cycle().status, CHIMERA_ABORTED);
  EXPECT_EQ(rig.error().text, "error() did not recover");
  EXPECT_EQ(rig.clear().text, "clear() found the cause still there");
}

TEST(Component, CycleHasTheArgumentsOfTheCall) {
  Rig rig("observer");
  rig.illegal(true);
  rig.dropped(2);
  ASSERT_TRUE(rig.cycle(milliseconds(2)));
  ASSERT_TRUE(rig.cycle(milliseconds(4)));
  EXPECT_DOUBLE_EQ(rig.get<double>("dt"), 0.004);
  EXPECT_EQ(rig.get<std::int64_t>("now"), 6'000'000);
  EXPECT_TRUE(rig.get<bool>("illegal"));
  EXPECT_EQ(rig.get<int>("dropped"), 2);
  EXPECT_EQ(rig.get<std::int64_t>("count"), 1);
  EXPECT_EQ(rig.spent(), microseconds(60));
  EXPECT_EQ(rig.signals(), (std::vector<std::string>{"off pid", "reinit", "off pid", "reinit"}));
  rig.expire(true);
  EXPECT_EQ(rig.cycle().status, CHIMERA_ABORTED);
}

TEST(Component, AConstructorThatThrowsIsAnAnswer) {
  chimera_fault fault{};
  alignas(Unmakeable) std::byte state[sizeof(Unmakeable)];
  EXPECT_EQ(linked_component("unmakeable").construct(state, &fault), CHIMERA_FAULT);
  EXPECT_STREQ(fault.text, "the constructor failed: the licence has run out");
}

TEST(Component, IsDestroyedOnceForEachConstruction) {
  EXPECT_EQ(linked_component("living").n_ports, 0u);  // declared already: the sample is destroyed
  EXPECT_EQ(living, 0);
  {
    Rig one("living"), two("living");
    EXPECT_EQ(living, 2);
  }
  EXPECT_EQ(living, 0);
}

}  // namespace
}  // namespace chimera
