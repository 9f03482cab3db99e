// SPDX-License-Identifier: Apache-2.0
// The questions that wait for the analyst, and the analyst itself. It is a process of its own, so that no act waits for
// an analysis and no act is lost if the analyst dies. docs/formats/control.md, "Limits".
#pragma once

#include <deque>
#include <functional>
#include <string>
#include <string_view>

#include "chimera/base/time.h"
#include "chimera/control/rpc_response.h"
#include "chimera/manager/answer/question.h"
#include "chimera/platform/local_socket.h"
#include "chimera/platform/process.h"

namespace chimera::manager {

/// Limits: questions of one connection; questions of all; bytes of all their texts.
inline constexpr std::size_t kMaxQuestionsOfConnection = 4, kMaxQuestions = 64;
inline constexpr std::size_t kMaxQuestionBytes = std::size_t{16} << 20;
inline constexpr Nanoseconds kAnalysisLimit = seconds(30);  ///< after it the analyst is killed
/// Time without a question after which the analyst is killed.
inline constexpr Nanoseconds kAnalystIdle = seconds(10);

/// Context: setup; blocks only for the start of a process.
class Questions {
 public:
  /// Takes the one answer of a question. `edited`: the text after the acts of a draft; else empty. It is there during
  /// the call alone.
  using Take = std::function<void(const control::RpcResponse& answer, std::string_view edited)>;

  /// `program` is chimera-manager, `bundle` the descriptor of the bundle; both outlive it. `tell` logs an event with
  /// the given text.
  Questions(std::string program, int bundle, std::function<void(const std::string&)> tell)
      : program_(std::move(program)), bundle_(bundle), tell_(std::move(tell)) {}
  Questions(const Questions&) = delete;
  Questions& operator=(const Questions&) = delete;
  /// Kills the analyst, even during a question.
  ~Questions();

  /// Queues a question of a connection. `take` gets its one answer, maybe at once: a refusal if too many questions
  /// wait.
  void ask(Question question, std::uint64_t connection, Take take, Nanoseconds now);
  /// The connection is closed: its questions are removed, and a question under way is given up.
  void forget(std::uint64_t connection);

  /// Readable when serve() has an answer to read; -1: there is no analyst.
  int descriptor() const noexcept { return channel_.descriptor(); }
  /// Time when serve() is due even if nothing is readable.
  Nanoseconds next_due() const noexcept;
  /// Reads an answer of the analyst and sends it the next question. One answer a call, because it may be large.
  void serve(Nanoseconds now);
  std::size_t waiting() const noexcept { return waiting_.size(); }  ///< including the one under way
  pid_t analyst() const noexcept { return analyst_.pid(); }         ///< -1: none

 private:
  struct Waiting {
    Question question;
    std::uint64_t connection;
    Take take;
  };

  void take_answer(Nanoseconds now);
  void answer_first(const control::RpcResponse& answer, Nanoseconds now, std::string_view edited = {});
  void pass_on(Nanoseconds now);
  bool start(Nanoseconds now);
  bool send_first();
  void end_analyst();
  std::string how_it_ended();
  std::deque<Waiting>::iterator next_question();

  std::string program_;
  int bundle_;
  std::function<void(const std::string&)> tell_;
  std::deque<Waiting> waiting_;  // the first one is the one under way, if there is one
  bool is_under_way_ = false;
  std::uint64_t number_ = 0;  // of the question under way
  std::uint64_t last_connection_ = 0;
  Nanoseconds since_;  // start of the question under way, or of the idle time
  Process analyst_;
  Channel channel_;
};

}  // namespace chimera::manager
