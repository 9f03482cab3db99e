// SPDX-License-Identifier: Apache-2.0
// Preloaded into the processes of a subsystem: the N-th of the calls below that gives out memory, a descriptor, a
// thread or a process fails as if there were no more. CHIMERA_FAIL="PROGRAM N [once]": of each process of PROGRAM (run,
// attend, chimera-manager, chimera-rtpu), or of the first one only. A line in the file CHIMERA_FAILED says what failed.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

static atomic_long calls;
static long fails_at;  // 0: nothing fails here
static int only_once;
static const char* record;
static char program[64];

__attribute__((constructor)) static void begin(int argc, char** argv) {
  const char* wanted = getenv("CHIMERA_FAIL");
  record = getenv("CHIMERA_FAILED");
  if (wanted == NULL || record == NULL || argc < 1) return;
  const char* slash = strrchr(argv[0], '/');
  const char* name = slash == NULL ? argv[0] : slash + 1;
  if (strcmp(name, "chimera") == 0 && argc > 1) name = argv[1];
  char once[8] = "";
  long n = 0;
  if (sscanf(wanted, "%63s %ld %7s", program, &n, once) < 2 || strcmp(name, program) != 0) return;
  only_once = once[0] != '\0';
  fails_at = n;
}

// Whether this call is the one; it has told so then.
static int is_it(const char* call) {
  if (fails_at == 0 || atomic_fetch_add(&calls, 1) + 1 != fails_at) return 0;
  const int how = O_WRONLY | O_CREAT | O_APPEND | (only_once ? O_EXCL : 0);
  const long file = syscall(SYS_openat, AT_FDCWD, record, how, 0600);
  if (file < 0) return 0;
  char line[128];
  const int length = snprintf(line, sizeof line, "%s %ld %s\n", program, fails_at, call);
  const long written = syscall(SYS_write, file, line, length);
  syscall(SYS_close, file);
  return written == length;
}

#define REFUSED(call, number, answer) \
  if (is_it(call)) {                  \
    errno = (number);                 \
    return (answer);                  \
  }

int memfd_create(const char* name, unsigned flags) {
  REFUSED("memfd_create", ENOMEM, -1)
  return (int)syscall(SYS_memfd_create, name, flags);
}
void* mmap(void* at, size_t bytes, int protection, int flags, int file, off_t offset) {
  REFUSED("mmap", ENOMEM, (void*)-1)
  return (void*)syscall(SYS_mmap, at, bytes, protection, flags, file, offset);
}
int ftruncate(int file, off_t bytes) {
  REFUSED("ftruncate", ENOMEM, -1)
  return (int)syscall(SYS_ftruncate, file, bytes);
}
static int open_at(int folder, const char* path, int flags, mode_t mode) {
  REFUSED("open", EMFILE, -1)
  return (int)syscall(SYS_openat, folder, path, flags, mode);
}
int open(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0;
  va_end(more);
  return open_at(AT_FDCWD, path, flags, mode);
}
int open64(const char* path, int flags, ...) __attribute__((alias("open")));
FILE* fopen(const char* path, const char* mode) {
  REFUSED("fopen", EMFILE, NULL)
  FILE* (*next)(const char*, const char*) = (FILE * (*)(const char*, const char*)) dlsym(RTLD_NEXT, "fopen");
  return next(path, mode);
}
FILE* fopen64(const char* path, const char* mode) __attribute__((alias("fopen")));
int fcntl(int file, int command, ...) {
  va_list more;
  va_start(more, command);
  void* argument = va_arg(more, void*);
  va_end(more);
  if (command == F_DUPFD_CLOEXEC || command == F_DUPFD) REFUSED("dup", EMFILE, -1)
  if (command == F_ADD_SEALS) REFUSED("seals", EBUSY, -1)
  return (int)syscall(SYS_fcntl, file, command, argument);
}
int fcntl64(int file, int command, ...) __attribute__((alias("fcntl")));
int socket(int family, int type, int protocol) {
  REFUSED("socket", EMFILE, -1)
  return (int)syscall(SYS_socket, family, type, protocol);
}
int socketpair(int family, int type, int protocol, int ends[2]) {
  REFUSED("socketpair", EMFILE, -1)
  return (int)syscall(SYS_socketpair, family, type, protocol, ends);
}
int pipe2(int ends[2], int flags) {
  REFUSED("pipe2", EMFILE, -1)
  return (int)syscall(SYS_pipe2, ends, flags);
}
int eventfd(unsigned count, int flags) {
  REFUSED("eventfd", EMFILE, -1)
  return (int)syscall(SYS_eventfd2, count, flags);
}
int signalfd(int file, const sigset_t* set, int flags) {
  REFUSED("signalfd", EMFILE, -1)
  return (int)syscall(SYS_signalfd4, file, set, 8, flags);
}
int epoll_create1(int flags) {
  REFUSED("epoll_create1", EMFILE, -1)
  return (int)syscall(SYS_epoll_create1, flags);
}
int timerfd_create(int clock, int flags) {
  REFUSED("timerfd_create", EMFILE, -1)
  return (int)syscall(SYS_timerfd_create, clock, flags);
}
pid_t fork(void) {
  REFUSED("fork", EAGAIN, -1)
  pid_t (*next)(void) = (pid_t(*)(void))dlsym(RTLD_NEXT, "fork");
  return next();
}
typedef int create_thread(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*work)(void*), void* argument) {
  if (is_it("pthread_create")) return EAGAIN;
  create_thread* next = (create_thread*)dlsym(RTLD_NEXT, "pthread_create");
  return next(thread, attributes, work, argument);
}
#undef REFUSED
