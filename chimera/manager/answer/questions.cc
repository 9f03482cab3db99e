// SPDX-License-Identifier: Apache-2.0
// Queues questions by connection, and starts, watches and ends the analyst.
#include "chimera/manager/answer/questions.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "chimera/platform/descriptor.h"
#include "chimera/platform/process_state.h"
#include "chimera/platform/shared_memory.h"
#include "chimera/text/json.h"

namespace chimera::manager {
namespace {

using control::RpcResponse;

RpcResponse too_many(const char* what) { return RpcResponse::error(control::kTooFast, what, {{"retry_ms", 100}}); }

RpcResponse given_up(const std::string& why) {
  return RpcResponse::refused("analysis", why, "text", "ask `chimera check` or `chimera schedule` with the file");
}

/// An answer in the memory of the analyst. A large text is sent directly from there.
struct PassedAnswer {
  RpcResponse response = given_up("the answer of the analysis cannot be read");
  std::shared_ptr<const FrozenBytes> memory;
  std::string_view edited;

  PassedAnswer(int passed, const QuestionMessage& told) {
    auto opened = FrozenBytes::open(passed);
    if (!opened || opened->bytes().size() < std::size_t{told.text_bytes} + told.with_bytes) return;
    memory = std::make_shared<const FrozenBytes>(*std::move(opened));
    const std::string_view both(reinterpret_cast<const char*>(memory->bytes().data()), memory->bytes().size());
    const std::string_view text = both.substr(0, told.text_bytes);
    edited = both.substr(text.size(), told.with_bytes);
    if (told.what == QuestionMessage::What::kRefusal) {
      const Json refusal = Json::parse_or_none(text).value_or(Json());
      response = RpcResponse::refused("edit", text_at(refusal, "message"), text_at(refusal, "where"));
    } else if (text.size() > control::kPiece) {
      response = RpcResponse::in_pieces(std::make_shared<control::TextPieces>(memory, text));
    } else {
      response = RpcResponse::ready(std::make_shared<const std::string>(text));
    }
  }
};

std::size_t bytes_in(const Question& question) { return question.text.size() + question.with.size(); }

}  // namespace

Questions::~Questions() { end_analyst(); }

void Questions::ask(Question question, std::uint64_t connection, Take take, Nanoseconds now) {
  std::size_t own = 0, bytes = bytes_in(question);
  for (const Waiting& one : waiting_) {
    own += one.connection == connection ? 1 : 0;
    bytes += bytes_in(one.question);
  }
  if (own >= kMaxQuestionsOfConnection) return take(too_many("4 analyses of this connection are under way"), {});
  if (waiting_.size() >= kMaxQuestions) return take(too_many("64 analyses are under way"), {});
  if (bytes > kMaxQuestionBytes) return take(too_many("analyses of 16 MiB of text are under way"), {});
  waiting_.push_back({std::move(question), connection, std::move(take)});
  pass_on(now);
}

void Questions::forget(std::uint64_t connection) {
  if (is_under_way_ && waiting_.front().connection == connection) end_analyst();
  std::erase_if(waiting_, [connection](const Waiting& one) { return one.connection == connection; });
}

Nanoseconds Questions::next_due() const noexcept {
  if (!waiting_.empty() && !is_under_way_) return since_;
  if (is_under_way_) return since_ + kAnalysisLimit;
  return channel_.is_open() ? since_ + kAnalystIdle : kNever;
}

void Questions::serve(Nanoseconds now) {
  if (channel_.is_open()) take_answer(now);
  if (is_under_way_ && now - since_ >= kAnalysisLimit) {
    end_analyst();
    answer_first(given_up("the analysis was ended: it took longer than 30 s"), now);
  }
  if (channel_.is_open() && waiting_.empty() && now - since_ >= kAnalystIdle) end_analyst();
  pass_on(now);
}

void Questions::take_answer(Nanoseconds now) {
  QuestionMessage told;
  int passed = -1;
  const Channel::Got got = channel_.receive(bytes_of(told), passed);
  if (got == Channel::Got::kNothing) return;
  const OwnedDescriptor received(passed);
  const bool is_asked = got == Channel::Got::kMessage && is_under_way_ && told.number == number_;
  if (is_asked && told.what == QuestionMessage::What::kNoMemory) {
    answer_first(
        given_up("the analysis was given up: it needs more than 1 GiB of memory, or its answer more than 32 MiB"), now);
  } else if (is_asked) {
    const PassedAnswer answer(passed, told);
    answer_first(answer.response, now, answer.edited);
  } else if (got == Channel::Got::kClosed) {
    const bool was_under_way = is_under_way_;
    const std::string how = how_it_ended();
    tell_("the analyst of descriptions " + how);
    if (was_under_way) answer_first(given_up("the analysis failed: its process " + how), now);
  }
}

void Questions::answer_first(const RpcResponse& answer, Nanoseconds now, std::string_view edited) {
  is_under_way_ = false;
  since_ = now;
  Waiting first = std::move(waiting_.front());
  waiting_.pop_front();
  first.take(answer, edited);
}

/// The oldest question of the connection whose turn it is, so that many questions of one connection do not delay the
/// others.
std::deque<Questions::Waiting>::iterator Questions::next_question() {
  auto best = waiting_.begin();
  const auto rank = [this](std::uint64_t connection) { return std::pair(connection <= last_connection_, connection); };
  for (auto at = waiting_.begin(); at != waiting_.end(); ++at)
    if (rank(at->connection) < rank(best->connection)) best = at;
  return best;
}

void Questions::pass_on(Nanoseconds now) {
  if (is_under_way_ || waiting_.empty()) return;
  if (!channel_.is_open() && !start(now)) return;
  const auto next = next_question();
  last_connection_ = next->connection;
  std::rotate(waiting_.begin(), next, next + 1);  // the questions before it keep their order
  since_ = now;
  is_under_way_ = true;
  ++number_;
  if (send_first()) return;
  tell_("the analyst of descriptions " + how_it_ended());  // it died after the last question: start another one
  if (!start(now)) return;
  is_under_way_ = true;
  if (!send_first())
    answer_first(given_up("the analysis could not be started: " + std::string(std::strerror(errno))), now);
}

bool Questions::start(Nanoseconds now) {
  auto ends = Channel::pair();
  const std::string parent = std::to_string(own_process_id());
  const char* const words[] = {program_.c_str(), "--analyst", "--parent", parent.c_str()};
  auto started = ends ? Process::start(program_.c_str(), words, std::array{ends->second.descriptor(), bundle_})
                      : Result<Process>(ends.error());
  if (!started) {
    const std::string why = started.error().message.c_str();
    while (!waiting_.empty()) answer_first(given_up("the analysis could not be started: " + why), now);
    return false;
  }
  analyst_ = *std::move(started);
  channel_ = std::move(ends->first);
  return true;
}

bool Questions::send_first() {
  const Question& question = waiting_.front().question;
  const std::string all = question.file + question.text + question.with + "\n";
  const auto frozen = FrozenBytes::create("question", std::as_bytes(std::span(all)));
  const QuestionMessage asked{.kind = question.kind,
                              .file_bytes = static_cast<std::uint32_t>(question.file.size()),
                              .text_bytes = static_cast<std::uint32_t>(question.text.size()),
                              .with_bytes = static_cast<std::uint32_t>(question.with.size()),
                              .number = number_,
                              .version = question.version};
  return frozen && channel_.send(bytes_of(asked), frozen->descriptor());
}

void Questions::end_analyst() {
  if (!analyst_.is_held()) return;
  analyst_.signal(SIGKILL);
  (void)how_it_ended();
}

/// Waits for the end of an analyst that has ended or was killed, and says how it ended.
std::string Questions::how_it_ended() {
  ProcessEnd end;
  channel_ = Channel();
  is_under_way_ = false;
  const bool is_known = analyst_.wait(end, kSigkillLimit.count);
  analyst_ = Process();
  if (!is_known) return "hangs";
  if (!end.by_signal) return "ended with status " + std::to_string(end.code);
  return "ended by " + std::string(signal_text(end.code).view());
}

}  // namespace chimera::manager
