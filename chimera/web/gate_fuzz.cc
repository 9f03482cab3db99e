// SPDX-License-Identifier: Apache-2.0
// Feeds bytes to the gate. For all bytes: a verdict does not change when more bytes come, and a head that is let in has
// one Host of this machine, no foreign Origin, and a target of the table.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "chimera/web/gate.h"
#include "chimera/web/page_files.h"

namespace chimera::web {
namespace {

using Kind = GateVerdict::Kind;

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "violated: %s\n", what);
  std::abort();
}

std::string lower(std::string_view text) {
  std::string low(text);
  for (char& c : low) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
  return low;
}

/// Read in another way than the gate reads: by searches in the whole head.
void check_admitted(std::string_view bytes, const GateVerdict& verdict) {
  const std::string head(bytes.substr(0, bytes.find("\r\n\r\n") + 2)), low = lower(head);
  require(verdict.size == head.size() + 2, "the head ends at the first empty line");
  require(head.starts_with("GET /") && head.size() <= kMaxHead, "GET, within the limit");
  const std::size_t end = head.find("\r\n");
  require(head.substr(0, end).ends_with(" HTTP/1.1"), "the version is 1.1");
  const std::string target = head.substr(4, end - 13);
  if (verdict.kind == Kind::kFile) require(target == kPageFiles[verdict.file].target, "a file of the page");
  if (verdict.kind == Kind::kBench) require(target == "/bench", "the bench");
  if (verdict.kind == Kind::kMachine) {
    require(target == "/machine/" + verdict.machine && !verdict.machine.empty(), "a machine");
    require(verdict.machine.find_first_of("/.%\\?# \t") == std::string::npos, "no path");
  }
  const std::size_t host = low.find("\r\nhost:");
  require(host != std::string::npos && low.find("\r\nhost:", host + 1) == std::string::npos, "one Host");
  std::string name = head.substr(host + 7, head.find("\r\n", host + 2) - host - 7);
  name.erase(0, name.find_first_not_of(" \t"));
  name.erase(name.find_last_not_of(" \t") + 1);
  require(name.find_first_not_of("0123456789.:[]localhost") == std::string::npos, "a Host of this machine");
  require(name.starts_with("127.0.0.1") || name.starts_with("[::1]") || name.starts_with("localhost"), "a local name");
  if (low.find("\r\norigin:") != std::string::npos)
    require(head.find("http://" + name + "\r\n") != std::string::npos ||
                head.find("http://" + name + " ") != std::string::npos ||
                head.find("http://" + name + "\t") != std::string::npos,
            "the Origin is the Host");
  require(
      low.find("transfer-encoding:") == std::string::npos || low.find("\r\ntransfer-encoding:") == std::string::npos,
      "no body");
  require(head.find('\0') == std::string::npos, "no NUL");
}

}  // namespace
}  // namespace chimera::web

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace chimera::web;  // NOLINT: the entry of a fuzz target
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const GateVerdict whole = judge(bytes);
#ifdef CHIMERA_PLANTED_DEFECT
  // A defect to prove that the fuzzer finds one: any WebSocket that is let in.
  require(whole.kind != GateVerdict::Kind::kMachine, "planted");
#endif
  require(whole.kind != GateVerdict::Kind::kMore || size < kMaxHead, "a verdict within the limit");
  for (const std::size_t part : {size / 2, size - size / 7, size == 0 ? 0 : size - 1}) {
    const GateVerdict early = judge(bytes.substr(0, part));
    if (early.kind == GateVerdict::Kind::kMore) continue;
    require(early.kind == whole.kind && early.status == whole.status && early.machine == whole.machine,
            "more bytes change no verdict");
  }
  if (whole.kind == GateVerdict::Kind::kRefused)
    require(whole.status >= 400 && whole.status < 600 && !whole.sentence.empty(), "a refusal says why");
  else if (whole.kind != GateVerdict::Kind::kMore)
    check_admitted(bytes, whole);
  return 0;
}
