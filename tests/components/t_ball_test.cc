// SPDX-License-Identifier: Apache-2.0
// The C face (chimera/task/pbo.h), seen through a component written in C.
#include <gtest/gtest.h>

#include "chimera/task/rig.h"

// The table that a microcontroller uses.
extern "C" const chimera_component chimera_component_t_ball;

namespace chimera {
namespace {

const chimera_component& ball() { return linked_component("t_ball"); }

const chimera_port_decl& port(const char* name) {
  for (std::uint32_t i = 0; i < ball().n_ports; ++i)
    if (std::string(ball().ports[i].name) == name) return ball().ports[i];
  std::abort();
}

struct Ball : Rig {
  explicit Ball(const char* device = "ball0") : Rig("t_ball") {
    resource("device", device);
    for (std::size_t i = 0; i < 3; ++i) set("turn", 0.0, i);
  }
};

TEST(CFace, DeclaresThePortsOfPboPorts) {
  EXPECT_EQ(ball().n_ports, 11u);
  EXPECT_STREQ(ball().doc, "Trackball, written in C.");
  EXPECT_STREQ(ball().source, "Stewart 2000, figure 9");
  EXPECT_EQ(ball().default_rate_hz, 50);
  EXPECT_EQ(port("turn").kind, std::uint32_t{CHIMERA_IN_VAR});
  EXPECT_STREQ(port("turn").unit, "1/s");
  EXPECT_STREQ(port("turn").shape, "[3]");
  EXPECT_EQ(port("device").kind, std::uint32_t{CHIMERA_RESOURCE});
  EXPECT_EQ(port("axes").kind, std::uint32_t{CHIMERA_OUT_CONST});
  EXPECT_EQ(port("axes").type, std::uint32_t{CHIMERA_INT32});
  EXPECT_STREQ(port("xd").frame, "base");
  EXPECT_EQ(port("state").type, std::uint32_t{CHIMERA_STRING});
  EXPECT_EQ(port("state").element_size, 64u);
}

TEST(CFace, DeclaresOptions) {
  EXPECT_EQ(port("start").initial_count, 3u);
  EXPECT_EQ(static_cast<const double*>(port("start").initial)[2], 3.0);
  EXPECT_EQ(port("scale").flags, CHIMERA_PORT_HAS_RANGE | CHIMERA_PORT_HAS_INITIAL);
  EXPECT_EQ(port("scale").max, 10);
  EXPECT_EQ(port("force").flags, CHIMERA_PORT_HAS_RANGE | CHIMERA_PORT_HAS_INITIAL | CHIMERA_PORT_SAFETY);
}

TEST(CFace, DeclaresThatAConstantIsAtLeastAnother) {
  ASSERT_EQ(ball().n_orders, 1u);
  EXPECT_STREQ(ball().orders[0].lower, "scale");
  EXPECT_STREQ(ball().orders[0].upper, "reach");
}

TEST(CFace, DeclaresTheWordsOfAConstant) {
  ASSERT_EQ(ball().n_choices, 1u);
  EXPECT_STREQ(ball().choices[0].port, "mode");
  EXPECT_STREQ(ball().choices[0].words, "free held");
}

TEST(CFace, FindsTheMethodsThatAreWrittenAndTakesTermForKill) {
  for (const std::uint32_t m : {CHIMERA_INIT, CHIMERA_ON, CHIMERA_CYCLE, CHIMERA_OFF, CHIMERA_KILL})
    EXPECT_NE(ball().methods[m], nullptr) << m;
  for (const std::uint32_t m : {CHIMERA_REINIT, CHIMERA_SYNC, CHIMERA_ERROR, CHIMERA_CLEAR})
    EXPECT_EQ(ball().methods[m], nullptr) << m;
}

TEST(CFace, TheConstantTableAnswersForMethodsThatAreNotWritten) {
  alignas(64) std::byte state[1024] = {};
  const chimera_component& table = chimera_component_t_ball;
  ASSERT_LE(table.state_size, sizeof state);
  const chimera_call call{};
  EXPECT_EQ(table.methods[CHIMERA_REINIT](state, &call), CHIMERA_OK);
  EXPECT_EQ(table.methods[CHIMERA_SYNC](state, &call), CHIMERA_OK);
  EXPECT_EQ(table.methods[CHIMERA_CLEAR](state, &call), CHIMERA_OK);
  EXPECT_EQ(table.methods[CHIMERA_ERROR](state, &call), CHIMERA_FAULT) << "it does not recover";
  EXPECT_EQ(table.event_source(state), -1);
  EXPECT_EQ(table.methods[CHIMERA_CYCLE], ball().methods[CHIMERA_CYCLE]);
}

TEST(CFace, AnOutVarHasItsValueAtOn) {
  Ball rig;
  ASSERT_TRUE(rig.init());
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<Text<64>>("state").view(), "idle");
  rig.inherit("xd", milliseconds(10));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<Text<64>>("state").view(), "handed over");
  rig.inherit("xd", milliseconds(11));
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<Text<64>>("state").view(), "outdated");
}

TEST(CFace, TheIncarnationIsThatOfTheProcess) {
  Ball rig;
  ASSERT_TRUE(rig.init());
  rig.incarnation(2);
  ASSERT_TRUE(rig.on());
  EXPECT_EQ(rig.get<Text<64>>("state").view(), "restarted");
}

TEST(CFace, MethodsReachTheirPortsByName) {
  Ball rig;
  rig.set("scale", 2.0);
  ASSERT_TRUE(rig.init());
  EXPECT_EQ(rig.get<std::int32_t>("axes"), 3);
  ASSERT_TRUE(rig.on());
  rig.set("turn", 1.5, 1);
  ASSERT_TRUE(rig.cycle(milliseconds(100)));
  EXPECT_DOUBLE_EQ(rig.get<double>("xd", 1), 0.3);
  EXPECT_TRUE(rig.get<bool>("moving"));
  EXPECT_EQ(rig.get<Text<64>>("state"), "moving");
  ASSERT_TRUE(rig.off());
  EXPECT_TRUE(rig.kill());
}

TEST(CFace, StartsAtItsLastOutput) {
  Ball rig;
  rig.set("xd", 5.0, 0);
  ASSERT_TRUE(rig.on());
  ASSERT_TRUE(rig.cycle());
  EXPECT_EQ(rig.get<double>("xd", 0), 5.0);
}

TEST(CFace, FaultsCarryTheirText) {
  Ball broken("broken");
  EXPECT_EQ(broken.init().text, "the ball does not answer");
  Ball rig;
  rig.set("turn", -1.0, 2);
  EXPECT_EQ(rig.cycle().text, "the third axis turns the wrong way");
  EXPECT_EQ(rig.kill().text, "killed without off");
}

TEST(CFace, BackgroundIsCalledBesideTheMethods) {
  Ball rig;
  EXPECT_TRUE(rig.background());
  EXPECT_EQ(rig.kill().text, "killed without off, after background");
}

TEST(CFace, AnUnknownAnswerIsAFaultWithItsNumber) {
  Ball rig;
  rig.set("turn", 101.0, 0);
  const RigAnswer answer = rig.cycle();
  EXPECT_EQ(answer.status, CHIMERA_FAULT);
  EXPECT_EQ(answer.code, 17);
  EXPECT_EQ(answer.text, "the method returned neither PBO_OK nor a fault with a text");
}

TEST(CFace, CycleMayAbort) {
  Ball rig;
  rig.expire(true);
  EXPECT_EQ(rig.cycle().status, CHIMERA_ABORTED);
}

}  // namespace
}  // namespace chimera
