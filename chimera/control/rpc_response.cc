// SPDX-License-Identifier: Apache-2.0
// Makers of answers: one for each form that the data of an error have.
#include "chimera/control/rpc_response.h"

#include "chimera/text/json.h"
#include "chimera/text/nearest.h"

namespace chimera::control {

RpcResponse RpcResponse::good(const Json& result) { return {0, {}, std::make_shared<const Json>(result), nullptr}; }

RpcResponse RpcResponse::ready(std::shared_ptr<const std::string> text) {
  return {0, {}, nullptr, nullptr, std::move(text)};
}

RpcResponse RpcResponse::in_pieces(std::shared_ptr<Pieces> pieces) {
  return {0, {}, nullptr, nullptr, nullptr, std::move(pieces)};
}

RpcResponse RpcResponse::error(int code, std::string message) { return {code, std::move(message), nullptr, nullptr}; }

RpcResponse RpcResponse::error(int code, std::string message, const Json& data) {
  return {code, std::move(message), nullptr, std::make_shared<const Json>(data)};
}

RpcResponse RpcResponse::refused(const char* kind, std::string message, const std::string& where,
                                 const std::string& remedy, const std::vector<std::string>& tasks) {
  Json data{{"kind", kind}, {"where", where}};
  if (!remedy.empty()) data["remedy"] = remedy;
  if (!tasks.empty()) data["tasks"] = tasks;
  return error(kRefused, std::move(message), data);
}

RpcResponse RpcResponse::unknown(std::string message, const std::string& where, const std::string& nearest) {
  Json data{{"where", where}};
  if (!nearest.empty()) data["nearest"] = nearest;
  return error(kUnknown, std::move(message), data);
}

RpcResponse RpcResponse::no_such(const char* what, const std::string& name, std::span<const std::string> names) {
  return unknown(chimera::no_such(what, name, names), name, nearest(name, names));
}

std::string RpcResponse::detail(const char* key) const { return data == nullptr ? std::string() : text_at(*data, key); }

const char* role_name(Role role) noexcept {
  constexpr const char* kNames[] = {"nothing", "observe", "operate", "configure"};
  return kNames[static_cast<unsigned>(role)];
}

}  // namespace chimera::control
