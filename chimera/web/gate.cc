// SPDX-License-Identifier: Apache-2.0
// Reads the head of a request strictly and compares it with the table of allowed requests.
#include "chimera/web/gate.h"

#include <algorithm>
#include <vector>

#include "chimera/description/draft_values.h"
#include "chimera/web/page_files.h"

namespace chimera::web {
namespace {

using Kind = GateVerdict::Kind;

struct Field {
  std::string_view name, value;
};

struct Head {
  std::string_view method, target, version;
  std::vector<Field> fields{};
};

GateVerdict refused(int status, std::string sentence) {
  return {.kind = Kind::kRefused, .status = status, .sentence = std::move(sentence)};
}

/// The begin of a text from outside: as much as a sentence needs.
std::string quoted(std::string_view text) {
  return "'" + std::string(text.substr(0, 60)) + (text.size() > 60 ? "..." : "") + "'";
}

bool is_token(std::string_view text) {
  const auto is_part = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
           std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
  };
  return !text.empty() && std::all_of(text.begin(), text.end(), is_part);
}

bool is_same_word(std::string_view a, std::string_view b) {
  const auto low = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) { return low(x) == low(y); });
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// The number of bytes of the head; 0: its end has not come; npos: a byte that no head has.
std::size_t size_of_head(std::string_view bytes) {
  bytes = bytes.substr(0, kMaxHead);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const auto c = static_cast<unsigned char>(bytes[i]);
    const bool is_end = i > 0 && bytes[i - 1] == '\r';
    if ((c == '\n') != is_end || (i == 0 && !(c >= 'A' && c <= 'Z'))) return std::string_view::npos;
    if ((c < 0x20 && c != '\t' && c != '\r' && c != '\n') || c == 0x7f) return std::string_view::npos;
    if (bytes.substr(0, i + 1).ends_with("\r\n\r\n")) return i + 1;
  }
  return 0;
}

/// False: a line is none of a head.
bool read_head(std::string_view bytes, Head& head) {
  const auto take_line = [&bytes] {
    const std::size_t end = bytes.find("\r\n");
    const std::string_view line = bytes.substr(0, end);
    bytes.remove_prefix(end + 2);
    return line;
  };
  const std::string_view first = take_line();
  const std::size_t a = first.find(' '), b = first.rfind(' ');
  if (a == std::string_view::npos || a == b) return false;
  head.method = first.substr(0, a);
  head.target = first.substr(a + 1, b - a - 1);
  head.version = first.substr(b + 1);
  if (!is_token(head.method) || head.target.find_first_of(" \t") != std::string_view::npos || head.target.empty())
    return false;
  for (std::string_view line = take_line(); !line.empty(); line = take_line()) {
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos || !is_token(line.substr(0, colon))) return false;
    head.fields.push_back({line.substr(0, colon), trimmed(line.substr(colon + 1))});
  }
  return true;
}

std::vector<std::string_view> values(const Head& head, std::string_view name) {
  std::vector<std::string_view> found;
  for (const Field& field : head.fields)
    if (is_same_word(field.name, name)) found.push_back(field.value);
  return found;
}

bool is_local(std::string_view host) {
  for (const std::string_view name : {"127.0.0.1", "[::1]", "localhost"}) {
    if (!host.starts_with(name)) continue;
    const std::string_view port = host.substr(name.size());
    const bool is_port = port.size() >= 2 && port.size() <= 6 && port[0] == ':' &&
                         port.find_first_not_of("0123456789", 1) == std::string_view::npos;
    if (port.empty() || is_port) return true;
  }
  return false;
}

/// True if one of the words of a list, cut at commas, is `word`.
bool lists(const std::vector<std::string_view>& found, std::string_view word) {
  for (std::string_view value : found) {
    for (bool has_more = true; has_more;) {
      const std::size_t comma = value.find(',');
      if (is_same_word(trimmed(value.substr(0, comma)), word)) return true;
      has_more = comma != std::string_view::npos;
      if (has_more) value.remove_prefix(comma + 1);
    }
  }
  return false;
}

bool is_all(const std::vector<std::string_view>& found, std::string_view word) {
  return found.size() == 1 && is_same_word(found[0], word);
}

