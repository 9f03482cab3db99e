// SPDX-License-Identifier: Apache-2.0
// Messages between the manager and its analyst: one for each question, one for its answer. Texts are in sealed memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "chimera/base/result.h"
#include "chimera/catalogue/library.h"

namespace chimera::manager {

/// A question about a description that is independent of the running one.
struct Question {
  enum class Kind : std::uint16_t { kCheck, kSchedule, kDraft, kOffers, kModes, kDifferences };
  Kind kind = Kind::kCheck;
  std::string file;  ///< name for messages
  std::string text;
  std::string with = {};      ///< kDraft: a JSON array of acts, or empty; kDifferences: the other text
  std::uint64_t version = 0;  ///< written into the answer of the last four kinds
};

/// 32 bytes over a Channel, with memory. The memory of a question: `file_bytes` of the name, `text_bytes` of the text,
/// `with_bytes` of Question::with, one unused byte. The memory of an answer: `text_bytes` of JSON, `with_bytes` of
/// AnalystAnswer::edited.
struct QuestionMessage {
  enum class What : std::uint16_t {
    kQuestion,
    kAnswer,
    kRefusal,   ///< its JSON is {"message", "where"}
    kNoMemory,  ///< kAnalystMemory was not enough, or the answer exceeds kMaxAnalysis
  };
  What what = What::kQuestion;
  Question::Kind kind = Question::Kind::kCheck;
  std::uint32_t file_bytes = 0, text_bytes = 0, with_bytes = 0;
  std::uint64_t number = 0;  ///< of the question
  std::uint64_t version = 0;
};
static_assert(sizeof(QuestionMessage) == 32);

inline std::span<const std::byte> bytes_of(const QuestionMessage& message) noexcept {
  return std::as_bytes(std::span(&message, 1));
}
inline std::span<std::byte> bytes_of(QuestionMessage& message) noexcept {
  return std::as_writable_bytes(std::span(&message, 1));
}

inline constexpr std::uint64_t kAnalystMemory = std::uint64_t{1} << 30;
inline constexpr std::uint64_t kMaxAnalysis = std::uint64_t{32} << 20;  ///< bytes of one answer

struct AnalystAnswer {
  std::string json;    ///< one line
  std::string edited;  ///< kDraft: the text after the acts; else empty
};

/// kCheck, kSchedule: docs/formats/run.md, the report of `check`, or for a legal text the analysis of `schedule`. The
/// other kinds: docs/formats/web.md, `draft`, `remedies`, `transitions`, `differences`. Refuses acts that cannot be
/// done to the text, and differences of a text that cannot be read, with the place. Context: setup; may take seconds.
Result<AnalystAnswer> answer_of(const Question& question, const Library& library);

}  // namespace chimera::manager
