/* SPDX-License-Identifier: Apache-2.0 */
/* The component limit of the library, in C. twins_test.cc compares the two. */
#include "tests/components/finite_input.h"

typedef struct { char unused; } t_limitLocal_t;
PBO_PORTS(t_limit,
  (in_var,   x,    float64, "[n...<=64]", "U", PBO_DOC("any signal")),
  (in_const, low,  float64, "[n...<=64]", "U", PBO_RANGE(-__builtin_inf(), __builtin_inf())),
  (in_const, high, float64, "[n...<=64]", "U", PBO_RANGE(-__builtin_inf(), __builtin_inf()), PBO_AT_LEAST("low")),
  (out_var,  y,    float64, "[n...<=64]", "U", PBO_DOC("x, cut at both limits")))
PBO_MODULE(t_limit, .doc = "Cuts a signal at its limits.");

int t_limitInit(t_limitLocal_t *local) {
  SVAR_IN(low);
  SVAR_IN(high);
  for (uint32_t i = 0; i < SVAR_SIZE(low); ++i)
    if (!(low[i] <= high[i])) return PBO_FAULT("low must be at most high");
  return PBO_OK;
}

int t_limitReinit(t_limitLocal_t *local) { return t_limitInit(local); }

int t_limitCycle(t_limitLocal_t *local) {
  SVAR_IN(x);
  SVAR_IN(low);
  SVAR_IN(high);
  SVAR_OUT(y);
  const int input = judgeInput(PBO_CALL, PBO_PORT(x), "x");
  if (input != PBO_OK) return input;
  for (uint32_t i = 0; i < SVAR_SIZE(y); ++i) y[i] = clamp(x[i], low[i], high[i]);
  return PBO_OK;
}

int t_limitOn(t_limitLocal_t *local) {
  SVAR_IN(x);
  for (uint32_t i = 0; i < SVAR_SIZE(x); ++i)
    if (!__builtin_isfinite(x[i])) return PBO_OK;
  return t_limitCycle(local);
}

int t_limitError(t_limitLocal_t *local) {
  (void)local;
  return PBO_OK;
}
