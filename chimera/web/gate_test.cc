// SPDX-License-Identifier: Apache-2.0
#include "chimera/web/gate.h"

#include <gtest/gtest.h>

#include <map>
#include <vector>

#include "chimera/web/page_files.h"

namespace chimera::web {
namespace {

using Kind = GateVerdict::Kind;
using Fields = std::map<std::string, std::string>;

const Fields kSocket = {{"Connection", "keep-alive, Upgrade"},
                        {"Upgrade", "websocket"},
                        {"Sec-WebSocket-Version", "13"},
                        {"Sec-WebSocket-Key", "AAAAAAAAAAAAAAAAAAAAAA=="}};

std::string head(const std::string& target, Fields fields = {}, const std::string& method = "GET") {
  fields.insert({"Host", "127.0.0.1:7440"});
  std::string text = method + " " + target + " HTTP/1.1\r\n";
  for (const auto& [name, value] : fields) text += name + ": " + value + "\r\n";
  return text + "\r\n";
}

Fields with(Fields fields, const Fields& more) {
  for (const auto& [name, value] : more) fields[name] = value;
  return fields;
}

/// 0: it is let in, -1: it has no end yet.
int status(const std::string& bytes) {
  const GateVerdict verdict = judge(bytes);
  if (verdict.kind == Kind::kMore) return -1;
  EXPECT_EQ(verdict.kind == Kind::kRefused, !verdict.sentence.empty());
  return verdict.status;
}

TEST(Gate, ServesTheFilesOfThePage) {
  for (std::size_t i = 0; i < std::size(kPageFiles); ++i) {
    const GateVerdict verdict = judge(head(kPageFiles[i].target));
    EXPECT_EQ(verdict.kind, Kind::kFile);
    EXPECT_EQ(verdict.file, i);
  }
}

TEST(Gate, OpensWebSocketsToTheBenchAndToAMachine) {
  EXPECT_EQ(judge(head("/bench", kSocket)).kind, Kind::kBench);
  const GateVerdict machine = judge(head("/machine/puma_pid", kSocket));
  EXPECT_EQ(machine.kind, Kind::kMachine);
  EXPECT_EQ(machine.machine, "puma_pid");
  EXPECT_EQ(machine.socket_key, kSocket.at("Sec-WebSocket-Key"));
  const std::string bytes = head("/bench", kSocket);
  EXPECT_EQ(judge(bytes + "more").size, bytes.size());
}

TEST(Gate, RefusesAWebSocketThatIsNone) {
  EXPECT_EQ(status(head("/bench")), 426);
  for (const auto& [name, value] : kSocket) {
    Fields less = kSocket;
    less.erase(name);
    EXPECT_EQ(status(head("/bench", less)), 426) << name;
  }
  EXPECT_EQ(status(head("/bench", with(kSocket, {{"Upgrade", "h2c"}}))), 426);
  EXPECT_EQ(status(head("/bench", with(kSocket, {{"Sec-WebSocket-Key", std::string(25, 'A')}}))), 426);
  EXPECT_EQ(status(head("/machine/a", with(kSocket, {{"Sec-WebSocket-Version", "8"}}))), 426);
  EXPECT_EQ(status(head("/", kSocket)), 0);  // a file is sent as one
}

TEST(Gate, AllowsTheHostsOfThisMachineOnly) {
  for (const char* host : {"127.0.0.1", "127.0.0.1:1", "[::1]:7440", "localhost", "localhost:65535"})
    EXPECT_EQ(status(head("/", {{"Host", host}})), 0) << host;
  for (const char* host : {"",
                           "evil.org",
                           "evil.org:7440",
                           "127.0.0.1.evil.org",
                           "127.0.0.1:7440.evil.org",
                           "localhost.evil.org",
                           "localhost:7440@evil.org",
                           "user@localhost",
                           "127.0.0.1:",
                           "127.0.0.1:123456",
                           "127.0.0.1:7440:1",
                           "127.0.0.2",
                           "127.1",
                           "0x7f000001",
                           "0.0.0.0",
                           "::1",
                           "[::1",
                           "[::2]",
                           "[::ffff:127.0.0.1]",
                           "localhost,evil.org",
                           "LOCALHOST.",
                           "a.localhost",
                           "127.0.0.1:-1",
                           "127.0.0.1 evil.org"})
    EXPECT_EQ(status(head("/", {{"Host", host}})), 421) << host;
}

TEST(Gate, WantsOneHost) {
  EXPECT_EQ(status("GET / HTTP/1.1\r\n\r\n"), 421);
  EXPECT_EQ(status("GET / HTTP/1.1\r\nHost: localhost\r\nHost: localhost\r\n\r\n"), 421);
  EXPECT_EQ(status("GET / HTTP/1.1\r\nHost: localhost\r\nhOsT: evil.org\r\n\r\n"), 421);
  EXPECT_EQ(status("GET / HTTP/1.1\r\nhost:\t localhost \t\r\n\r\n"), 0);
}

TEST(Gate, AllowsTheOriginOfItsOwnPageOnly) {
  EXPECT_EQ(status(head("/bench", with(kSocket, {{"Origin", "http://127.0.0.1:7440"}}))), 0);
  for (const char* origin : {"null", "", "http://127.0.0.1", "http://127.0.0.1:7441", "http://127.0.0.1:74400",
                             "https://127.0.0.1:7440", "http://localhost:7440", "http://evil.org", "file://",
                             "HTTP://127.0.0.1:7440", "http://127.0.0.1:7440/", "http://127.0.0.1:7440.evil.org"})
    EXPECT_EQ(status(head("/bench", with(kSocket, {{"Origin", origin}}))), 403) << origin;
  const std::string own = "Origin: http://127.0.0.1:7440\r\n";
  EXPECT_EQ(status("GET / HTTP/1.1\r\nHost: 127.0.0.1:7440\r\n" + own + own + "\r\n"), 403);
}

TEST(Gate, AllowsRequestsOfItsOwnPageAndOfTheUser) {
  for (const char* site : {"same-origin", "none"}) EXPECT_EQ(status(head("/", {{"Sec-Fetch-Site", site}})), 0) << site;
  for (const char* site : {"cross-site", "same-site", "", "None", "none, none"})
    EXPECT_EQ(status(head("/", {{"Sec-Fetch-Site", site}})), 403) << site;
}

TEST(Gate, AnswersGetWithoutABody) {
  for (const char* method : {"POST", "HEAD", "PUT", "DELETE", "OPTIONS", "CONNECT", "TRACE", "GETS"})
    EXPECT_EQ(status(head("/", {}, method)), 405) << method;
  EXPECT_EQ(status(head("/", {{"Content-Length", "0"}})), 0);
  for (const char* length : {"1", "-1", "", "00x", "0, 0"})
    EXPECT_EQ(status(head("/", {{"Content-Length", length}})), 413) << length;
  EXPECT_EQ(status(head("/", {{"Transfer-Encoding", "chunked"}})), 413);
}

TEST(Gate, KnowsTheNamesOfItsTableOnly) {
  const std::string kLong(65, 'a');
  for (const std::string target : {"/index.html",
                                   "//",
                                   "//bench",
                                   "/bench/",
                                   "/Bench",
                                   "/bench?x",
                                   "/?",
                                   "/#",
                                   "/page.js?v=1",
                                   "/%2e",
                                   "/./",
                                   "/../etc/passwd",
                                   "/machine",
                                   "/machine/",
                                   "/machine/..",
                                   "/machine/a/b",
                                   "/machine/%61",
                                   "/machine/a%00",
                                   "/machine/a.sock",
                                   "/machine/-a",
                                   "/machine/1a",
                                   "*",
                                   "http://127.0.0.1:7440/",
                                   "127.0.0.1:7440",
                                   "\\bench"})
    EXPECT_EQ(status(head(target, kSocket)), 404) << target;
  EXPECT_EQ(status(head("/machine/" + kLong, kSocket)), 404);
  EXPECT_EQ(status(head("/machine/" + kLong.substr(1), kSocket)), 0);
}

TEST(Gate, RefusesOtherVersions) {
  const std::string rest = "\r\nHost: localhost\r\n\r\n";
  for (const char* version : {"HTTP/1.0", "HTTP/2", "HTTP/1.10", "HTTP/0.9"})
    EXPECT_EQ(status(std::string("GET / ") + version + rest), 505) << version;
  EXPECT_EQ(status("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"), 505);
  for (const char* version : {"http/1.1", "HTTPS/1.1", "1.1", "HTTP /1.1"})
    EXPECT_EQ(status(std::string("GET / ") + version + rest), 400) << version;
}

TEST(Gate, RefusesBytesThatNoHeadHas) {
  const std::string first = "GET / HTTP/1.1\r\n", host = "Host: localhost\r\n";
  for (const std::string& bytes : std::vector<std::string>{std::string("\x16\x03\x01\x02\x00\x01", 6),
                                                           "\r\nGET / HTTP/1.1\r\n",
                                                           "get / HTTP/1.1\r\n" + host + "\r\n",
                                                           "GET / HTTP/1.1\n",
                                                           "GET / HTTP/1.1\rHost",
                                                           first + host + "A: b\n\n",
                                                           first + std::string("Host: local\0host", 16),
                                                           first + host + "A: \x01\r\n\r\n",
                                                           first + host + "A: \x7f\r\n\r\n",
                                                           first + host + " A: folded\r\n\r\n",
                                                           first + host + "\tA: folded\r\n\r\n",
                                                           first + host + "A : b\r\n\r\n",
                                                           first + host + "A\r\n\r\n",
                                                           first + host + ": b\r\n\r\n",
                                                           first + host + "\xc3\xa4: b\r\n\r\n",
                                                           "GET  / HTTP/1.1\r\n" + host + "\r\n",
                                                           "GET /\tHTTP/1.1\r\n" + host + "\r\n",
                                                           "GET / a HTTP/1.1\r\n" + host + "\r\n",
                                                           "GET /\r\n" + host + "\r\n",
                                                           "GET\r\n\r\n",
                                                           "G<T / HTTP/1.1\r\n" + host + "\r\n"})
    EXPECT_EQ(status(bytes), 400) << bytes;
  EXPECT_EQ(status(first + host + "A: \xc3\xa4\tb\r\n\r\n"), 0);
}

TEST(Gate, WaitsForTheEndOfAHeadWithinItsLimit) {
  const std::string whole = head("/", {{"Cookie", "a=b"}});
  for (std::size_t n = 0; n < whole.size(); ++n) EXPECT_EQ(status(whole.substr(0, n)), -1) << n;
  EXPECT_EQ(status(whole + std::string(100'000, '\0')), 0);
  const std::string before = head("/", {{"A", ""}}), room(kMaxHead - before.size(), 'x');
  EXPECT_EQ(status(head("/", {{"A", room}})), 0);
  EXPECT_EQ(status(head("/", {{"A", room + "x"}})), 431);
  EXPECT_EQ(status(std::string(kMaxHead - 1, 'A')), -1);
  EXPECT_EQ(status(std::string(kMaxHead, 'A')), 431);
}

TEST(Gate, JudgesTheSenderFirst) {
  EXPECT_EQ(status(head("/nothing", {{"Host", "evil.org"}}, "POST")), 421);
  EXPECT_EQ(status(head("/nothing", {{"Origin", "null"}}, "POST")), 403);
  EXPECT_EQ(status(head("/nothing", {}, "POST")), 405);
}

TEST(Answer, HasTheFieldsOfSafety) {
  const std::string text = answer(403, "text/plain", "no\n");
  EXPECT_TRUE(text.starts_with("HTTP/1.1 403 Forbidden\r\n")) << text;
  EXPECT_TRUE(text.ends_with("\r\nConnection: close\r\n\r\nno\n")) << text;
  EXPECT_NE(text.find("\r\nContent-Length: 3\r\n"), std::string::npos);
  for (const auto& [name, value] : kSafetyFields)
    EXPECT_NE(text.find(std::string("\r\n") + name + ": " + value + "\r\n"), std::string::npos) << name;
  for (const char* never : {"Access-Control", "Set-Cookie"}) EXPECT_EQ(text.find(never), std::string::npos);
}

}  // namespace
}  // namespace chimera::web
