/* SPDX-License-Identifier: Apache-2.0 */
/* Gives the model of a switch the next event of a recorded run. RECORDED_RUN names its file: a line "NAME WHO" for each
 * event, with the names of switch.pml. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char* const kNames[] = {"",          "prepared", "armed", "proposed", "agreed", "committed",
                                     "adopted", "over",     "aborted", "died",   "filed"};
enum { kMost = 250, kNumberOfNames = sizeof kNames / sizeof kNames[0] };
static int events[kMost], whose[kMost], n_events = -1;

static void refuse(const char* why) {
  fprintf(stderr, "recorded run: %s\n", why);
  exit(2);
}

static void load(void) {
  const char* path = getenv("RECORDED_RUN");
  FILE* file = path == NULL ? NULL : fopen(path, "r");
  char name[32];
  int who;
  if (file == NULL) refuse("cannot be read");
  for (n_events = 0; fscanf(file, "%31s %d", name, &who) == 2; ++n_events) {
    int known = 1;
    while (known < kNumberOfNames && strcmp(kNames[known], name) != 0) ++known;
    if (known == kNumberOfNames || n_events == kMost) refuse("an event that the model does not have, or too many");
    events[n_events] = known;
    whose[n_events] = who;
  }
  if (!feof(file) || n_events == 0) refuse("no list of events");
  fclose(file);
}

/* The run has that event at that place; event 0: it has no more events. */
int is_next(int at, int event, int who) {
  if (n_events < 0) load();
  if (at >= n_events) return event == 0;
  return events[at] == event && whose[at] == who;
}