/// A refusal of a request that another site may have made, or that has a form of its own; kMore: none.
GateVerdict judge_sender(const Head& head) {
  const auto host = values(head, "Host"), origin = values(head, "Origin"), site = values(head, "Sec-Fetch-Site");
  if (host.size() != 1 || !is_local(host[0]))
    return refused(421, "the request is for the host " + quoted(host.empty() ? "" : host[0]) +
                            "; this is 127.0.0.1, [::1] or localhost, named once");
  if (!origin.empty() && (origin.size() > 1 || origin[0] != "http://" + std::string(host[0])))
    return refused(403, "a page of " + quoted(origin[0]) + " made the request, not the page of this program");
  if (!site.empty() && (site.size() > 1 || (site[0] != "same-origin" && site[0] != "none")))
    return refused(403, "a page of another site made the request (Sec-Fetch-Site: " + quoted(site[0]) + ")");
  if (head.method != "GET") return refused(405, "the method is " + quoted(head.method) + "; only GET is answered");
  const auto length = values(head, "Content-Length");
  const bool has_length = !length.empty() && !is_all(length, "0");
  if (has_length || !values(head, "Transfer-Encoding").empty()) return refused(413, "the request has a body");
  return {};
}

/// Finds the target in the table of names.
GateVerdict judge_target(const Head& head) {
  for (std::size_t i = 0; i < std::size(kPageFiles); ++i)
    if (head.target == kPageFiles[i].target) return {.kind = Kind::kFile, .file = i};
  constexpr std::string_view kMachine = "/machine/";
  GateVerdict door;
  if (head.target == "/bench") {
    door.kind = Kind::kBench;
  } else if (head.target.starts_with(kMachine) && is_name(head.target.substr(kMachine.size()))) {
    door.kind = Kind::kMachine;
    door.machine = head.target.substr(kMachine.size());
  } else {
    return refused(404, "there is no " + quoted(head.target) + " here");
  }
  const auto keys = values(head, "Sec-WebSocket-Key");
  const bool is_upgrade =
      lists(values(head, "Connection"), "upgrade") && is_all(values(head, "Upgrade"), "websocket") &&
      is_all(values(head, "Sec-WebSocket-Version"), "13") && keys.size() == 1 && keys[0].size() == 24;
  if (is_upgrade) door.socket_key = keys[0];
  return is_upgrade ? door : refused(426, quoted(head.target) + " opens as a WebSocket, version 13");
}

}  // namespace

GateVerdict judge(std::string_view bytes) {
  const std::size_t size = size_of_head(bytes);
  if (size == 0) return bytes.size() < kMaxHead ? GateVerdict{} : refused(431, "the head has more than 8 KiB");
  Head head;
  if (size == std::string_view::npos || !read_head(bytes.substr(0, size), head))
    return refused(400, "this is no HTTP request; the link begins with http://");
  if (head.version != "HTTP/1.1")
    return head.version.starts_with("HTTP/") ? refused(505, "the version is " + quoted(head.version) + ", not HTTP/1.1")
                                             : refused(400, "this is no HTTP request; the link begins with http://");
  GateVerdict verdict = judge_sender(head);
  if (verdict.kind != Kind::kRefused) verdict = judge_target(head);
  verdict.size = size;
  return verdict;
}

std::string answer(int status, const char* type, std::string_view body) {
  constexpr std::pair<int, const char*> kWords[] = {{200, "OK"},
                                                    {400, "Bad Request"},
                                                    {403, "Forbidden"},
                                                    {404, "Not Found"},
                                                    {405, "Method Not Allowed"},
                                                    {408, "Request Timeout"},
                                                    {413, "Content Too Large"},
                                                    {421, "Misdirected Request"},
                                                    {426, "Upgrade Required"},
                                                    {431, "Request Header Fields Too Large"},
                                                    {505, "HTTP Version Not Supported"}};
  const auto word =
      std::find_if(std::begin(kWords), std::end(kWords), [&](const auto& w) { return w.first == status; });
  std::string text = "HTTP/1.1 " + std::to_string(status) + " " + (word == std::end(kWords) ? "" : word->second) +
                     "\r\nContent-Type: " + type + "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n";
  for (const auto& [name, value] : kSafetyFields) text += std::string(name) + ": " + value + "\r\n";
  if (status == 405) text += "Allow: GET\r\n";
  text += status == 426 ? "Upgrade: websocket\r\nConnection: Upgrade, close\r\n\r\n" : "Connection: close\r\n\r\n";
  return text.append(body);
}

}  // namespace chimera::web
