// SPDX-License-Identifier: Apache-2.0
// Parses one line of JSON as a request, and writes answers and notifications as lines.
#include "chimera/control/request.h"

#include <algorithm>
#include <optional>

#include "chimera/control/limits.h"
#include "chimera/text/json.h"

namespace chimera::control {
namespace {

std::string line_of(const Json& message) { return message.dump() + "\n"; }

Request refused(const Json& id, int code, std::string message, bool must_close = false) {
  Request request;
  request.id = std::make_shared<const Json>(id);
  request.refusal = RpcResponse::error(code, std::move(message));
  request.must_close = must_close;
  return request;
}

bool is_id(const Json& id) { return id.is_string() || id.is_whole() || id.is_null(); }

}  // namespace

TextCost text_cost(std::string_view text) noexcept {
  TextCost cost;
  std::size_t depth = 0;
  bool in_text = false, escaped = false;
  for (const char c : text) {
    if (in_text) {
      if (!escaped && c == '"') in_text = false;
      escaped = !escaped && c == '\\';
    } else if (c == '"') {
      in_text = true;
    } else if (c == '[' || c == '{') {
      cost.depth = std::max(cost.depth, ++depth);
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    } else if (c == ',') {
      ++cost.commas;
    }
  }
  return cost;
}

Request read_request(std::string_view line) {
  if (line.size() > kMaxLine) return refused(nullptr, kTooLarge, "the line is longer than 1 MiB", true);
  const TextCost cost = text_cost(line);
  if (cost.depth > kMaxDepth) return refused(nullptr, kTooLarge, "nested deeper than 32 levels", true);
  if (cost.commas >= kMaxValues) return refused(nullptr, kTooLarge, "the line has more than 10,000 values", true);
  std::optional<std::string> twice;
  const std::optional<Json> parsed = Json::parse_or_none(line, &twice);
  if (!parsed) return refused(nullptr, kParseError, "this is no JSON");
  const Json& message = *parsed;
  if (twice) return refused(nullptr, kNoRequest, "the key '" + twice->substr(0, 40) + "' stands twice");
  if (message.is_array()) return refused(nullptr, kNoRequest, "batches are not supported: send one message a line");
  if (!message.is_object()) return refused(nullptr, kNoRequest, "a request is an object");
  const Json &id = message["id"], &method = message["method"];
  if (!is_id(id)) return refused(nullptr, kNoRequest, "'id' must be a text or a whole number");
  if (message["jsonrpc"] != "2.0") return refused(id, kNoRequest, "'jsonrpc' must be \"2.0\"");
  if (!method.is_string()) return refused(id, kNoRequest, "'method' must be a text");
  for (const auto& [key, value] : message.items())
    if (key != "jsonrpc" && key != "id" && key != "method" && key != "params")
      return refused(id, kNoRequest, "a request has 'jsonrpc', 'id', 'method' and 'params' only");
  Request request;
  request.id = std::make_shared<const Json>(id);
  request.wants_answer = message.contains("id");
  request.method = method.as_string();
  const Json* parameters = message.find("params");
  request.parameters = std::make_shared<const Json>(parameters == nullptr ? Json::object() : *parameters);
  return request;
}

std::string result_begin(const Json& id) { return R"({"id":)" + id.dump() + R"(,"jsonrpc":"2.0","result":)"; }

std::string answer_line(const Json& id, const RpcResponse& answer) {
  if (answer.is_good() && answer.text != nullptr) {
    std::string line = result_begin(id);
    line.reserve(line.size() + answer.text->size() + 2);
    return line.append(*answer.text).append(kResultEnd);
  }
  Json message{{"jsonrpc", "2.0"}, {"id", id}};
  if (answer.is_good()) {
    message["result"] = answer.result == nullptr ? Json::object() : *answer.result;
  } else {
    message["error"] = {{"code", answer.code}, {"message", answer.message}};
    if (answer.data != nullptr) message["error"]["data"] = *answer.data;
  }
  return line_of(message);
}

std::string note_begin(std::string_view method) {
  return R"({"jsonrpc":"2.0","method":")" + std::string(method) + R"(","params":)";
}

std::string note_line(std::string_view method, std::uint64_t subscription, const Json& parameters) {
  Json message{{"jsonrpc", "2.0"}, {"method", method}, {"params", parameters}};
  message["params"]["subscription"] = subscription;
  return line_of(message);
}

std::string request_line(std::uint64_t id, std::string_view method, const Json& parameters) {
  return line_of({{"jsonrpc", "2.0"}, {"id", id}, {"method", method}, {"params", parameters}});
}

}  // namespace chimera::control
