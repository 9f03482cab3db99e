// SPDX-License-Identifier: Apache-2.0
// Judges the head of an HTTP request, byte by byte: docs/formats/web.md, "Requests". Pure: no socket, clock or file.
// Any site can make a browser send requests to this machine; the rules on Host, Origin and Sec-Fetch-Site refuse them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

namespace chimera::web {

inline constexpr std::size_t kMaxHead = 8192;  ///< bytes

/// The judgement of a head. Plain value.
struct GateVerdict {
  enum class Kind : unsigned char {
    kMore,     ///< the head has no end yet
    kFile,     ///< send `file`
    kBench,    ///< a WebSocket to the server of this process
    kMachine,  ///< a WebSocket to the subsystem `machine`
    kRefused   ///< answer with `status` and `sentence`
  };
  Kind kind = Kind::kMore;
  std::size_t file = 0;                 ///< index in kPageFiles
  std::string machine{}, socket_key{};  ///< of a WebSocket: Sec-WebSocket-Key
  std::size_t size = 0;                 ///< bytes of the head that was let in
  int status = 0;
  std::string sentence{};
};

/// Judges the bytes that have come so far. Further bytes do not change a verdict other than kMore; kMaxHead bytes are
/// enough for a verdict. Context: setup.
GateVerdict judge(std::string_view bytes);

/// Fields of every answer, also of those that open a WebSocket.
inline constexpr std::pair<const char*, const char*> kSafetyFields[] = {
    {"Content-Security-Policy",
     "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; connect-src 'self'; "
     "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
    {"X-Content-Type-Options", "nosniff"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Cache-Control", "no-store"}};

/// A whole answer, after which the connection ends. Context: setup.
std::string answer(int status, const char* type, std::string_view body);

}  // namespace chimera::web
