// SPDX-License-Identifier: Apache-2.0
// Takes lines apart, looks names up, and hands acts to the cycle boundary. One piece of work a step.
#include "firmware/shell/shell.h"

namespace chimera::firmware {
namespace {

constexpr int kBytesRead = 32, kBytesSent = 64;
constexpr std::size_t kNamesLookedAt = 16;

// The first verbs have the numbers of their signals.
static_assert(static_cast<int>(Verb::kSpawn) == static_cast<int>(Signal::kSpawn));
static_assert(static_cast<int>(Verb::kOn) == static_cast<int>(Signal::kOn));
static_assert(static_cast<int>(Verb::kOff) == static_cast<int>(Signal::kOff));
static_assert(static_cast<int>(Verb::kKill) == static_cast<int>(Signal::kKill));
static_assert(static_cast<int>(Verb::kClear) == static_cast<int>(Signal::kClear));
static_assert(static_cast<int>(Verb::kReinit) == static_cast<int>(Signal::kReinit));

}  // namespace

bool Shell::receive(std::uint8_t byte) noexcept {
  const std::uint32_t needed = is_losing_ ? 2 : 1;
  if (in_.free() < needed) {
    is_losing_ = true;
    lost_.store(lost_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
    return false;
  }
  if (is_losing_) in_.add(kLostMark);
  is_losing_ = false;
  in_.add(byte);
  return true;
}

bool Shell::has_work() const noexcept {
  if (is_sending_) return out_.free() > 0;
  switch (phase_) {
    case Phase::kRead: return in_.size() > 0;
    case Phase::kAct: return parts_.listener.is_done();
    case Phase::kSwitch: return parts_.listener.is_switch_over();
    default: return true;
  }
}

void Shell::step(Nanoseconds now) noexcept {
  if (is_sending_) return send();
  switch (phase_) {
    case Phase::kRead: return read();
    case Phase::kFind: return find();
    case Phase::kTyped: return read_typed();
    case Phase::kAct:
      if (parts_.listener.is_done()) end_act();
      return;
    case Phase::kSwitch:
      if (parts_.listener.is_switch_over()) end_switch();
      return;
    case Phase::kRows:
      if (!make_row(now)) phase_ = Phase::kAnswer;
      return;
    case Phase::kAnswer: return answer();
  }
}

int Shell::next_byte() noexcept {
  if (rows_made_.load(std::memory_order_acquire) == rows_sent_) return -1;  // pairs with send()
  const int byte = out_.take();
  if (byte == '\n') ++rows_sent_;
  return byte;
}

void Shell::send() noexcept {
  const std::size_t n = line_.size();
  for (int i = 0; i < kBytesSent && sent_ < n + 2; ++i, ++sent_) {
    const char c = sent_ < n ? line_.view()[sent_] : sent_ == n ? '\r' : '\n';
    if (!out_.add(static_cast<std::uint8_t>(c))) return;
  }
  if (sent_ < n + 2) return;
  const std::uint32_t made = rows_made_.load(std::memory_order_relaxed) + 1;
  rows_made_.store(made, std::memory_order_release);  // pairs with next_byte()
  is_sending_ = false;
  line_.clear();
  sent_ = 0;
}

void Shell::read() noexcept {
  for (int i = 0; i < kBytesRead; ++i) {
    const int byte = in_.take();
    if (byte < 0) return;
    if (reader_.add(static_cast<std::uint8_t>(byte))) return begin_line();
  }
}

void Shell::begin_line() noexcept {
  phase_ = Phase::kAnswer;
  operand_ = at_ = 0;
  act_ = {};
  if (refuse_line()) return;
  command_ = parse(reader_.line());
  switch (command_.fault) {
    case LineFault::kUnknown: why_.put("no command '%s': try help", command_.words.begin()[0]); return;
    case LineFault::kTooManyWords: why_.put("a line has at most %u words", kMostWords); return;
    case LineFault::kTooFew:
    case LineFault::kTooMany:
      why_.put("%z takes %z", command_.command->name,
               command_.command->operand == Operand::kNone ? "no operand" : command_.command->operands);
      return;
    case LineFault::kNone: break;
  }
  if (command_.command == nullptr) {  // a line of blanks
    reader_.restart();
    phase_ = Phase::kRead;
    return;
  }
  phase_ = command_.command->operand == Operand::kNone ? Phase::kRows : Phase::kFind;
}

bool Shell::refuse_line() noexcept {
  switch (reader_.fault()) {
    case LineReader::Fault::kNone: return false;
    case LineReader::Fault::kTooLong:
      why_.put("a line has at most %u bytes, not %u", LineReader::kMost, reader_.length());
      return true;
    case LineReader::Fault::kLost:
      if (const std::uint32_t lost = lost_bytes() - lost_told_; lost != 0) {
        why_.put("at least %u bytes of this line or before it were lost: wait for each answer", lost);
        lost_told_ += lost;
        return true;
      }
      break;  // a zero that was sent
    case LineReader::Fault::kBadByte: break;
  }
  why_.put("byte %u is no character of a command", reader_.bad_byte());
  return true;
}

const std::string_view* Shell::name_at(std::size_t i) const noexcept {
  const auto at = [i](auto all) { return i < all.size() ? &all[i].name : nullptr; };
  const ApplicationSpec& spec = parts_.set.spec();
  switch (command_.command->operand) {
    case Operand::kTask: return at(spec.tasks);
    case Operand::kConfiguration: return at(spec.sets);
    default: return at(spec.variables);
  }
}

void Shell::find() noexcept {
  const std::string_view name = command_.operand(operand_);
  for (const std::size_t end = at_ + kNamesLookedAt; at_ < end; ++at_) {
    const std::string_view* const each = name_at(at_);
    if (each == nullptr) {
      static constexpr const char* kKinds[] = {"", "task", "configuration", "variable"};
      why_.put("no %z '%s'", kKinds[static_cast<std::size_t>(command_.command->operand)], name);
      phase_ = Phase::kAnswer;
      return;
    }
    if (*each != name) continue;
    if (!found(at_)) phase_ = Phase::kAnswer;
    return;
  }
}

// False: the line is refused.
bool Shell::found(std::size_t i) noexcept {
  index_ = static_cast<std::uint32_t>(i);
  at_ = 0;
  if (command_.command->operand != Operand::kTask || command_.command->verb == Verb::kProfile) {
    begin_command();
    return true;
  }
  for (const TaskId id : act_.tasks) {
    if (id.index != index_) continue;
    why_.put("task '%s' is named twice", command_.operand(operand_));
    return false;
  }
  (void)act_.tasks.try_push(TaskId(i));
  if (++operand_ == command_.n_operands()) begin_command();
  return true;
}

void Shell::begin_command() noexcept {
  switch (command_.command->verb) {
    case Verb::kSet: return begin_set();
    case Verb::kGet:
    case Verb::kProfile: phase_ = Phase::kRows; return;
    case Verb::kSwitch:
      act_.kind = ShellAct::Kind::kSwitch;
      act_.index = index_;
      break;
    default:
      act_.kind = ShellAct::Kind::kSignal;
      act_.signal = static_cast<Signal>(command_.command->verb);
      break;
  }
  parts_.listener.ask(act_);
  phase_ = Phase::kAct;
}

bool Shell::is_given(std::uint32_t variable) const noexcept {
  return parts_.set.spec().variables[variable].is_given();
}

ValueShape Shell::shape_of(std::uint32_t index, const PortSpec* port) const noexcept {
  const ApplicationSpec& spec = parts_.set.spec();
  const Variable& variable = spec.variables[index];
  ValueShape shape{variable.name, "1"};
  if (variable.is_given()) {
    const GivenSpec& given = spec.operators[variable.operator_index];
    shape.type = given.type;
    shape.element_bytes = given.element_bytes;
    shape.count = given.extent[0].max * given.extent[1].max;
    if (!variable.consumers.empty()) port = spec.port(CHIMERA_IN_VAR, variable.consumers[0]);
  } else if (port != nullptr) {
    shape.type = port->type;
    shape.element_bytes = port->element_bytes;
  }
  if (port != nullptr) shape.unit = port->unit;
  return shape;
}

void Shell::begin_set() noexcept {
  const ValueShape shape = shape_of(index_, nullptr);
  phase_ = Phase::kAnswer;
  if (!is_given(index_)) {
    why_.put("%s is no operator variable", shape.name);
    return;
  }
  const std::span<const std::string_view> words(command_.words.begin() + 2, command_.words.size() - 2);
  typed_ = TypedValue(shape, words, command_.after_first, value_);
  if (typed_.begin(why_)) phase_ = Phase::kTyped;
}

void Shell::read_typed() noexcept {
  if (!typed_.is_complete()) {
    if (!typed_.read_next(why_)) phase_ = Phase::kAnswer;
    return;
  }
  act_.kind = ShellAct::Kind::kSet;
  act_.index = parts_.set.spec().variables[index_].operator_index;
  act_.value = typed_.bytes();
  parts_.listener.ask(act_);
  phase_ = Phase::kAct;
}

void Shell::end_act() noexcept {
  why_ = parts_.listener.refusal();
  const bool is_awaited = act_.kind == ShellAct::Kind::kSwitch && why_.size() == 0;
  phase_ = is_awaited ? Phase::kSwitch : Phase::kAnswer;
}

void Shell::answer() noexcept {
  line_.put("%z%s", why_.size() == 0 ? "ok" : "no: ", why_.view());
  is_sending_ = true;
  why_.clear();
  reader_.restart();
  phase_ = Phase::kRead;
}

}  // namespace chimera::firmware
