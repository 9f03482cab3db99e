// SPDX-License-Identifier: Apache-2.0
// A description after reading: every key has a type, every value has its place, and no rule is checked yet.
// docs/formats/description.md lists the keys; only verify() (verify/verify.h) reads a Draft.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/base/time.h"
#include "chimera/description/condition_text.h"
#include "chimera/description/cpu_text.h"
#include "chimera/description/node.h"
#include "chimera/description/report.h"
#include "chimera/description/sequence.h"
#include "chimera/schedule/policy.h"
#include "chimera/task/server_spec.h"
#include "chimera/task/task_spec.h"
#include "chimera/units/quantity.h"

namespace chimera {

inline constexpr std::size_t kMaxTasks = 256;  ///< of a description; the reader reports more and omits them

/// A value and its place in the file.
template <class T>
struct Located {
  T value{};
  Place at;
};

/// A name and the value written for it.
struct NamedNode {
  Word name;
  Node value;
};

/// `port: variable`, or `port: [variable, ...]` for the instances of a repeated port.
struct DraftAlias {
  Word port;
  std::vector<Word> variables;
  bool is_list = false;
};

struct DraftReaction {
  OnMiss kind = OnMiss::kContinue;
  Word configuration;  ///< of {switch: NAME}
  Place at;
};

struct DraftServer {
  Place at;
  ServerKind kind = ServerKind::kDeferrable;
  Located<Nanoseconds> capacity;
  Located<Nanoseconds> period;
};

struct DraftTolerate {
  Place at;
  std::uint32_t misses = 0;
  std::uint32_t of = 0;
};

/// `{restart: N, within: T, then: ...}`
struct DraftRestart {
  std::uint32_t most = 1;
  Nanoseconds within;
  OnFault then = OnFault::kError;
};

struct DraftOnFault {
  OnFault kind = OnFault::kError;
  Word configuration;  ///< of {switch: NAME}, also behind `then`
  Place at;
  DraftRestart restart;  ///< of kRestart
};

/// `NAME` or `{task: NAME, stale_after: T, hot: BOOL}`
struct DraftStandby {
  Word task;
  std::optional<Located<Nanoseconds>> stale_after;
  std::optional<Located<bool>> hot;
  bool is_hot() const noexcept { return hot && hot->value; }
};

struct DraftTask {
  Word name;
  Word component;  ///< `at` is the place of the name if the key is missing
  std::optional<Word> rtpu;
  std::optional<Located<Rate>> rate;
  std::optional<Located<Nanoseconds>> deadline, offset, budget, min_time, stale_after;
  std::optional<Located<std::uint32_t>> criticality, user_priority, max_consecutive, safe_after;
  std::vector<DraftAlias> alias;
  std::vector<NamedNode> constants, resources, initial, max_step;
  std::optional<DraftReaction> on_miss, on_overrun;
  std::optional<DraftOnFault> on_fault;
  std::optional<DraftTolerate> tolerate;
  std::optional<DraftServer> server;
  std::optional<DraftStandby> standby_for;
  std::optional<Located<std::uint64_t>> stack_bytes;
  std::optional<Located<bool>> own_process;
  bool is_partial = false;  ///< some key could not be read: report nothing as missing in this task
};

/// `{serial: DEVICE, rate: R, stale_after: T}`, or `udp: ADDRESS`
struct DraftLink {
  Place at;
  bool is_udp = false;
  Word address;  ///< path of a device, or "HOST:PORT"
  Located<std::uint32_t> baud{115200, {}};
  Located<Rate> rate;
  Located<Nanoseconds> stale_after;
};

struct DraftRtpu {
  Word name;
  Located<std::uint32_t> cpu;
  Located<Policy> policy{Policy::kEdf, {}};
  Located<bool> preemptive{false, {}};
  std::optional<Word> target = {};  ///< of a board; there if `link` is
  std::optional<DraftLink> link = {};
  bool is_board() const noexcept { return target && link; }
};

struct DraftSet {
  Word name;
  std::vector<Word> tasks;
  std::optional<DraftCondition> safe_when;
};

struct Draft {
  std::string file;  ///< as named by the user, for messages
  Word subsystem;
  std::vector<NamedNode> constants;
  std::vector<DraftRtpu> rtpus;  ///< empty: none declared
  std::vector<DraftTask> tasks;
  std::vector<NamedNode> operators;
  std::vector<DraftSet> configurations;  ///< empty: none declared
  std::optional<Word> start;
  std::optional<DraftSequence> sequence;  ///< its task is the last one, if it has no fault
  std::shared_ptr<const KeyPaths> keys;  ///< of the text
  bool is_partial = false;  ///< some part outside the tasks could not be read
};

/// A draft, if the text can be read at all, and the faults of the text. A draft with faults holds the readable parts;
/// verify it all the same, so that one report has all faults.
struct ReadDescription {
  std::optional<Draft> draft;
  Report report;
  std::string text;  ///< the text read; empty if it could not be read
};

/// Reads `text`; messages call it `file`. Context: setup.
ReadDescription read_description(std::string_view text, std::string_view file);

/// Reads the file at `path`; refuses a file above the size limit without reading it. Context: setup; may block.
ReadDescription read_description_file(const std::string& path);

}  // namespace chimera
