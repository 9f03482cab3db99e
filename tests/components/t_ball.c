/* SPDX-License-Identifier: Apache-2.0 */
/* The C face: a trackball after the 2000 paper (figure 9), whose device is a resource and an in-var. */
#include <string.h>

#include "chimera/task/pbo.h"

typedef struct {
  double position[3];
  int32_t offs;
  int32_t backgrounds;
} t_ballLocal_t;

PBO_PORTS(t_ball,
  (resource,  device, text,    "",    "1", PBO_DOC("which ball; \"broken\" fails in init")),
  (in_const,  scale,  float64, "",    "m", PBO_INITIAL(float64, 0.5), PBO_RANGE(0, 10), PBO_DOC("a full turn")),
  (in_const,  reach,  float64, "",    "m", PBO_INITIAL(float64, 1e3), PBO_AT_LEAST("scale"), PBO_DOC("of xd")),
  (in_const,  mode,   text,    "",    "1", PBO_INITIAL(text, "free"), PBO_ONE_OF("free held")),
  (out_const, axes,   int32,   "",    "1"),
  (in_var,    turn,   float64, "[3]", "1/s", PBO_DOC("how fast it is turned; a negative third axis is a fault")),
  (out_var,   xd,     float64, "[3]", "m", PBO_INITIAL(float64, 0.0), PBO_FRAME("base")),
  (out_var,   start,  float64, "[3]", "m", PBO_INITIAL(float64, 1.0, 2.0, 3.0)),
  (out_var,   moving, bool,    "",    "1", PBO_INITIAL(bool, 0)),
  (out_var,   state,  text,    "",    "1", PBO_INITIAL(text, "idle")),
  (out_var,   force,  float32, "",    "N", PBO_INITIAL(float32, 0.0f), PBO_SAFETY, PBO_RANGE(-1, 1)))
PBO_MODULE(t_ball, .doc = "Trackball, written in C.", .default_rate_hz = 50,
           .source = "Stewart 2000, figure 9");

int t_ballInit(t_ballLocal_t *local) {
  SVAR_RESOURCE(device);
  SVAR_OUT(axes);
  if (strcmp(device, "broken") == 0) return PBO_FAULT("the ball does not answer");
  *axes = 3;
  return PBO_LOCAL(local);
}

int t_ballOn(t_ballLocal_t *local) {
  SVAR_OUT(xd);
  SVAR_OUT(state);
  memcpy(local->position, xd, sizeof local->position); /* go on from where the cursor is */
  if (SVAR_INHERITED(xd) >= 0) strcpy(*state, SVAR_HANDED_OVER(xd) ? "handed over" : "outdated");
  if (PBO_INCARNATION > 1) strcpy(*state, "restarted");
  return PBO_OK;
}

int t_ballCycle(t_ballLocal_t *local) {
  SVAR_IN(scale);
  SVAR_IN(reach);
  SVAR_IN(turn);
  SVAR_OUT(xd);
  SVAR_OUT(moving);
  SVAR_OUT(state);
  uint32_t i;
  if (turn[2] < 0) return PBO_FAULT("the third axis turns the wrong way");
  if (turn[0] > 100) return 17; /* no answer that a method may give */
  if (PBO_EXPIRED) return PBO_ABORTED;
  for (i = 0; i < SVAR_SIZE(xd); ++i) {
    const double next = local->position[i] + *scale * turn[i] * PBO_DT;
    xd[i] = local->position[i] = next > *reach ? *reach : next < -*reach ? -*reach : next;
  }
  *moving = turn[0] != 0 || turn[1] != 0 || turn[2] != 0;
  strcpy(*state, *moving ? "moving" : "idle");
  return PBO_OK;
}

int t_ballOff(t_ballLocal_t *local) {
  ++local->offs;
  return PBO_OK;
}

void t_ballBackground(t_ballLocal_t *local) { ++local->backgrounds; }

int t_ballTerm(t_ballLocal_t *local) {
  if (local->offs > 0) return PBO_OK;
  return local->backgrounds == 0 ? PBO_FAULT("killed without off") : PBO_FAULT("killed without off, after background");
}
