// SPDX-License-Identifier: Apache-2.0
// The loop of the analyst: reads one question after the other and answers it within a limit of memory.
#include "chimera/manager/answer/analyst.h"

#include <new>

#include "chimera/manager/answer/question.h"
#include "chimera/manager/state/bundle.h"
#include "chimera/platform/descriptor.h"
#include "chimera/platform/local_socket.h"
#include "chimera/platform/shared_memory.h"
#include "chimera/text/json.h"

namespace chimera::manager {
namespace {

Result<Library> library_in(int descriptor) {
  const OwnedDescriptor inherited(descriptor);
  const auto frozen = FrozenBytes::open(descriptor);
  if (!frozen) return frozen.error();
  const auto text = frozen->bytes();
  auto bundle = decode_bundle({reinterpret_cast<const char*>(text.data()), text.size()});
  if (!bundle) return bundle.error();
  return std::move(bundle->library);
}

Result<Question> question_in(const QuestionMessage& asked, int passed) {
  const auto frozen = FrozenBytes::open(passed);
  if (!frozen) return frozen.error();
  const auto bytes = frozen->bytes();
  const std::size_t before = std::size_t{asked.file_bytes} + asked.text_bytes;
  if (bytes.size() <= before + asked.with_bytes)
    return Error{ErrorCode::kBadInput, std::string_view("truncated"), std::string_view("question")};
  const char* begin = reinterpret_cast<const char*>(bytes.data());
  return Question{asked.kind,
                  {begin, asked.file_bytes},
                  {begin + asked.file_bytes, asked.text_bytes},
                  {begin + before, asked.with_bytes},
                  asked.version};
}

std::string refusal_json(const Error& error) {
  return Json{{"message", error.message.c_str()}, {"where", error.where.c_str()}}.dump();
}

/// False if the manager is gone.
bool answer(const Channel& channel, const QuestionMessage& asked, int passed, const Library& library) {
  QuestionMessage told{.what = QuestionMessage::What::kNoMemory, .kind = asked.kind, .number = asked.number};
  const auto question = question_in(asked, passed);
  if (!question) return false;
  FrozenBytes bytes;
  try {
    const auto answered = answer_of(*question, library);
    const AnalystAnswer answer = answered ? *answered : AnalystAnswer{refusal_json(answered.error()), {}};
    const std::string both = answer.json + answer.edited;
    auto frozen = FrozenBytes::create("answer", std::as_bytes(std::span(both)));
    if (frozen && both.size() <= kMaxAnalysis) {
      bytes = *std::move(frozen);
      told.what = answered ? QuestionMessage::What::kAnswer : QuestionMessage::What::kRefusal;
      told.text_bytes = static_cast<std::uint32_t>(answer.json.size());
      told.with_bytes = static_cast<std::uint32_t>(answer.edited.size());
    }
  } catch (const std::bad_alloc&) {
  }
  return channel.send(bytes_of(told), bytes.descriptor());
}

}  // namespace

Result<int> run_analyst(int inherited_channel, int bundle) {
  const Channel channel(inherited_channel);
  const auto library = library_in(bundle);
  if (!library) return library.error();
  while (true) {
    QuestionMessage asked;
    int passed = -1;
    const Channel::Got got = channel.receive(bytes_of(asked), passed);
    if (got == Channel::Got::kClosed) return 0;
    if (got == Channel::Got::kNothing) {
      const int descriptors[] = {channel.descriptor()};
      await_readable(descriptors, kNever);
      continue;
    }
    const OwnedDescriptor question(passed);
    if (!answer(channel, asked, passed, *library)) return 0;
  }
}

}  // namespace chimera::manager
