// SPDX-License-Identifier: Apache-2.0
// The methods that chimera-web carries out itself: `hello`, and `machines`, the list of subsystems that run.
// docs/formats/web.md, "Methods of the bench".
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "chimera/control/control_backend.h"
#include "chimera/platform/clock.h"
#include "chimera/platform/descriptor.h"

namespace chimera::web {

/// Plain value.
struct BenchFacts {
  std::string program;                     ///< its version
  std::string file;                        ///< absolute path of the description that was named; "": none
  std::string own_folder, service_folder;  ///< of sockets
};

/// Lists the folders of sockets at most once a second, and only on request. Context: setup.
class Bench final : public control::ControlBackend {
 public:
  /// `clock` outlives it.
  Bench(BenchFacts facts, Clock& clock) : facts_(std::move(facts)), clock_(clock) {}

  void call(const control::MethodRule& method, const Json& parameters, const control::Caller& caller,
            control::Reply reply) override;
  control::RpcResponse open(std::uint64_t subscription, const Json& parameters) override;
  void close(std::uint64_t subscription) override { sent_.erase(subscription); }
  std::shared_ptr<const Json> pull(std::uint64_t subscription) override;
  /// A connection to the subsystem; -1 with errno. Context: setup; may block 10 ms.
  OwnedDescriptor connect(const std::string& machine);
  /// A subsystem ended: the next listing connects to the sockets again.
  void look_again() noexcept { asked_at_ = Nanoseconds{INT64_MIN / 2}; }

 private:
  using Time = std::filesystem::file_time_type;

  Json hello(control::Role role) const;
  std::vector<std::string> folders() const;
  const std::shared_ptr<const Json>& machines();
  std::vector<std::pair<std::string, Time>> sockets() const;

  BenchFacts facts_;
  Clock& clock_;
  std::vector<std::pair<std::string, Time>> known_;
  std::shared_ptr<const Json> machines_;                       // the last answer
  std::map<std::uint64_t, std::shared_ptr<const Json>> sent_;  // by subscription: the last notification
  Nanoseconds listed_at_{INT64_MIN / 2}, changed_at_{INT64_MIN / 2}, asked_at_{INT64_MIN / 2};
};

}  // namespace chimera::web
