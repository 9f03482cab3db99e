// SPDX-License-Identifier: Apache-2.0
// Feeds bytes from several peers, interleaved, to the real ControlServer with a model of a subsystem. For all bytes: no
// peer gets beyond its role, every well-formed request has exactly one answer, and every answer is JSON-RPC.
//
// The input is a program: an opcode, then what it takes. Well-formed requests have ids of their own, so that their
// answers are known among those to garbage.
#include <sys/socket.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <string>

#include "chimera/control/control_server.h"
#include "chimera/task/state_machine.h"
#include "chimera/text/json.h"

namespace chimera::control {
namespace {

constexpr std::size_t kPeers = 4, kTasks = 3;
constexpr std::array<Role, kPeers> kRoles = {Role::kObserve, Role::kOperate, Role::kConfigure, Role::kConfigure};

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "violated: %s\n", what);
  std::abort();
}

/// Tasks with the real state machine; every method succeeds. Every other signal is answered later.
class Model final : public ControlBackend {
 public:
  void call(const MethodRule& method, const Json& parameters, const Caller& caller, Reply reply) override {
    require(caller.role >= method.role, "a role calls only what it opens");
    if (std::string_view(method.name) != "signal") return reply(RpcResponse::good({{"method", method.name}}));
    const RpcResponse answer = signal(parameters);
    if (++signals_ % 2 == 0)
      reply(answer);
    else
      later_.push_back({std::move(reply), answer});
  }
  RpcResponse open(std::uint64_t subscription, const Json&) override {
    require(open_.insert(subscription).second, "a subscription is opened once");
    return {};
  }
  void close(std::uint64_t subscription) override {
    require(open_.erase(subscription) == 1, "what is closed was open");
  }
  std::shared_ptr<const Json> pull(std::uint64_t subscription) override {
    require(open_.count(subscription) == 1, "only what is open is asked for news");
    return std::make_shared<const Json>(Json::object());
  }
  void answer_all() {
    auto waiting = std::move(later_);
    later_.clear();
    for (const auto& [reply, answer] : waiting) reply(answer);
  }
  std::size_t open_subscriptions() const { return open_.size(); }

 private:
  RpcResponse signal(const Json& parameters) {
    const std::string word = parameters["signal"].as_string();
    for (std::uint32_t s = 0; s < CHIMERA_SIGNAL_WAKEUP; ++s) {
      if (word != signal_name(static_cast<Signal>(s))) continue;
      for (const Json& name : parameters["tasks"]) {
        const std::string text = name.as_string();
        if (text.size() != 1 || text[0] < 'a' || text[0] >= static_cast<char>('a' + kTasks))
          return RpcResponse::unknown("no task", text, "a");
        State& state = states_[static_cast<std::size_t>(text[0] - 'a')];
        Next at = next(state, static_cast<Signal>(s), false);
        if (at.kind == Next::Kind::kImpossible) return RpcResponse::error(kRefused, "not legal");
        while (at.kind == Next::Kind::kStep) at = rule(at.step).next[static_cast<int>(chimera::Answer::kOk)];
        state = at.state;
#ifdef CHIMERA_PLANTED_DEFECT
        // A defect to prove that the fuzzer finds one: any task that comes to life.
        require(state != State::kOff, "planted");
#endif
      }
      return RpcResponse::good(Json::object());
    }
    return RpcResponse::error(kBadParameters, "no such signal");
  }

  std::array<State, kTasks> states_{};
  std::vector<std::pair<Reply, RpcResponse>> later_;
  std::set<std::uint64_t> open_;
  std::uint64_t signals_ = 0;
};

/// A peer as the test sees it.
struct Peer {
  int fd = -1;
  std::string got;
  std::map<std::uint64_t, int> answers;  // by id of well-formed requests
  bool must_answer = true;               // false once garbage of its own may have ended it
};

