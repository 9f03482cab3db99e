// SPDX-License-Identifier: Apache-2.0
// Answers the questions of pages about this machine, and notices subsystems that begin or end.
#include "chimera/web/bench.h"

#include <algorithm>
#include <cerrno>

#include "chimera/control/running.h"
#include "chimera/platform/file.h"
#include "chimera/platform/local_socket.h"
#include "chimera/platform/process_state.h"
#include "chimera/platform/socket_place.h"
#include "chimera/text/json.h"

namespace chimera::web {

using control::MethodId;
using control::RpcResponse;

namespace {

constexpr Nanoseconds kListingPeriod = seconds(1);
constexpr Nanoseconds kStartTime = seconds(2);      // a new socket file may not listen yet
constexpr Nanoseconds kAskingPeriod = seconds(10);  // the file of a killed keeper stays

RpcResponse no_draft() {
  return RpcResponse::refused("draft", "this page has no draft: no FILE was named", "", "type `chimera web FILE`");
}

std::string beside(const std::string& folder, const char* name) {
  return folder.empty() ? "" : (std::filesystem::path(folder).parent_path() / name).string();
}

}  // namespace

Bench::Bench(BenchFacts facts, Clock& clock, std::function<void(const std::string&)> tell)
    : facts_(std::move(facts)),
      clock_(clock),
      library_(facts_.workplace, facts_.file, facts_.program, clock),
      analyses_(facts_.programs + "/chimera-manager", library_, clock, tell),
      run_(facts_.programs + "/chimera", facts_.drafts),
      trials_(facts_.programs + "/chimera", beside(facts_.drafts, "trials"), facts_.file, clock) {
  if (!facts_.file.empty()) draft_.emplace(facts_.file, facts_.drafts, analyses_, clock, std::move(tell));
}

void Bench::call(const control::MethodRule& method, const Json& parameters, const control::Caller& caller,
                 control::Reply reply) {
  switch (method.id) {
    case MethodId::kHello: return reply(RpcResponse::good(hello(caller.role)));
    case MethodId::kMachines: return reply(RpcResponse::good(*machines()));
    case MethodId::kLibrary:
    case MethodId::kSheet:
    case MethodId::kDocument:
    case MethodId::kValues: return (void)library_.version(), reply(library_.answer(method.id, parameters));
    case MethodId::kOutput: return run_.serve(clock_.now()), reply(run_.output());
    case MethodId::kStart: return reply(start());
    default: break;
  }
  if (Trials::carries_out(method.id))
    return trials_.call(method.id, parameters, caller, reply, draft_ ? &*draft_ : nullptr);
  if (control::is_of_bench(method.id)) return call_draft(method.id, parameters, caller, reply);
  reply(RpcResponse::error(control::kNoMethod,
                           "'" + std::string(method.name) + "' is a method of a subsystem: connect to /machine/NAME",
                           {{"where", "method"}}));
}

void Bench::call_draft(MethodId method, const Json& parameters, const control::Caller& caller,
                       const control::Reply& reply) {
  if (draft_) return draft_->call(method, parameters, caller, reply);
  reply(no_draft());
}

RpcResponse Bench::start() {
  if (!draft_) return no_draft();
  run_.serve(clock_.now());
  if (RpcResponse refused = draft_->may_start(); !refused.is_good()) return refused;
  return run_.start(facts_.file);
}

void Bench::forget(std::uint64_t connection) {
  analyses_.forget(connection);
  if (draft_) draft_->forget(connection);
  trials_.forget(connection);
}

RpcResponse Bench::open(std::uint64_t subscription, const Json& parameters) {
  const std::string to = parameters.at("to").as_string();
  if (to == "draft" && !draft_) return no_draft();
  if (to != "machines" && to != "draft")
    return RpcResponse::error(control::kBadParameters, "'to' must be machines or draft; a subsystem has the others",
                              {{"where", "to"}, {"nearest", "machines"}});
  sent_[subscription] = {to == "draft", nullptr};
  return {};
}

std::shared_ptr<const Json> Bench::pull(std::uint64_t subscription) {
  Sent& sent = sent_.at(subscription);
  const auto present = sent.is_of_draft ? std::make_shared<const Json>(draft_->note()) : machines();
  if (sent.last != nullptr && *sent.last == *present) return nullptr;
  return sent.last = present;
}

std::vector<int> Bench::descriptors() const {
  std::vector<int> all = analyses_.descriptors();
  all.push_back(run_.descriptor());
  trials_.append_descriptors(all);
  return all;
}

Nanoseconds Bench::next_due() const noexcept {
  return std::min({analyses_.next_due(), draft_ ? draft_->next_due() : kNever, trials_.next_due()});
}

void Bench::serve() {
  analyses_.serve();
  if (draft_) draft_->serve();
  run_.serve(clock_.now());
  trials_.serve();
}

void Bench::finish() {
  if (draft_) draft_->keep();
  trials_.finish();
}

OwnedDescriptor Bench::connect(const std::string& machine) {
  OwnedDescriptor door;
  for (const std::string& folder : folders()) {
    door = connect_to_path(control::socket_path(folder, machine), {});
    if (door.fd >= 0 || (errno != ENOENT && errno != ECONNREFUSED)) return door;
  }
  const int why = errno;
  look_again();
  errno = why;
  return door;
}

Json Bench::hello(control::Role role) const {
  std::error_code error;
  const FileStart host("/proc/sys/kernel/hostname");
  return {{"protocol", 1},
          {"program", facts_.program},
          {"role", control::role_name(role)},
          {"user", user_name(own_user())},
          {"host", host.view().substr(0, host.view().find('\n'))},
          {"file", facts_.file.empty() ? Json() : Json(facts_.file)},
          {"folder", std::filesystem::current_path(error).string()},
          {"pid", own_process_id()}};
}

/// Without the folder of the user if others may write to it.
std::vector<std::string> Bench::folders() const {
  if (is_safe_folder(facts_.own_folder.c_str())) return {facts_.own_folder, facts_.service_folder};
  return {facts_.service_folder};
}

std::vector<std::pair<std::string, Bench::Time>> Bench::sockets() const {
  std::vector<std::pair<std::string, Time>> found;
  for (const std::string& folder : folders()) {
    std::error_code error;
    std::filesystem::directory_iterator entries(folder, error);
    for (; !error && entries != std::filesystem::directory_iterator(); entries.increment(error)) {
      std::error_code gone;
      if (entries->path().extension() == ".sock")
        found.emplace_back(entries->path().string(), entries->last_write_time(gone));
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// As it was within the last kListingPeriod.
const std::shared_ptr<const Json>& Bench::machines() {
  const Nanoseconds now = clock_.now();
  if (machines_ != nullptr && now - listed_at_ < kListingPeriod) return machines_;
  listed_at_ = now;
  auto present = sockets();
  if (present != known_) changed_at_ = now;
  const bool must_ask = machines_ == nullptr || now - changed_at_ < kStartTime || now - asked_at_ >= kAskingPeriod;
  known_ = std::move(present);
  if (!must_ask) return machines_;
  asked_at_ = now;
  std::vector<std::string> named;
  Json all = Json::array();
  for (const std::string& folder : folders()) {
    for (const std::string& name : control::running_subsystems(folder)) {
      if (std::find(named.begin(), named.end(), name) != named.end()) continue;
      named.push_back(name);
      all.push_back({{"name", name}, {"service", folder != facts_.own_folder}});
    }
  }
  Json answer = Json::object();
  answer["machines"] = std::move(all);
  machines_ = std::make_shared<const Json>(std::move(answer));
  return machines_;
}

}  // namespace chimera::web
