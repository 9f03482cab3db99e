// SPDX-License-Identifier: Apache-2.0
#include "chimera/load/elf_check.h"

#include <elf.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>

namespace chimera {
namespace {

#if defined(__x86_64__)
constexpr std::uint16_t kMachine = EM_X86_64;
#elif defined(__aarch64__)
constexpr std::uint16_t kMachine = EM_AARCH64;
#elif defined(__riscv)
constexpr std::uint16_t kMachine = EM_RISCV;
#endif

bool is_inside(std::uint64_t offset, std::uint64_t size, std::uint64_t whole) noexcept {
  return offset <= whole && size <= whole - offset;
}

bool is_whole(int file, const Elf64_Ehdr& head, std::uint64_t size) noexcept {
  if (!is_inside(head.e_shoff, std::uint64_t{head.e_shnum} * head.e_shentsize, size)) return false;
  for (std::uint16_t i = 0; i < head.e_phnum; ++i) {
    Elf64_Phdr segment{};
    const auto at = static_cast<off_t>(head.e_phoff + std::uint64_t{i} * sizeof segment);
    if (::pread(file, &segment, sizeof segment, at) != sizeof segment) return false;
    if (!is_inside(segment.p_offset, segment.p_filesz, size)) return false;
  }
  return true;
}

}  // namespace

std::string_view elf_fault(int file) noexcept {
  Elf64_Ehdr head{};
  const ssize_t got = ::pread(file, &head, sizeof head, 0);
  if (got < SELFMAG || std::memcmp(head.e_ident, ELFMAG, SELFMAG) != 0)
    return "is not a shared object: it does not begin with the ELF mark";
  struct stat status {};
  if (::fstat(file, &status) != 0 || got != sizeof head) return "is cut short";
  if (head.e_ident[EI_CLASS] != ELFCLASS64 || head.e_machine != kMachine) return "was built for another machine";
  if (head.e_type != ET_DYN) return "is not a shared object: it is another kind of ELF file";
  if (head.e_phentsize != sizeof(Elf64_Phdr)) return "has damaged headers";
  if (!is_whole(file, head, static_cast<std::uint64_t>(status.st_size))) return "is cut short";
  return "";
}

}  // namespace chimera