class ManagerState {
 public:
  ManagerState() {
    const int listening = ::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    server_ = *ControlServer::open(listening, model_, 1000, {});
    for (std::size_t p = 0; p < kPeers; ++p) open(p);
  }
  ~ManagerState() {
    for (Peer& peer : peers_) ::close(peer.fd);
  }
  void run(const std::uint8_t* bytes, std::size_t size) {
    for (std::size_t at = 0; at < size;) {
      const std::uint8_t op = bytes[at++];
      const std::size_t p = op % kPeers;
      const std::size_t argument = at < size ? bytes[at++] : 0;
      switch (op / kPeers % 6) {
        case 0: {
          const std::size_t n = std::min(argument, size - at);
          garbage(p, {reinterpret_cast<const char*>(bytes + at), n});
          at += n;
          break;
        }
        case 1:
        case 2:
          request(p, argument);
          break;
        case 3:
          serve(milliseconds(static_cast<std::int64_t>(argument)));
          break;
        case 4:
          model_.answer_all();
          break;
        default:
          reopen(p);
          break;
      }
    }
    for (int i = 0; i < 4; ++i) {
      model_.answer_all();
      serve(milliseconds(20));
    }
    for (const Peer& peer : peers_)
      for (const auto& [id, answers] : peer.answers)
        require(answers <= 1 && (answers == 1 || !peer.must_answer),
                "every well-formed request is answered exactly once");
  }

 private:
  void open(std::size_t p) {
    int pair[2];
    require(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, pair) == 0, "a pair of sockets");
    peers_[p] = Peer{};
    peers_[p].fd = pair[0];
    server_->enter(OwnedDescriptor(pair[1]), {static_cast<uid_t>(p), kRoles[p]}, now_);
  }
  void reopen(std::size_t p) {
    ::close(peers_[p].fd);
    serve(milliseconds(1));
    open(p);
  }
  void garbage(std::size_t p, std::string_view bytes) {
    peers_[p].must_answer = false;  // it may say `end`-less lines, floods, or break a limit
    (void)::send(peers_[p].fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }
  void request(std::size_t p, std::size_t argument) {
    const auto all = methods();
    const MethodRule& method = all[argument % all.size()];
    Json parameters = Json::object();
    for (const Parameter& parameter : method.parameters) {
      if (parameter.name == nullptr) break;
      if (parameter.kind == ParameterKind::kText) parameters[parameter.name] = text_for(parameter.name, argument);
      if (parameter.kind == ParameterKind::kTexts) parameters[parameter.name] = Json::array({argument % 2 ? "a" : "b"});
      if (parameter.kind == ParameterKind::kBool) parameters[parameter.name] = argument % 2 == 0;
      if (parameter.kind == ParameterKind::kCount) parameters[parameter.name] = argument + 20;
      if (parameter.kind == ParameterKind::kObject) parameters[parameter.name] = Json::object();
    }
    const std::uint64_t id = 1'000'000 + ++requests_;
    const std::string line =
        "\n" + Json{{"jsonrpc", "2.0"}, {"id", id}, {"method", method.name}, {"params", parameters}}.dump() + "\n";
    if (::send(peers_[p].fd, line.data(), line.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(line.size()))
      peers_[p].answers[id] = 0;
  }
  static std::string text_for(std::string_view name, std::size_t argument) {
    constexpr const char* kTopics[] = {"status", "events", "values", "tap"};
    if (name == "signal") return signal_name(static_cast<Signal>(argument / 16 % CHIMERA_SIGNAL_WAKEUP));
    return name == "to" ? kTopics[argument / 16 % 4] : "text";
  }
  void serve(Nanoseconds step) {
    now_ = now_ + step;
    int turns = 0;
    do {
      server_->serve(now_);
      for (Peer& peer : peers_) listen(peer);
    } while (server_->next_due() <= now_ && ++turns < 1000);
    require(turns < 1000, "the server comes to rest");
  }
  void listen(Peer& peer) {
    char bytes[4096];
    for (ssize_t n; (n = ::recv(peer.fd, bytes, sizeof bytes, 0)) > 0;)
      peer.got.append(bytes, static_cast<std::size_t>(n));
    for (std::size_t end; (end = peer.got.find('\n')) != std::string::npos; peer.got.erase(0, end + 1)) {
      const Json message = Json::parse_or_none(peer.got.substr(0, end)).value_or(nullptr);
      require(message.is_object() && message["jsonrpc"] == "2.0", "what is sent is JSON-RPC");
      if (message.contains("method")) continue;
      require(message.contains("result") != message.contains("error"), "a result or an error");
      if (!message["id"].is_whole()) continue;
      const auto found = peer.answers.find(message["id"].as_uint64());
      if (found != peer.answers.end()) require(++found->second == 1, "answered once");
    }
  }

  Model model_;
  std::unique_ptr<ControlServer> server_;
  std::array<Peer, kPeers> peers_;
  Nanoseconds now_ = seconds(1);
  std::uint64_t requests_ = 0;
};

}  // namespace
}  // namespace chimera::control

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size > 4096) return 0;
  chimera::control::ManagerState().run(bytes, size);
  return 0;
}
