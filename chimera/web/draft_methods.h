// SPDX-License-Identifier: Apache-2.0
// The methods `draft`, `edit`, `replace`, `remedies`, `transitions`, `differences`, `write` and `keep` of
// docs/formats/web.md.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "chimera/control/control_backend.h"
#include "chimera/platform/clock.h"
#include "chimera/web/analyses.h"
#include "chimera/web/draft_file.h"
#include "chimera/web/page_draft.h"

namespace chimera::web {

/// The whole text of an answer that is JSON already. Context: setup.
std::shared_ptr<const std::string> text_of(const control::RpcResponse& answer);

/// An edit changes the draft only after the analyst has read the new text, and only if the version is still the same.
/// Context: setup; may block on the disk.
class DraftMethods {
 public:
  using Tell = std::function<void(const std::string&)>;
  static constexpr Nanoseconds kKeepAfter = milliseconds(200), kKeepAgain = seconds(2);
  static constexpr std::size_t kMaxWaiters = 64;

  /// `file`: from the root. `folder`: of kept drafts, or "". `analyst` and `clock` outlive it.
  DraftMethods(const std::string& file, const std::string& folder, Analyst& analyst, Clock& clock, Tell tell);

  /// `method` is one of those above.
  void call(control::MethodId method, const Json& parameters, const control::Caller& caller,
            const control::Reply& reply);
  /// The connection is over. Its edits are still carried out.
  void forget(std::uint64_t connection);
  /// The notification of the draft as it is now.
  Json note();
  /// Why `start` is refused; good: FILE is there and is the draft.
  control::RpcResponse may_start();

  Nanoseconds next_due() const noexcept { return keep_due_; }
  /// Keeps the draft in the state folder if that is due.
  void serve();
  /// Keeps the draft at once.
  void keep();

 private:
  struct Waiter {
    std::uint64_t connection = 0;
    control::Reply reply;
  };
  struct Analysis {
    std::uint64_t version = 0, library = 0;
    std::shared_ptr<const std::string> text;  // null: it is under way
    bool operator==(const Analysis&) const = default;
  };

  void look();
  void see(FileNow file);
  void changed();
  Json facts(const std::string& problem) const;
  std::string problem() const;
  control::RpcResponse stale() const;
  control::RpcResponse file_refusal(const std::string& what) const;
  control::RpcResponse answer(const std::shared_ptr<const std::string>& analysis, const std::string& problem) const;
  void give(std::uint64_t connection, const control::Reply& reply);
  void analyse();
  void take_analysis(const Analysis& asked, const control::RpcResponse& given);
  void answer_all(const control::RpcResponse& given);
  void change_to(const std::string& text, const std::string& acts, std::uint64_t connection,
                 const control::Reply& reply);
  void take_change(std::uint64_t version, std::uint64_t library, const control::RpcResponse& given,
                   std::string_view edited, const control::Reply& reply);
  void differences(const Json& parameters, std::uint64_t connection, const control::Reply& reply);
  control::RpcResponse write();
  control::RpcResponse settle(const std::string& what);

  Analyst& analyst_;
  Clock& clock_;
  DraftFile disk_;
  KeptDraft kept_;
  PageDraft draft_;
  Analysis analysis_;  // the last one
  std::vector<Waiter> waiters_;
  std::optional<KeptText> on_disk_;  // in the state folder
  std::string keep_problem_;
  Nanoseconds keep_due_ = kNever;
};

}  // namespace chimera::web
