// SPDX-License-Identifier: Apache-2.0
// The response to a request: a result, or an error of docs/formats/control.md.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "chimera/control/pieces.h"
#include "chimera/text/json.h"

namespace chimera::control {

/// Numbers of errors, as in the document.
enum : int {
  kParseError = -32700,
  kNoRequest = -32600,
  kNoMethod = -32601,
  kBadParameters = -32602,
  kRefused = -32000,
  kTooLarge = -32001,
  kTooMany = -32002,
  kTooFast = -32003,
  kNoRight = -32004,
  kUnknown = -32005,
  kNoAnswer = -32006,
  kEnding = -32007,
  kClosed = -32008,
  kNoConnection = -1,  ///< never sent: the client lost the other end
};

/// Cheap to copy. Context: setup.
struct RpcResponse {
  int code = 0;  ///< 0: `result` is there; else `message` is
  std::string message;
  std::shared_ptr<const Json> result;
  std::shared_ptr<const Json> data;                   ///< of an error; may be null
  std::shared_ptr<const std::string> text = nullptr;  ///< in the place of `result`: the same as one line of JSON
  std::shared_ptr<Pieces> pieces = nullptr;           ///< in the place of `result`: the same, made while it is sent

  static RpcResponse good(const Json& result);
  /// A result that is JSON already: the sender only copies it.
  static RpcResponse ready(std::shared_ptr<const std::string> text);
  /// A result that is made while it is sent.
  static RpcResponse in_pieces(std::shared_ptr<Pieces> pieces);
  static RpcResponse error(int code, std::string message);
  static RpcResponse error(int code, std::string message, const Json& data);
  /// Error kRefused. `kind` is a word for programs (docs/formats/control.md), `where` names a task, a variable or
  /// nothing, `remedy` says what to do; "": nothing is known. `tasks`: which `on` would be legal; may be empty.
  static RpcResponse refused(const char* kind, std::string message, const std::string& where,
                             const std::string& remedy = {}, const std::vector<std::string>& tasks = {});
  /// "no task 'pod'" with the nearest of `names` in the data, if one is near.
  static RpcResponse unknown(std::string message, const std::string& where, const std::string& nearest);
  /// "no task 'pod'; did you mean 'pid'?" in the words of chimera::no_such.
  static RpcResponse no_such(const char* what, const std::string& name, std::span<const std::string> names);

  bool is_good() const noexcept { return code == 0; }
  /// Text of `key` in the data, or "".
  std::string detail(const char* key) const;
};

/// Takes the one answer of a request, now or later.
using Reply = std::function<void(const RpcResponse&)>;

enum class Role : unsigned char { kNone, kObserve, kOperate, kConfigure };
/// "operate".
const char* role_name(Role role) noexcept;

}  // namespace chimera::control
