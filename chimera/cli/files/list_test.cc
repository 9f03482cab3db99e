// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/files/list.h"

#include "chimera/cli/files/testing/test_place.h"

namespace chimera::cli {
namespace {

TEST(List, NamesEveryComponentOfTheFolders) {
  const CommandResult output = list(test_place(), false);
  EXPECT_EQ(output.code, kOk) << output.err;
  EXPECT_NE(output.out.find("t_counter "), std::string::npos);
  EXPECT_NE(output.out.find("  Publishes the arguments of its cycle.\n"), std::string::npos) << output.out;
}

TEST(List, SaysWhereToLookWhenThereIsNothing) {
  Workplace place = test_place();
  place.component_folders = {"/nowhere"};
  const CommandResult output = list(place, false);
  EXPECT_EQ(output.out, "");
  EXPECT_EQ(output.err, "no components found; CHIMERA_PATH says where to look\n");
  EXPECT_EQ(list(place, true).out, "{\"components\": []}\n");
}

TEST(Describe, ShowsPurposeRateMethodsAndPorts) {
  const CommandResult output = describe_component("t_counter", test_place(), false);
  EXPECT_EQ(output.code, kOk);
  EXPECT_EQ(output.out.rfind("t_counter: Publishes the arguments of its cycle.\n", 0), 0u) << output.out;
  EXPECT_NE(output.out.find("rate     1000 Hz by default\nreleased by the timer\nmethods  cycle\nports\n"),
            std::string::npos) << output.out;
  EXPECT_NE(output.out.find("one more in every cycle, going on from where it stood; initially 0\n"),
            std::string::npos) << output.out;
}

TEST(Describe, NamesTheNearestOfAnUnknownName) {
  EXPECT_EQ(describe_component("t_countr", test_place(), false).err,
            "error: no component 't_countr' is installed; did you mean 't_counter'?\n");
  EXPECT_EQ(describe_component("t_countr", test_place(), true).out,
            "{\"error\": {\"where\": \"\", \"message\": \"no component 't_countr' is installed; did you mean "
            "'t_counter'?\"}}\n");
  EXPECT_EQ(describe_component("", test_place(), false).code, kRefused);
}

TEST(Output, AnErrorNamesItsPlace) {
  const Error error{ErrorCode::kBadInput, {"wrong \"word\""}, {"arm.yaml:3:4"}};
  EXPECT_EQ(error_line(error), "arm.yaml:3:4: error: wrong \"word\"\n");
  EXPECT_EQ(file_refusal(error, true, kUsage).out,
            "{\"error\": {\"where\": \"arm.yaml:3:4\", \"message\": \"wrong \\\"word\\\"\"}}\n");
}

TEST(JsonString, EscapesCharactersThatJsonCannotHold) {
  EXPECT_EQ(json_string("a\"\\\n\x01"), "\"a\\\"\\\\\\n\\u0001\"");
  EXPECT_EQ(json_string("\xff"), "\"\xef\xbf\xbd\"");  // no UTF-8: the replacement character
}

}  // namespace
}  // namespace chimera::cli
