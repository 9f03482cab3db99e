// SPDX-License-Identifier: Apache-2.0
// Hashes publications and faults, byte by byte in an order that no machine changes.
#include "chimera/runtime/record/digest.h"

#include <cstring>

namespace chimera {
namespace {

/// FNV-1a of 64 bits; numbers enter with their lowest byte first.
class Fnv {
 public:
  static constexpr std::uint64_t kStart = 0xcbf2'9ce4'8422'2325;

  explicit Fnv(std::uint64_t& hash) noexcept : hash_(hash) {}

  void add(std::uint64_t value, std::size_t bytes) noexcept {
    for (; bytes > 0; --bytes, value >>= 8) add_byte(static_cast<std::uint8_t>(value));
  }
  /// The text up to its zero, at most `most` bytes, and a zero.
  void add_text(const char* text, std::size_t most) noexcept {
    for (; most > 0 && *text != '\0'; --most) add_byte(static_cast<std::uint8_t>(*text++));
    add_byte(0);
  }
  /// One value of a type of chimera/task/abi.h.
  void add_value(std::uint32_t type, const std::byte* at, std::size_t size) noexcept {
    if (type == CHIMERA_STRING) return add_text(reinterpret_cast<const char*>(at), size);
    if (type == CHIMERA_FLOAT64) return add_number<std::uint64_t>(at, 0x7ff0'0000'0000'0000, 0x7ff8'0000'0000'0000);
    if (type == CHIMERA_FLOAT32) return add_number<std::uint32_t>(at, 0x7f80'0000, 0x7fc0'0000);
    for (; size > 0; --size) add_byte(static_cast<std::uint8_t>(*at++));
  }

 private:
  void add_byte(std::uint8_t byte) noexcept { hash_ = (hash_ ^ byte) * 0x100'0000'01b3; }
  /// The bits of a floating number; every NaN counts as `nan`.
  template <class Bits>
  void add_number(const std::byte* at, Bits infinity, Bits nan) noexcept {
    Bits bits;
    std::memcpy(&bits, at, sizeof bits);
    add((bits & ~(Bits{1} << (8 * sizeof bits - 1))) > infinity ? nan : bits, sizeof bits);
  }

  std::uint64_t& hash_;
};

/// Since the origin. Before its first `on` a task has no release: what it publishes counts at the origin, whose instant
/// on the clock differs between machines.
Nanoseconds release_of(const Task& task, Nanoseconds origin) noexcept {
  const bool has_release = task.state == State::kOn || task.profile.cycles > 0;
  return has_release ? task.last_release - origin : Nanoseconds{};
}

void add_output(Fnv& hash, const DeclaredPort& declared, const Output& output, const std::byte* at) noexcept {
  const std::uint32_t size = output.spec->element_bytes;
  for (std::uint32_t i = 0; i < output.port->count; ++i, at += size) {
    if (output.spec->type != CHIMERA_STRUCT || declared.n_fields() == 0) hash.add_value(output.spec->type, at, size);
    for (std::uint32_t f = 0; output.spec->type == CHIMERA_STRUCT && f < declared.n_fields(); ++f) {
      const FieldForm field = declared.field(f);
      for (std::uint32_t k = 0; k < field.count; ++k)
        hash.add_value(field.type, at + field.offset + k * field.size, field.size);
    }
  }
}

}  // namespace

Digest::Digest(std::size_t n_tasks, DigestLines& lines, SetupMemory& memory)
    : of_(memory.take<OfTask>(n_tasks)), lines_(lines) {
  for (std::size_t i = 0; i < n_tasks; ++i) of_[i].line.task = TaskId(i), of_[i].line.hash = Fnv::kStart;
}

void Digest::hand_over(DigestLine& line) noexcept {
  if (line.publications != 0 || line.faults != 0) lines_.take(line);
  line.publications = line.faults = 0;
  line.hash = Fnv::kStart;
}

// The instants of acts and publications differ between machines, those of releases do not.
Digest::OfTask& Digest::of(const Task& task) noexcept {
  OfTask& found = of_[task.id.index];
  const std::int64_t second = release_of(task, origin_).count / seconds(1).count;
  if (second > found.line.second) {
    hand_over(found.line);
    found.line.second = second;
  }
  return found;
}

void Digest::add_publication(const Task& task) noexcept {
  DigestLine& line = of(task).line;
  ++line.publications;
  const chimera_slot& slot = *task.group.published();
  const auto* payload = reinterpret_cast<const std::byte*>(&slot + 1);
  Fnv hash(line.hash);
  hash.add('P', 1);
  hash.add(static_cast<std::uint64_t>(release_of(task, origin_).count), 8);
  hash.add(slot.sequence, 8);
  hash.add(slot.valid, 8);
  for (const Output& output : task.outputs)
    add_output(hash, task.ports[output.spec->declared], output, payload + output.offset);
}

void Digest::add_faults(const Task& task) noexcept {
  OfTask& found = of(task);
  found.line.faults += task.faults.count - found.faults_seen;
  found.faults_seen = task.faults.count;
  Fnv hash(found.line.hash);
  hash.add('F', 1);
  hash.add(task.faults.count, 8);
  hash.add(static_cast<std::uint64_t>(task.faults.method), 1);
  hash.add(static_cast<std::uint64_t>(task.faults.last.code), 4);
  hash.add_text(task.faults.last.text, CHIMERA_FAULT_TEXT);
}

void Digest::end() noexcept {
  for (OfTask& of : of_) hand_over(of.line);
}

}  // namespace chimera
