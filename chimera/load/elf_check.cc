// SPDX-License-Identifier: Apache-2.0
// Checks headers, segments and exported symbols of an ELF file against its bytes. Also checks that no part of the
// object can make real-time threads wait.
#include "chimera/load/elf_check.h"

#include <elf.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "chimera/platform/file.h"
#include "chimera/task/abi.h"

namespace chimera {
namespace {

#if defined(__x86_64__)
constexpr std::uint16_t kMachine = EM_X86_64;
constexpr std::string_view kMachineName = "x86-64";
#elif defined(__aarch64__)
constexpr std::uint16_t kMachine = EM_AARCH64;
constexpr std::string_view kMachineName = "AArch64";
#elif defined(__riscv)
constexpr std::uint16_t kMachine = EM_RISCV;
constexpr std::string_view kMachineName = "RISC-V";
#endif

constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;  // the largest file that is searched

bool is_inside(std::uint64_t offset, std::uint64_t size, std::uint64_t whole) noexcept {
  return offset <= whole && size <= whole - offset;
}

bool is_whole(int file, const Elf64_Ehdr& head, std::uint64_t size) noexcept {
  if (!is_inside(head.e_shoff, std::uint64_t{head.e_shnum} * head.e_shentsize, size)) return false;
  for (std::uint16_t i = 0; i < head.e_phnum; ++i) {
    Elf64_Phdr segment{};
    const auto bytes = std::as_writable_bytes(std::span(&segment, 1));
    if (read_at(file, head.e_phoff + std::uint64_t{i} * sizeof segment, bytes) != sizeof segment) return false;
    if (!is_inside(segment.p_offset, segment.p_filesz, size)) return false;
  }
  return true;
}

/// The segment with number `index` in a whole file.
Elf64_Phdr segment_of(int file, const Elf64_Ehdr& head, std::uint16_t index) noexcept {
  Elf64_Phdr segment{};
  read_at(file, head.e_phoff + std::uint64_t{index} * sizeof segment, std::as_writable_bytes(std::span(&segment, 1)));
  return segment;
}

/// Properties of the whole object, from its dynamic section.
struct Marks {
  bool has_text_relocations = false;
  bool has_static_tls = false;  // its thread_local variables lie in the block that each thread has from its start
};

Marks marks_of(int file, const Elf64_Phdr& dynamic) noexcept {
  Marks marks;
  Elf64_Dyn entry{};
  for (std::uint64_t at = 0; at + sizeof entry <= dynamic.p_filesz; at += sizeof entry) {
    const auto bytes = std::as_writable_bytes(std::span(&entry, 1));
    if (read_at(file, dynamic.p_offset + at, bytes) != sizeof entry || entry.d_tag == DT_NULL) break;
    const std::uint64_t flags = entry.d_tag == DT_FLAGS ? entry.d_un.d_val : 0;
    marks.has_text_relocations |= entry.d_tag == DT_TEXTREL || (flags & DF_TEXTREL) != 0;
    marks.has_static_tls |= (flags & DF_STATIC_TLS) != 0;
  }
  return marks;
}

/// True for the thread variable of the framework in an object, which is used only while ports are declared:
/// task/declare_port.h.
bool is_of_the_framework(int file, const Elf64_Phdr& tls) noexcept {
  std::uint64_t words[2] = {};  // the mark, and a pointer
  if (tls.p_memsz != sizeof words || tls.p_filesz != sizeof words) return false;
  const auto bytes = std::as_writable_bytes(std::span(words));
  return read_at(file, tls.p_offset, bytes) == sizeof words && words[0] == CHIMERA_THREAD_MARK;
}

/// The reason why an object that loads is no real-time code. Either a thread allocates memory at its first use of a
/// variable, or the loader writes into the code.
Message unfit_for_real_time(int file, const Elf64_Ehdr& head) noexcept {
  bool has_tls = false;
  Marks marks;
  for (std::uint16_t i = 0; i < head.e_phnum; ++i) {
    const Elf64_Phdr segment = segment_of(file, head, i);
    if (segment.p_type == PT_TLS) has_tls = !is_of_the_framework(file, segment);
    if (segment.p_type == PT_DYNAMIC) marks = marks_of(file, segment);
  }
  if (marks.has_text_relocations)
    return Message("has text relocations, so its code is written when it is loaded: compile all of it with -fPIC");
  if (has_tls && !marks.has_static_tls)
    return Message("has a thread_local variable, whose first use in a real-time thread asks the heap: make it a member "
                   "of the component, or give it __attribute__((tls_model(\"initial-exec\")))");
  return {};
}

/// The whole file; empty if it cannot be read.
std::string contents(int file) {
  const std::int64_t size = file_size(file);
  if (size < 0 || static_cast<std::uint64_t>(size) > kMostBytes) return {};
  std::string bytes(static_cast<std::size_t>(size), '\0');
  return read_at(file, 0, std::as_writable_bytes(std::span(bytes))) == size ? bytes : std::string();
}

/// Record `index` of a table at `offset`; false if it lies outside the bytes.
template <class Record>
bool record_at(const std::string& bytes, std::uint64_t offset, std::uint64_t index, Record& to) {
  if (index > kMostBytes || offset > kMostBytes) return false;
  if (!is_inside(offset + index * sizeof(Record), sizeof(Record), bytes.size())) return false;
  std::memcpy(&to, bytes.data() + offset + index * sizeof(Record), sizeof(Record));
  return true;
}

bool text_is(const std::string& bytes, std::uint64_t at, std::string_view text) {
  return is_inside(at, text.size() + 1, bytes.size()) &&
         std::memcmp(bytes.data() + at, text.data(), text.size()) == 0 && bytes[at + text.size()] == '\0';
}

enum class Exported { kYes, kNo, kUnknown };

/// Checks if the file exports that symbol. Unknown without a table of sections, because some programs remove it.
Exported exports(const std::string& bytes, std::string_view symbol) {
  Elf64_Ehdr head{};
  Elf64_Shdr table{}, names{};
  if (!record_at(bytes, 0, 0, head) || head.e_shentsize != sizeof table) return Exported::kUnknown;
  for (std::uint16_t i = 0; i < head.e_shnum; ++i) {
    if (!record_at(bytes, head.e_shoff, i, table)) return Exported::kUnknown;
    if (table.sh_type != SHT_DYNSYM) continue;
    if (!record_at(bytes, head.e_shoff, table.sh_link, names)) return Exported::kUnknown;
    Elf64_Sym one{};
    for (std::uint64_t s = 0; s < table.sh_size / sizeof one && record_at(bytes, table.sh_offset, s, one); ++s) {
      if (one.st_shndx == SHN_UNDEF || names.sh_offset > kMostBytes) continue;
      if (text_is(bytes, names.sh_offset + one.st_name, symbol)) return Exported::kYes;
    }
    return Exported::kNo;
  }
  return Exported::kUnknown;
}

}  // namespace

Message elf_fault(int file) noexcept {
  Elf64_Ehdr head{};
  const std::int64_t got = read_at(file, 0, std::as_writable_bytes(std::span(&head, 1))), size = file_size(file);
  if (got < 0 || size < 0) return Message("cannot be read");
  if (size == 0) return Message("is empty (0 bytes)");
  if (got < SELFMAG || std::memcmp(head.e_ident, ELFMAG, SELFMAG) != 0)
    return Message("is not a shared object: it does not begin with the ELF mark");
  Message cut;
  cut << "is truncated (" << size << " bytes)";
  if (got != sizeof head) return cut;
  if (head.e_ident[EI_CLASS] != ELFCLASS64 || head.e_machine != kMachine)
    return Message() << "was built for another kind of processor; this machine is " << kMachineName;
  if (head.e_type != ET_DYN) return Message("is not a shared object: it is another kind of ELF file");
  if (head.e_phentsize != sizeof(Elf64_Phdr)) return Message("has damaged headers");
  if (!is_whole(file, head, static_cast<std::uint64_t>(size))) return cut;
  return unfit_for_real_time(file, head);
}

Message elf_fault(int file, std::string_view component) {
  if (Message why = elf_fault(file); !why.empty()) return why;
  const std::string bytes = contents(file);
  if (bytes.empty()) return Message("cannot be read");
  if (exports(bytes, CHIMERA_COMPONENTS_SYMBOL) == Exported::kNo)
    return Message("offers no components: it has no symbol " CHIMERA_COMPONENTS_SYMBOL);
  // The object contains the name as the text that the declaration points to, so its closing zero belongs to it.
  std::string name(component);
  name.push_back('\0');
  if (bytes.find(name) == std::string::npos)
    return Message() << "is not the object of " << component << ": that name does not stand in it";
  return {};
}

}  // namespace chimera
