// SPDX-License-Identifier: Apache-2.0
// The questions that wait for the analyst, and the analyst: a process of its own, so that no act waits for an analysis
// and none is lost with one. docs/formats/control.md, "Limits".
#pragma once

#include <deque>
#include <functional>
#include <string>

#include "chimera/base/time.h"
#include "chimera/control/rpc_response.h"
#include "chimera/manager/question.h"
#include "chimera/platform/local_socket.h"
#include "chimera/platform/process.h"

namespace chimera::manager {

/// Of one connection, one after the other; of all; and of all their texts.
inline constexpr std::size_t kMaxQuestionsOfConnection = 4, kMaxQuestions = 64;
inline constexpr std::size_t kMaxQuestionBytes = std::size_t{16} << 20;
inline constexpr Nanoseconds kAnalysisLimit = seconds(30);  ///< then the analyst is ended
inline constexpr Nanoseconds kAnalystIdle = seconds(10);    ///< it is ended when nobody asked for that long

/// Context: setup; never blocks but for the start of a process.
class Questions {
 public:
  /// `program` is chimera-manager, `bundle` the descriptor of the bundle; both outlive this. `tell` takes the text of
  /// an event.
  Questions(std::string program, int bundle, std::function<void(const std::string&)> tell)
      : program_(std::move(program)), bundle_(bundle), tell_(std::move(tell)) {}
  Questions(const Questions&) = delete;
  Questions& operator=(const Questions&) = delete;
  /// Ends the analyst, also in the middle of a question.
  ~Questions();

  /// Queues a question of a connection; `reply` takes its one answer, maybe at once: a refusal when too many wait.
  void ask(Question question, std::uint64_t connection, control::Reply reply, Nanoseconds now);
  /// Nobody waits for the answers to that connection: its questions are taken out, one under way is given up.
  void forget(std::uint64_t connection);

  /// Readable when serve() has something to do; -1: there is no analyst.
  int descriptor() const noexcept { return channel_.descriptor(); }
  /// When serve() is due though nothing came.
  Nanoseconds next_due() const noexcept;
  /// Takes what the analyst says, passes on what waits. One answer at a time: it may be large.
  void serve(Nanoseconds now);
  std::size_t waiting() const noexcept { return waiting_.size(); }  ///< one under way included
  pid_t analyst() const noexcept { return analyst_.pid(); }         ///< -1: none

 private:
  struct Waiting {
    Question question;
    std::uint64_t connection;
    control::Reply reply;
  };

  void take_answer(Nanoseconds now);
  void answer_first(const control::RpcResponse& answer, Nanoseconds now);
  void pass_on(Nanoseconds now);
  bool start(Nanoseconds now);
  bool send_first();
  void end_analyst();
  std::string how_it_ended();
  std::deque<Waiting>::iterator next_question();

  std::string program_;
  int bundle_;
  std::function<void(const std::string&)> tell_;
  std::deque<Waiting> waiting_;  // the first is the one under way, if any is
  bool is_under_way_ = false;
  std::uint64_t number_ = 0;  // of the question under way
  std::uint64_t last_connection_ = 0;
  Nanoseconds since_;  // the question is under way, or nobody asked
  Process analyst_;
  Channel channel_;
};

}  // namespace chimera::manager
