/* SPDX-License-Identifier: Apache-2.0 */
/* The component pid_joint of the library, in C. twins_test.cc compares the two. */

#include "tests/components/finite_input.h"

enum { MOST_JOINTS = 10 };
typedef struct { double integral, filtered; } pidAxis_t;
typedef struct {
  pidAxis_t axis[MOST_JOINTS];
  int isStarted;
} t_pid_jointLocal_t;

PBO_PORTS(t_pid_joint,
  (in_var,   q_ref,   float64, "[ndof<=10]", "rad", PBO_FRAME("joint")),
  (in_var,   qd_ref,  float64, "[ndof<=10]", "rad/s", PBO_FRAME("joint")),
  (in_var,   q,       float64, "[ndof<=10]", "rad", PBO_FRAME("joint")),
  (in_var,   qd,      float64, "[ndof<=10]", "rad/s", PBO_FRAME("joint")),
  (in_var,   kp,      float64, "[ndof<=10]", "N.m/rad"),
  (in_var,   ki,      float64, "[ndof<=10]", "N.m/(rad.s)"),
  (in_var,   kd,      float64, "[ndof<=10]", "N.m.s/rad"),
  (out_var,  tau,     float64, "[ndof<=10]", "N.m", PBO_FRAME("joint"), PBO_INITIAL(float64, 0.0), PBO_SAFETY,
   PBO_RANGE(-200, 200)),
  (in_const, ndof,    int32,   "", "1", PBO_RANGE(1, 10)),
  (in_const, tau_max, float64, "[ndof<=10]", "N.m", PBO_RANGE(0, 200), PBO_FRAME("joint")),
  (in_const, is_continuous, bool, "[ndof<=10]", "1", PBO_INITIAL(bool, 0)),
  (in_const, filter_time, float64, "", "s", PBO_INITIAL(float64, 2e-3), PBO_RANGE(0, 1)))
PBO_MODULE(t_pid_joint, .doc = "Independent joint PID with anti-windup and filtered derivative.",
           .default_rate_hz = 1000, .source = "1994 paper, figure 4; Astrom and Hagglund 2006");

int t_pid_jointInit(t_pid_jointLocal_t *local) {
  SVAR_IN(tau_max);
  SVAR_IN(filter_time);
  for (uint32_t i = 0; i < SVAR_SIZE(tau_max); ++i)
    if (!(tau_max[i] >= 0 && tau_max[i] <= 200)) return PBO_FAULT("tau_max must be 0 to 200 N.m, the range of tau");
  return *filter_time >= 0 ? PBO_OK : PBO_FAULT("filter_time must be 0 s or more");
}

int t_pid_jointReinit(t_pid_jointLocal_t *local) { return t_pid_jointInit(local); }

static int judgeAll(t_pid_jointLocal_t *local) {
  const chimera_port* const ports[] = {PBO_PORT(q), PBO_PORT(qd), PBO_PORT(q_ref), PBO_PORT(qd_ref),
                                       PBO_PORT(kp), PBO_PORT(ki), PBO_PORT(kd)};
  static const char* const names[] = {"q", "qd", "q_ref", "qd_ref", "kp", "ki", "kd"};
  int found = PBO_OK;
  for (uint32_t i = 0; i < 7 && found == PBO_OK; ++i) found = judgeInput(PBO_CALL, ports[i], names[i]);
  return found;
}

/* As floor, which an image does not have. */
static double wholeBelow(double x) {
  if (!(__builtin_fabs(x) < 0x1p52)) return x;
  const double cut = (double)(int64_t)x;
  return __builtin_copysign(cut > x ? cut - 1 : cut, x);
}

static double errorOf(t_pid_jointLocal_t *local, uint32_t i) {
  static const double pi = 0x1.921fb54442d18p+1;
  SVAR_IN(q_ref);
  SVAR_IN(q);
  SVAR_IN(is_continuous);
  const double angle = q_ref[i] - q[i];
  return is_continuous[i] ? angle - 2 * pi * wholeBelow(angle / (2 * pi) + 0.5) : angle;
}

/* Continues from the last torque. Waits for an input that no task wrote or that is not finite. */
static void begin(t_pid_jointLocal_t *local) {
  SVAR_IN(qd_ref);
  SVAR_IN(qd);
  SVAR_IN(kp);
  SVAR_IN(kd);
  SVAR_OUT(tau);
  local->isStarted = judgeAll(local) == PBO_OK;
  PBO_CALL->fault->text[0] = '\0'; /* begin judges, but does not fail */
  for (uint32_t i = 0; local->isStarted && i < SVAR_SIZE(tau); ++i) {
    pidAxis_t* const axis = &local->axis[i];
    axis->filtered = qd_ref[i] - qd[i];
    axis->integral = tau[i] - kp[i] * errorOf(local, i) - kd[i] * (qd_ref[i] - qd[i]);
  }
}

static double step(t_pid_jointLocal_t *local, uint32_t i) {
  SVAR_IN(qd_ref);
  SVAR_IN(qd);
  SVAR_IN(kp);
  SVAR_IN(ki);
  SVAR_IN(kd);
  SVAR_IN(tau_max);
  SVAR_IN(filter_time);
  const double error = errorOf(local, i), rate = qd_ref[i] - qd[i], dt = PBO_DT;
  pidAxis_t* const axis = &local->axis[i];
  axis->filtered += (rate - axis->filtered) * dt / (*filter_time + dt);
  const double increment = ki[i] * error * dt;
  const double before = kp[i] * error + kd[i] * axis->filtered + axis->integral, wanted = before + increment;
  if (wanted > tau_max[i] && increment > 0) axis->integral += tau_max[i] - before < 0 ? 0 : tau_max[i] - before;
  else if (wanted < -tau_max[i] && increment < 0) axis->integral += 0 < -tau_max[i] - before ? 0 : -tau_max[i] - before;
  else axis->integral += increment;
  return clamp(wanted, -tau_max[i], tau_max[i]);
}

int t_pid_jointOn(t_pid_jointLocal_t *local) {
  SVAR_OUT(tau);
  const int isOutdated = SVAR_INHERITED(tau) >= 0 && !SVAR_HANDED_OVER(tau);
  for (uint32_t i = 0; i < SVAR_SIZE(tau); ++i)
    if (isOutdated || __builtin_isnan(tau[i])) tau[i] = 0;
  begin(local);
  return PBO_OK;
}

int t_pid_jointCycle(t_pid_jointLocal_t *local) {
  SVAR_OUT(tau);
  double torque[MOST_JOINTS];
  if (PBO_ILLEGAL) {
    begin(local);
    return PBO_OK;
  }
  const int inputs = judgeAll(local);
  if (inputs != PBO_OK) return inputs;
  if (!local->isStarted) begin(local);
  for (uint32_t i = 0; i < SVAR_SIZE(tau); ++i) torque[i] = step(local, i);
  for (uint32_t i = 0; i < SVAR_SIZE(tau) && local->isStarted; ++i) local->isStarted = __builtin_isfinite(torque[i]);
  if (!local->isStarted) return PBO_FAULT("the torque is not finite: the gains or the inputs are too large");
  for (uint32_t i = 0; i < SVAR_SIZE(tau); ++i) tau[i] = torque[i];
  return PBO_OK;
}

int t_pid_jointError(t_pid_jointLocal_t *local) {
  (void)local;
  return PBO_OK;
}
