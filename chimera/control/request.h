// SPDX-License-Identifier: Apache-2.0
// One line of the control protocol, read as a request; and the lines that go back.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "chimera/control/rpc_response.h"

namespace chimera::control {

/// A request as read. `refusal` says why it is none; then only `id` counts (null when it is not known).
struct Request {
  std::shared_ptr<const Json> id;          ///< never null
  bool wants_answer = true;                ///< false: a notification of JSON-RPC
  std::string method;
  std::shared_ptr<const Json> parameters;  ///< an object
  RpcResponse refusal;
  bool must_close = false;                 ///< the line breaks a limit: the connection ends
};

/// Reads a line; never throws, whatever the bytes. Context: setup.
Request read_request(std::string_view line);
/// The lines to send, each with its line end. Text that is no UTF-8 is sent with replacements.
std::string answer_line(const Json& id, const RpcResponse& answer);
/// Text before a result in its line, and text behind it.
std::string result_begin(const Json& id);
inline constexpr const char* kResultEnd = "}\n";
std::string note_line(std::string_view method, std::uint64_t subscription, const Json& parameters);
/// Text before the parameters of a notification in its line, and text behind them.
std::string note_begin(std::string_view method);
inline constexpr const char* kNoteEnd = "}\n";
std::string request_line(std::uint64_t id, std::string_view method, const Json& parameters);

/// Cost of parsing a text, estimated from brackets and commas outside of strings.
struct TextCost {
  std::size_t depth = 0;   ///< how deep arrays and objects are nested
  std::size_t commas = 0;  ///< one less than the values of a list
};
TextCost text_cost(std::string_view text) noexcept;

}  // namespace chimera::control
