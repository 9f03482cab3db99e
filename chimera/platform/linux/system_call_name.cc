// SPDX-License-Identifier: Apache-2.0
// Names of the system calls that components make most.
#include "chimera/platform/system_call_name.h"

#include <sys/syscall.h>

namespace chimera {
namespace {

struct Name {
  long number;
  const char* name;
};

constexpr Name kNames[] = {
    {SYS_read, "read"},           {SYS_write, "write"},       {SYS_openat, "openat"},
    {SYS_close, "close"},         {SYS_lseek, "lseek"},       {SYS_mmap, "mmap"},
    {SYS_munmap, "munmap"},       {SYS_brk, "brk"},           {SYS_ioctl, "ioctl"},
    {SYS_futex, "futex"},         {SYS_socket, "socket"},     {SYS_connect, "connect"},
    {SYS_sendto, "sendto"},       {SYS_recvfrom, "recvfrom"}, {SYS_sendmsg, "sendmsg"},
    {SYS_recvmsg, "recvmsg"},     {SYS_ppoll, "ppoll"},       {SYS_nanosleep, "nanosleep"},
    {SYS_clock_nanosleep, "clock_nanosleep"},                 {SYS_clock_gettime, "clock_gettime"},
    {SYS_getpid, "getpid"},       {SYS_gettid, "gettid"},     {SYS_sched_yield, "sched_yield"},
    {SYS_madvise, "madvise"},     {SYS_mprotect, "mprotect"}, {SYS_fsync, "fsync"},
    {SYS_exit_group, "exit_group"},
};

}  // namespace

std::string system_call_name(std::uint64_t number) {
  for (const Name& one : kNames)
    if (static_cast<std::uint64_t>(one.number) == number) return one.name;
  return "system call " + std::to_string(number);
}

}  // namespace chimera
