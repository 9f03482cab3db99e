// SPDX-License-Identifier: Apache-2.0
// The methods that chimera-web carries out itself: about this machine, the draft of FILE, and what it starts.
// docs/formats/web.md, "Methods of the bench".
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "chimera/control/control_backend.h"
#include "chimera/platform/clock.h"
#include "chimera/platform/descriptor.h"
#include "chimera/web/analyses.h"
#include "chimera/web/bench_library.h"
#include "chimera/web/draft_methods.h"
#include "chimera/web/started_run.h"
#include "chimera/web/trials.h"

namespace chimera::web {

/// Plain value.
struct BenchFacts {
  std::string program;                     ///< its version
  std::string file;                        ///< absolute path of the description that was named; "": none
  std::string own_folder, service_folder;  ///< of sockets
  std::string programs;                    ///< folder of chimera and chimera-manager
  std::string drafts;                      ///< folder of kept drafts; "": there is no place for them
  Workplace workplace;                     ///< where the components are
};

/// Lists the folders of sockets at most once a second, and only on request. Context: setup; may block on the disk.
class Bench final : public control::ControlBackend {
 public:
  /// `clock` outlives it. `tell` gets sentences for people.
  Bench(BenchFacts facts, Clock& clock, std::function<void(const std::string&)> tell);

  void call(const control::MethodRule& method, const Json& parameters, const control::Caller& caller,
            control::Reply reply) override;
  control::RpcResponse open(std::uint64_t subscription, const Json& parameters) override;
  void forget(std::uint64_t connection) override;
  void close(std::uint64_t subscription) override { sent_.erase(subscription); }
  std::shared_ptr<const Json> pull(std::uint64_t subscription) override;
  /// A connection to the subsystem; -1 with errno. Context: setup; may block 10 ms.
  OwnedDescriptor connect(const std::string& machine);
  /// A subsystem ended: the next listing connects to the sockets again.
  void look_again() noexcept { asked_at_ = Nanoseconds{INT64_MIN / 2}; }

  /// Each is readable when serve() has something to do; negative numbers are none.
  std::vector<int> descriptors() const;
  /// Time when serve() is due even if nothing is readable.
  Nanoseconds next_due() const noexcept;
  /// Takes answers of the analyst, keeps the draft, collects what has ended.
  void serve();
  /// Keeps the draft at once: this process ends.
  void finish();

 private:
  using Time = std::filesystem::file_time_type;
  struct Sent {
    bool is_of_draft = false;
    std::shared_ptr<const Json> last;  // null: nothing yet
  };

  void call_draft(control::MethodId method, const Json& parameters, const control::Caller& caller,
                  const control::Reply& reply);
  control::RpcResponse start();
  Json hello(control::Role role) const;
  std::vector<std::string> folders() const;
  const std::shared_ptr<const Json>& machines();
  std::vector<std::pair<std::string, Time>> sockets() const;

  BenchFacts facts_;
  Clock& clock_;
  std::vector<std::pair<std::string, Time>> known_;
  std::shared_ptr<const Json> machines_;  // the last answer
  std::map<std::uint64_t, Sent> sent_;    // by subscription: the last notification
  BenchLibrary library_;
  Analyses analyses_;
  std::optional<DraftMethods> draft_;  // none without FILE
  StartedRun run_;
  Trials trials_;
  Nanoseconds listed_at_{INT64_MIN / 2}, changed_at_{INT64_MIN / 2}, asked_at_{INT64_MIN / 2};
};

}  // namespace chimera::web
