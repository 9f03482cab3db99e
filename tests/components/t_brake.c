/* SPDX-License-Identifier: Apache-2.0 */
/* A device in C that says when it is safe, and what is written to it when the process is dead. */
#define _POSIX_C_SOURCE 200809L
#include <fcntl.h>
#include <unistd.h>

#include "chimera/task/pbo.h"

typedef struct {
  int descriptor;
} t_brakeLocal_t;

PBO_PORTS(t_brake,
  (resource, log,    text, "", "1", PBO_SAFE_STATE, PBO_DOC("a word that moves nothing")),
  (resource, device, text, "", "1", PBO_DOC("the file that stands for the device")),
  (out_var,  braked, bool, "", "1", PBO_INITIAL(bool, 0), PBO_SAFE_STATE, PBO_DOC("the flag is up and it brakes")))
PBO_MODULE(t_brake, .doc = "Brakes.", .default_rate_hz = 100);

int t_brakeInit(t_brakeLocal_t *local) {
  SVAR_RESOURCE(device);
  local->descriptor = open(device, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0600);
  if (local->descriptor < 0) return PBO_FAULT("the device cannot be opened");
  PBO_SAFE_FRAME(1, local->descriptor, 2000);
  return PBO_OK;
}

int t_brakeOn(t_brakeLocal_t *local) {
  (void)local;
  return PBO_SAFE_BYTES(1, "brake", 5) == CHIMERA_OK ? PBO_OK : PBO_FAULT("the frame is too long");
}

int t_brakeCycle(t_brakeLocal_t *local) {
  SVAR_OUT(braked);
  (void)local;
  *braked = PBO_ILLEGAL != 0;
  return PBO_OK;
}

int t_brakeKill(t_brakeLocal_t *local) {
  PBO_SAFE_FRAME(1, -1, 0);
  close(local->descriptor);
  return PBO_OK;
}
