/* SPDX-License-Identifier: Apache-2.0 */
/* The C face: structs, repeated ports and type variables. */
#include "chimera/task/pbo.h"

PBO_STRUCT(Pose, (float64, position, "m", [3]), (float64, orientation, "1", [4]));
PBO_STRUCT(battery, (float64, voltage, "V"), (float64, cell, "V", [4]), (int32, charges, "1"), (bool, charging, "1"),
           (text, maker, "1"));

typedef struct { int32_t charges; } t_partsLocal_t;
PBO_PORTS(t_parts,
  (in_var,     pose,    Pose,    "", "1", PBO_FRAME("base")),
  (out_var,    power,   battery, "", "1", PBO_INITIAL(battery, {12.0, {3, 3, 3, 3}, 7, 0, "acme"})),
  (in_vars,    in,      float64, "[2]", "U"),
  (in_consts,  gain,    float64, "", "1", PBO_UP_TO(4), PBO_INITIAL(float64, 1.0)),
  (out_vars,   out,     float64, "", "U", PBO_UP_TO(4), PBO_INITIAL(float64, 0.0), PBO_DOC("gain * sum of in")),
  (out_consts, label,   text,    "", "1", PBO_UP_TO(2)),
  (in_var,     x,       any,     "[n<=16]", "X", PBO_TYPE("T")),
  (out_var,    y,       any,     "[n<=16]", "X", PBO_TYPE("T")),
  (in_var,     m,       float64, "[3][2]", "1", PBO_INITIAL(float64, 0.0)),
  (out_var,    sizes,   int32,   "[6]", "1", PBO_INITIAL(int32, 0)))
PBO_MODULE(t_parts, .doc = "Structs, repeated ports and type variables in C.", .default_rate_hz = 1000);

int t_partsInit(t_partsLocal_t *local) {
  if (SVAR_COUNT(label) > 0) __builtin_strcpy(*SVAR_OUT_AT(label, 0), "first");
  return PBO_LOCAL(local);
}

int t_partsCycle(t_partsLocal_t *local) {
  SVAR_IN(pose);
  SVAR_OUT(power);
  SVAR_IN(x);
  SVAR_OUT(y);
  SVAR_OUT(sizes);
  power->charges = ++local->charges;
  power->voltage = pose->position[2];
  for (uint32_t i = 0; i < SVAR_COUNT(out) && i < SVAR_COUNT(in); ++i) {
    const double* const pair = SVAR_IN_AT(in, i);
    *SVAR_OUT_AT(out, i) = *SVAR_IN_AT(gain, i) * (pair[0] + pair[1]);
  }
  __builtin_memcpy(y, x, SVAR_SIZE(x) * SVAR_ELEMENT_SIZE(x));
  sizes[0] = (int32_t)SVAR_COUNT(in);
  sizes[1] = (int32_t)SVAR_COUNT(out);
  sizes[2] = (int32_t)SVAR_ELEMENT_SIZE(x);
  sizes[3] = (int32_t)SVAR_TYPE(x);
  sizes[4] = (int32_t)SVAR_ROWS(m);
  sizes[5] = (int32_t)SVAR_COLUMNS(m);
  return pboFresh(PBO_PORT_AT(in, 0)) ? PBO_OK : PBO_FAULT("the first input is not fresh");
}
