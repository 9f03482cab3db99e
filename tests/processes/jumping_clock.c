// SPDX-License-Identifier: Apache-2.0
// Preloaded into the processes of a subsystem: adds the nanoseconds in the file CHIMERA_WALL to the wall clock, as if a
// user had set it. CLOCK_MONOTONIC, which cannot be set, stays as it is.
#define _GNU_SOURCE
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

static const volatile int64_t* ahead;

__attribute__((constructor)) static void begin(void) {
  const char* path = getenv("CHIMERA_WALL");
  const int file = path == NULL ? -1 : open(path, O_RDONLY | O_CLOEXEC);
  if (file < 0) return;
  void* mapped = mmap(NULL, sizeof *ahead, PROT_READ, MAP_SHARED, file, 0);
  close(file);
  if (mapped != MAP_FAILED) ahead = mapped;
}

int clock_gettime(clockid_t clock, struct timespec* now) {
  const int failed = (int)syscall(SYS_clock_gettime, clock, now);
  const int is_wall = clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE;
  if (failed != 0 || !is_wall || ahead == NULL) return failed;
  const int64_t shown = now->tv_sec * INT64_C(1000000000) + now->tv_nsec + *ahead;
  now->tv_sec = shown / 1000000000;
  now->tv_nsec = shown % 1000000000;
  return 0;
}

int gettimeofday(struct timeval* restrict now, void* restrict zone) {
  (void)zone;
  struct timespec shown;
  if (clock_gettime(CLOCK_REALTIME, &shown) != 0) return -1;
  now->tv_sec = shown.tv_sec;
  now->tv_usec = shown.tv_nsec / 1000;
  return 0;
}

time_t time(time_t* to) {
  struct timespec shown;
  clock_gettime(CLOCK_REALTIME, &shown);
  if (to != NULL) *to = shown.tv_sec;
  return shown.tv_sec;
}
