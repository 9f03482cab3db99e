/* SPDX-License-Identifier: Apache-2.0 */
/* Events in C. They come from the named pipe of its resource port, or from its doorbell for "none". Each rings the
 * doorbell of another task, or requests a configuration. */
#define _POSIX_C_SOURCE 200809L
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

#include "chimera/task/pbo.h"

typedef struct {
  int descriptor;
} t_relayLocal_t;

PBO_PORTS(t_relay,
  (resource, pipe,   text,  "", "1", PBO_DOC("a named pipe, or none")),
  (in_const, target, text,  "", "1", PBO_INITIAL(text, ""), PBO_DOC("the task whose doorbell is rung; empty: none")),
  (in_const, set,    text,  "", "1", PBO_INITIAL(text, ""), PBO_DOC("the configuration asked for; empty: none")),
  (out_var,  passed, int64, "", "1", PBO_INITIAL(int64, 0), PBO_DOC("events so far")))
PBO_MODULE(t_relay, .doc = "Passes events on.", .default_rate_hz = 100);

int t_relayInit(t_relayLocal_t *local) {
  SVAR_RESOURCE(pipe);
  local->descriptor = -1;
  if (strcmp(pipe, "none") == 0) return PBO_OK;
  local->descriptor = open(pipe, O_RDWR | O_NONBLOCK | O_CLOEXEC); /* for writing too: then it has no end */
  return local->descriptor >= 0 ? PBO_OK : PBO_FAULT("the pipe cannot be opened");
}

int t_relayEventSource(t_relayLocal_t *local) { return local->descriptor; }

int t_relaySync(t_relayLocal_t *local) {
  char byte;
  if (local->descriptor < 0) return PBO_OK; /* the caller of sync has the event */
  return read(local->descriptor, &byte, 1) == 1 ? PBO_OK : PBO_NO_EVENT;
}

int t_relayCycle(t_relayLocal_t *local) {
  SVAR_IN(target);
  SVAR_IN(set);
  SVAR_OUT(passed);
  ++*passed;
  if (PBO_EXPIRED) return PBO_PARTIAL; /* counted, and not passed on */
  if ((*target)[0] != '\0' && PBO_RING(*target) != PBO_OK) return PBO_FAULT("the target is no task behind a server");
  if ((*set)[0] != '\0' && PBO_REQUEST(*set) != CHIMERA_OK) return PBO_FAULT("the configuration cannot be had");
  return PBO_OK;
}

int t_relayKill(t_relayLocal_t *local) {
  if (local->descriptor >= 0) close(local->descriptor);
  return PBO_OK;
}
