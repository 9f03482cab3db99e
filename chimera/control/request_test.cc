// SPDX-License-Identifier: Apache-2.0
#include "chimera/control/request.h"

#include <gtest/gtest.h>

#include "chimera/control/limits.h"
#include "chimera/text/json.h"

namespace chimera::control {
namespace {

std::string read(const std::string& line) {
  const Request request = read_request(line);
  if (request.refusal.is_good()) return request.method + " " + request.parameters->dump() + " " + request.id->dump();
  return std::to_string(request.refusal.code) + " " + request.refusal.message + " " + request.id->dump();
}

TEST(Request, IsReadWithItsParameters) {
  EXPECT_EQ(read(R"({"jsonrpc":"2.0","id":1,"method":"hello"})"), "hello {} 1");
  EXPECT_EQ(read(R"( {"method":"get","params":{"variables":["q"]},"id":"x","jsonrpc":"2.0"} )"),
            R"(get {"variables":["q"]} "x")");
  EXPECT_TRUE(read_request(R"({"jsonrpc":"2.0","id":null,"method":"hello"})").wants_answer);
  EXPECT_FALSE(read_request(R"({"jsonrpc":"2.0","method":"hello"})").wants_answer);
}

TEST(Request, NamesTheErrorOfAnInvalidRequest) {
  EXPECT_EQ(read(""), "-32700 this is no JSON null");
  EXPECT_EQ(read("{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"\xff\"}"), "-32700 this is no JSON null");
  EXPECT_EQ(read("1e999"), "-32700 this is no JSON null");
  EXPECT_EQ(read("[]"), "-32600 batches are not supported: send one message a line null");
  EXPECT_EQ(read("7"), "-32600 a request is an object null");
  EXPECT_EQ(read(R"({"id":1,"method":"hello"})"), R"(-32600 'jsonrpc' must be "2.0" 1)");
  EXPECT_EQ(read(R"({"jsonrpc":"2.0","id":{},"method":"hello"})"), "-32600 'id' must be a text or a whole number null");
  EXPECT_EQ(read(R"({"jsonrpc":"2.0","id":1.5,"method":"hello"})"),
            "-32600 'id' must be a text or a whole number null");
  EXPECT_EQ(read(R"({"jsonrpc":"2.0","id":1,"method":2})"), "-32600 'method' must be a text 1");
  EXPECT_EQ(read(R"({"jsonrpc":"2.0","id":1,"method":"hello","parms":{}})"),
            "-32600 a request has 'jsonrpc', 'id', 'method' and 'params' only 1");
  EXPECT_EQ(read(R"({"jsonrpc":"2.0","id":1,"method":"signal","params":{"tasks":["a"],"tasks":["b"]}})"),
            "-32600 the key 'tasks' stands twice null");
}

TEST(Request, BeyondALimitItEndsTheConnection) {
  const std::string deep = std::string(33, '[') + std::string(33, ']');
  EXPECT_EQ(read(deep), "-32001 nested deeper than 32 levels null");
  EXPECT_TRUE(read_request(deep).must_close);
  EXPECT_EQ(read(std::string(kMaxLine + 1, ' ')), "-32001 the line is longer than 1 MiB null");
  EXPECT_TRUE(read_request(std::string(kMaxLine + 1, ' ')).must_close);
  EXPECT_FALSE(read_request("7").must_close);
  EXPECT_EQ(read(std::string(kMaxLine - 1, ' ') + "7"), "-32600 a request is an object null");
}

TEST(Request, DepthCountsBracketsOutsideOfTexts) {
  EXPECT_EQ(text_cost("").depth, 0u);
  EXPECT_EQ(text_cost("[[]]{}").depth, 2u);
  EXPECT_EQ(text_cost(R"(["[[[[\"[[["])").depth, 1u);
  EXPECT_EQ(text_cost(R"(["\\",[]])").depth, 2u);
  EXPECT_EQ(text_cost("]]][").depth, 1u);
}

TEST(Request, ALineOfTooManyValuesIsNotRead) {
  const auto line = [](std::size_t n) {
    std::string ones = "1";
    for (std::size_t i = 1; i < n; ++i) ones += ",1";
    return R"({"jsonrpc":"2.0","method":"set","params":{"values":{"a":[)" + ones + "]}}}";
  };
  EXPECT_TRUE(read_request(line(9990)).refusal.is_good());
  const Request refused = read_request(line(10'001));
  EXPECT_EQ(refused.refusal.code, kTooLarge);
  EXPECT_EQ(refused.refusal.message, "the line has more than 10,000 values");
  EXPECT_TRUE(refused.must_close);
  EXPECT_EQ(text_cost(R"({"a,b": "c,d", "e": [1, 2]})").commas, 2u) << "commas in texts do not count";
}

TEST(Request, LinesThatGoBackAreOneLineOfUtf8) {
  EXPECT_EQ(answer_line(1, RpcResponse::error(kRefused, "a\nb\xff")),
            "{\"error\":{\"code\":-32000,\"message\":\"a\\nb\xef\xbf\xbd\"},\"id\":1,\"jsonrpc\":\"2.0\"}\n");
  EXPECT_EQ(answer_line("x", RpcResponse{}), "{\"id\":\"x\",\"jsonrpc\":\"2.0\",\"result\":{}}\n");
  EXPECT_EQ(answer_line("x", RpcResponse::ready(std::make_shared<const std::string>("[1]"))),
            "{\"id\":\"x\",\"jsonrpc\":\"2.0\",\"result\":[1]}\n");
  EXPECT_EQ(note_line("tap", 3, {{"lost", 0}}),
            "{\"jsonrpc\":\"2.0\",\"method\":\"tap\",\"params\":{\"lost\":0,\"subscription\":3}}\n");
}

}  // namespace
}  // namespace chimera::control
