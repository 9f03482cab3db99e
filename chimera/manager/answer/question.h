// SPDX-License-Identifier: Apache-2.0
// Messages between the manager and its analyst: one for each question, one for its answer. Texts are in sealed memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "chimera/catalogue/library.h"

namespace chimera::manager {

/// A question about a description that is independent of the running one.
struct Question {
  enum class Kind : std::uint32_t { kCheck, kSchedule };
  Kind kind = Kind::kCheck;
  std::string file;  ///< name for messages
  std::string text;
};

/// 32 bytes over a Channel, with memory. For a question the memory has `file_bytes` of the name, `text_bytes` of the
/// text and one unused byte; for an answer it has `text_bytes` of JSON.
struct QuestionMessage {
  enum class What : std::uint32_t {
    kQuestion,
    kAnswer,
    kNoMemory,  ///< kAnalystMemory was not enough, or the answer exceeds kMaxAnalysis
  };
  What what = What::kQuestion;
  Question::Kind kind = Question::Kind::kCheck;
  std::uint64_t number = 0;  ///< of the question
  std::uint64_t file_bytes = 0, text_bytes = 0;
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

/// The answer as one line of JSON, docs/formats/run.md: the report of `check`, or for a legal text the analysis of
/// `schedule`. Context: setup; may take seconds.
std::string answer_of(const Question& question, const Library& library);

}  // namespace chimera::manager
