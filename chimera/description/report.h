// SPDX-License-Identifier: Apache-2.0
// All faults of a description from one reading, each with its place and its remedy. docs/formats/description.md,
// "Faults", defines the output.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chimera/description/edit_act.h"

namespace chimera {

class KeyPaths;

/// A place in a description. Lines and columns count from 1, columns in bytes; line 0 is the file as a whole.
struct Place {
  std::uint32_t line = 0;
  std::uint32_t column = 0;
  std::uint32_t key = 0;  ///< a number of KeyPaths; no part of a comparison, because a map begins at its first key

  constexpr bool operator==(const Place& other) const noexcept { return line == other.line && column == other.column; }
  constexpr std::strong_ordering operator<=>(const Place& other) const noexcept {
    return line != other.line ? line <=> other.line : column <=> other.column;
  }
};

enum class Severity : std::uint8_t { kError, kWarning };

/// Edits that remedy a fault, by one press of a person.
struct Offer {
  std::string label;  ///< "link to 'q_ref'"
  std::vector<EditAct> acts;
};

/// A breach of a rule.
struct Fault {
  std::string_view rule;  ///< one of kRules (description/rule_ids.h); points at static text
  Place at = {};
  std::string message;        ///< what was found and what was expected, in one sentence
  std::string found = {};     ///< the offending words as written; may be empty
  std::string expected = {};  ///< the accepted values; may be empty
  std::string nearest = {};   ///< the right name nearest to `found`; may be empty
  std::string remedy = {};    ///< the action to take, in one line; empty: made from `nearest`, if there is one
  Severity severity = Severity::kError;
  std::string set = {};   ///< the configuration in which it holds; empty: all, or none
  std::string task = {};  ///< the task at which it stands; empty: none
  std::string port = {};  ///< of the task: "x", "in[2]"; a repeated port without instances as "in"; empty: none
  std::string path = {};  ///< of the key at `at`: "tasks/pid/alias/q_ref"; empty: none
  std::vector<Offer> offers = {};  ///< only offer_edits() (verify/offers.h) fills it
};

/// The message followed by the remedy, in one line. Context: setup.
std::string sentence(const Fault& fault);

/// Every fault of one description. Context: setup; may block.
class Report {
 public:
  /// `keys`: of the text, if its tree could be read.
  explicit Report(std::string file = {}, std::shared_ptr<const KeyPaths> keys = {})
      : file_(std::move(file)), keys_(std::move(keys)) {}

  /// Adds `fault`; faults equal in place, rule and message are kept once. At most kMaxFaults are kept; more are only
  /// counted. Fills `path` from the place, and set, task and port from the path where `fault` has none.
  void add(Fault fault);
  /// Adds information that is no breach of a rule; a repeated sentence is kept once.
  void note(std::string text);
  /// Adds all faults and notes of `other`.
  void add_all(const Report& other);
  /// Adds an offer to the fault with that number.
  void offer(std::size_t fault, Offer offer);
  /// Sorts the faults by place.
  void sort();

  /// From now on faults get their paths from `keys`; faults of before get those of the keys at their places.
  void use(std::shared_ptr<const KeyPaths> keys);
  const std::shared_ptr<const KeyPaths>& keys() const noexcept { return keys_; }
  const std::string& file() const noexcept { return file_; }
  std::span<const Fault> faults() const noexcept { return faults_; }
  std::span<const std::string> notes() const noexcept { return notes_; }
  /// True if it has no error; warnings do not count.
  bool is_legal() const noexcept { return errors_ == 0; }
  std::size_t errors() const noexcept { return errors_; }
  std::size_t warnings() const noexcept { return warnings_; }
  bool has(std::string_view rule) const noexcept;

  /// One `file:line:column: error: message [rule]` line per fault, then its remedy line, if it has one; after all
  /// faults, `file: note: text` lines.
  std::string text() const;
  /// One JSON object, without a line end.
  std::string json() const;

  static constexpr std::size_t kMaxFaults = 200;

 private:
  void locate(Fault& fault) const;

  std::string file_;
  std::shared_ptr<const KeyPaths> keys_;
  std::vector<Fault> faults_;
  std::vector<std::string> notes_;
  std::size_t errors_ = 0;
  std::size_t warnings_ = 0;
};

}  // namespace chimera
