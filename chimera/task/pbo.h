/* SPDX-License-Identifier: Apache-2.0 */
/* For components in C99, in the style of the papers (2000 paper, figures 7 to 9). docs/howto/write-a-component.md.
 *
 *   #include "chimera/task/pbo.h"
 *
 *   typedef struct { double last[3]; } tballLocal_t;
 *   PBO_PORTS(tball,
 *     (in_const, scale, float64, "",    "m", PBO_INITIAL(float64, 1.0)),
 *     (in_var,   move,  float64, "[3]", "1"),
 *     (out_var,  xd,    float64, "[3]", "m", PBO_DOC("where to go")))
 *   PBO_MODULE(tball, .doc = "Trackball.", .default_rate_hz = 50);
 *
 *   int tballCycle(tballLocal_t *local) {
 *     SVAR_IN(scale); SVAR_IN(move); SVAR_OUT(xd);
 *     for (int i = 0; i < 3; i++) xd[i] += *scale * move[i] * PBO_DT;
 *     return PBO_OK;
 *   }
 *
 * One module per source file. Methods: tballInit Reinit On Cycle Sync Off Kill Error Clear, each int f(tballLocal_t*);
 * only Cycle is mandatory; Term is another name of Kill. PBO_MODULE declares them all, so a method of another type
 * does not compile. A function that is neither static nor one of these methods breaks the build.
 * They return PBO_OK, PBO_FAULT("text"), On also PBO_NOT_YET, Sync also PBO_NO_EVENT, Cycle also PBO_ABORTED and
 * PBO_PARTIAL; anything else is a fault.
 *
 * With Sync the component is aperiodic: one cycle for each event. An event is a ring of the doorbell of its task
 * (PBO_RING("task") in another task). With int tballEventSource(tballLocal_t*), an event is also that the returned
 * descriptor is readable (below 0: none). It is called after Init and must use nothing of this header.
 *
 * The framework allocates the local state and zeroes it. The papers' Init returns it as (int)local, which does not
 * survive 64 bits: write `return PBO_LOCAL(local);`, which says ok unless local is NULL.
 *
 * Port: (kind, name, type, shape, unit, options...). Kinds: in_var out_var in_const out_const resource.
 * Types: bool int32 int64 float32 float64 text (64 bytes). Repeated ports, structs and type variables: in C++ only.
 */
#ifndef CHIMERA_TASK_PBO_H_
#define CHIMERA_TASK_PBO_H_

#ifdef __cplusplus
#error "pbo.h is the C face of a component; a C++ source includes chimera/task/component.h"
#endif

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "chimera/task/abi.h"
#include "chimera/task/handover.h"
#include "chimera/task/pbo_each.h"
#include "chimera/task/registry.h"

enum { PBO_OK = CHIMERA_OK, PBO_ERROR = CHIMERA_FAULT, PBO_NO_EVENT = CHIMERA_NO_EVENT, PBO_ABORTED = CHIMERA_ABORTED,
       PBO_PARTIAL = CHIMERA_PARTIAL, PBO_NOT_YET = CHIMERA_NOT_YET };

/* For `return (int)local` of the papers. */
#define PBO_LOCAL(local) ((local) != NULL ? PBO_OK : PBO_ERROR)

typedef char pboText_t[64];

/* A port as written in PBO_PORTS. */
typedef struct pboPort_t {
  const char* name;
  const char* shape;
  const char* unit;
  const char* doc;
  const char* frame;
  uint32_t kind;
  uint32_t type;
  uint32_t size;
  uint32_t offset;
  const void* initial;
  uint32_t initial_bytes;
  const char* at_least;
  const char* one_of;
  double min, max;
  int has_range;
  int safety;
  int configuration;
  int safe_state;
  int shared;
  int intermittent;
} pboPort_t;

/* Options of a port. */
#define PBO_DOC(text) .doc = text
#define PBO_FRAME(text) .frame = text
#define PBO_RANGE(low, high) .has_range = 1, .min = low, .max = high
#define PBO_SAFETY .safety = 1
#define PBO_AT_LEAST(lower) .at_least = lower /* in_const of numbers: no element is below that of in_const `lower` */
#define PBO_ONE_OF(words) .one_of = words /* in_const of text: "the legal words", with spaces between them */
#define PBO_CONFIGURATION .configuration = 1 /* in_const of text: a configuration, tasks (--on a --off b), or empty */
#define PBO_SAFE_STATE .safe_state = 1 /* out_var of bool: the device obeys the flag; resource: it never moves */
#define PBO_SHARED .shared = 1 /* resource: several tasks may open it together */
#define PBO_INTERMITTENT .intermittent = 1 /* in_var: a configuration may lack a producer */
#define PBO_INITIAL(type, ...) \
  .initial = (const PBO_TYPE_##type[]){__VA_ARGS__}, .initial_bytes = sizeof((const PBO_TYPE_##type[]){__VA_ARGS__})

#define PBO_TYPE_bool uint8_t
#define PBO_TYPE__Bool uint8_t /* `bool` where <stdbool.h> is included */
#define PBO_TYPE_int32 int32_t
#define PBO_TYPE_int64 int64_t
#define PBO_TYPE_float32 float
#define PBO_TYPE_float64 double
#define PBO_TYPE_text pboText_t
#define PBO_CODE_bool CHIMERA_BOOL
#define PBO_CODE__Bool CHIMERA_BOOL
#define PBO_CODE_int32 CHIMERA_INT32
#define PBO_CODE_int64 CHIMERA_INT64
#define PBO_CODE_float32 CHIMERA_FLOAT32
#define PBO_CODE_float64 CHIMERA_FLOAT64
#define PBO_CODE_text CHIMERA_STRING
#define PBO_KIND_in_var CHIMERA_IN_VAR
#define PBO_KIND_out_var CHIMERA_OUT_VAR
#define PBO_KIND_in_const CHIMERA_IN_CONST
#define PBO_KIND_out_const CHIMERA_OUT_CONST
#define PBO_KIND_resource CHIMERA_RESOURCE

/* The type that SVAR_IN and SVAR_OUT find by the name of the port. Only one of the two exists, so that a write to an
 * input does not compile. */
#define PBO_SIDE_in_var(name, type) typedef const type pbo_in_##name;
#define PBO_SIDE_in_const(name, type) typedef const type pbo_in_##name;
#define PBO_SIDE_out_var(name, type) typedef type pbo_out_##name;
#define PBO_SIDE_out_const(name, type) typedef type pbo_out_##name;
#define PBO_SIDE_resource(name, type) typedef const char pbo_resource_##name;

#define PBO_UNWRAP(...) __VA_ARGS__
#define PBO_MEMBER(m, x) PBO_MEMBER_(m, PBO_UNWRAP x)
#define PBO_MEMBER_(...) PBO_MEMBER__(__VA_ARGS__)
#define PBO_MEMBER__(m, kind, name, type, shape, ...) chimera_port name;
#define PBO_SIDE(m, x) PBO_SIDE_(m, PBO_UNWRAP x)
#define PBO_SIDE_(...) PBO_SIDE__(__VA_ARGS__)
#define PBO_SIDE__(m, kind, name, type, shape, ...)                                              \
  PBO_SIDE_##kind(name, PBO_TYPE_##type)                                                         \
  enum { pbo_back_##name = (int)(offsetof(m##State_t, local) - offsetof(m##State_t, ports.name)) };
#define PBO_ROW(m, x) PBO_ROW_(m, PBO_UNWRAP x)
#define PBO_ROW_(...) PBO_ROW__(__VA_ARGS__)
#define PBO_ROW__(m, port_kind, port_name, port_type, port_shape, ...)                                        \
  {.name = #port_name, .shape = port_shape, .kind = PBO_KIND_##port_kind, .type = PBO_CODE_##port_type,       \
   .size = sizeof(PBO_TYPE_##port_type), .offset = offsetof(m##State_t, ports.port_name), .unit = __VA_ARGS__},

/* The ports of module m, whose local state m##Local_t is defined before. */
#define PBO_PORTS(m, ...)                                            \
  typedef struct { PBO_EACH(PBO_MEMBER, m, __VA_ARGS__) } m##Ports_t; \
  typedef struct {                                                   \
    m##Ports_t ports;                                                \
    const chimera_call* call;                                        \
    m##Local_t local;                                                \
  } m##State_t;                                                      \
  PBO_EACH(PBO_SIDE, m, __VA_ARGS__)                                 \
  enum { pbo_back_to_call = (int)(offsetof(m##State_t, local) - offsetof(m##State_t, call)) }; \
  static const pboPort_t m##PortList[] = {PBO_EACH(PBO_ROW, m, __VA_ARGS__)};

/* Inside a method: the values of a port. `local` is the method's argument. */
#define PBO_PORT(name) ((const chimera_port*)(const void*)((const char*)local - pbo_back_##name))
#define SVAR_IN(name) pbo_in_##name* const name = (pbo_in_##name*)PBO_PORT(name)->value
#define SVAR_OUT(name) pbo_out_##name* const name = (pbo_out_##name*)PBO_PORT(name)->value
#define SVAR_RESOURCE(name) pbo_resource_##name* const name = (pbo_resource_##name*)PBO_PORT(name)->value
#define SVAR_SIZE(name) (PBO_PORT(name)->count) /* elements in use */
#define SVAR_VALID(name) pboValid(PBO_PORT(name)) /* in-var: a task wrote it, or it has an initial value */
#define SVAR_FRESH(name) pboFresh(PBO_PORT(name)) /* in-var: published since the previous cycle */
#define SVAR_AGE(name) pboAge(PBO_PORT(name))     /* in-var: ns since it was published; -1 while not valid */
/* out-var: age in ns of its value when the present `on` began; -1: no task had published it */
#define SVAR_INHERITED(name) pboInherited(PBO_PORT(name))
#define SVAR_HANDED_OVER(name) chimera_is_handed_over(PBO_PORT(name)) /* out-var: continue from it (handover.h) */

/* Inside a method: the present call. */
#define PBO_CALL (*(const chimera_call* const*)(const void*)((const char*)local - pbo_back_to_call))
#define PBO_DT ((double)PBO_CALL->dt_ns * 1e-9) /* s since the last completed cycle */
#define PBO_NOW (PBO_CALL->now_ns)              /* ns, release of this job */
#define PBO_DROPPED (PBO_CALL->dropped)         /* releases dropped since the last completed cycle */
#define PBO_NOTE(text) PBO_CALL->host->note(PBO_CALL->context, text) /* one line for the user */
#define PBO_ILLEGAL (PBO_CALL->illegal)         /* the illegal-configuration flag */
#define PBO_EXPIRED (PBO_CALL->host->expired(PBO_CALL->context))
#define PBO_SIGNAL(which, task) (PBO_CALL->host->signal(PBO_CALL->context, which, task))
#define PBO_RING(task) PBO_SIGNAL(CHIMERA_SIGNAL_WAKEUP, task) /* one event for a task behind a server */
#define PBO_SAFE_FRAME(index, descriptor, pause_ns) /* written if this process dies; CHIMERA_OK or not */             \
  (PBO_CALL->host->safe_frame(PBO_CALL->context, index, descriptor, pause_ns))
#define PBO_CONFIGURATION_IN_FORCE (PBO_CALL->host->configuration(PBO_CALL->context)) /* a chimera_text */
#define PBO_SAFE_BYTES(index, bytes, size) (PBO_CALL->host->safe_bytes(PBO_CALL->context, index, bytes, size))
#define PBO_REQUEST(name) (PBO_CALL->host->request(PBO_CALL->context, name)) /* a configuration; CHIMERA_OK or not */
#define PBO_SPEND(ns) (PBO_CALL->host->spend(PBO_CALL->context, ns))
/* Stores the text of a fault and returns PBO_ERROR: return PBO_FAULT("the device does not answer"); */
#define PBO_FAULT(message) pboFault(PBO_CALL, message)

static inline int pboValid(const chimera_port* port) {
  return port->slot != NULL && ((port->slot->valid >> port->bit) & 1u) != 0;
}
static inline int pboFresh(const chimera_port* port) {
  return port->slot != NULL && port->slot->sequence != port->seen;
}
static inline int64_t pboAge(const chimera_port* port) {
  return pboValid(port) ? *port->now_ns - port->slot->published_ns : -1;
}
static inline int64_t pboInherited(const chimera_port* port) {
  const chimera_inherited* const from = chimera_inherited_of(port);
  return from == NULL ? -1 : from->age_ns;
}

static inline int pboFault(const chimera_call* call, const char* text) {
  strncpy(call->fault->text, text, CHIMERA_FAULT_TEXT - 1);
  call->fault->text[CHIMERA_FAULT_TEXT - 1] = '\0';
  return PBO_ERROR;
}

/* Checks that `method` may return `status`; an unknown status is a fault. */
static inline int32_t pboJudge(uint32_t method, int status, const chimera_call* call) {
  if (status == PBO_OK) return status;
  if (status == PBO_NO_EVENT && method == CHIMERA_SYNC) return status;
  if (status == PBO_NOT_YET && method == CHIMERA_ON) return status;
  if ((status == PBO_ABORTED || status == PBO_PARTIAL) && method == CHIMERA_CYCLE) return status;
  call->fault->code = status;
  if (call->fault->text[0] == '\0') pboFault(call, "the method returned neither PBO_OK nor a fault with a text");
  return CHIMERA_FAULT;
}

static inline void pboDeclarePort(chimera_port_decl* to, const pboPort_t* from) {
  memset(to, 0, sizeof *to);
  to->name = from->name;
  to->shape = from->shape;
  to->unit = from->unit;
  to->doc = from->doc == NULL ? "" : from->doc;
  to->frame = from->frame == NULL ? "" : from->frame;
  to->type_name = "";
  to->kind = from->kind;
  to->type = from->type;
  to->element_size = from->size;
  to->max_instances = 1;
  to->live_offset = from->offset;
  to->initial = from->initial;
  to->initial_count = from->initial_bytes / from->size;
  to->min = from->min;
  to->max = from->max;
  to->flags = (from->safety ? (uint32_t)CHIMERA_PORT_SAFETY : 0u) |
              (from->configuration ? (uint32_t)CHIMERA_PORT_CONFIGURATION : 0u) |
              (from->safe_state ? (uint32_t)CHIMERA_PORT_SAFE_STATE : 0u) |
              (from->shared ? (uint32_t)CHIMERA_PORT_SHARED : 0u) |
              (from->intermittent ? (uint32_t)CHIMERA_PORT_INTERMITTENT : 0u) |
              (from->has_range ? (uint32_t)CHIMERA_PORT_HAS_RANGE : 0u) |
              (from->initial != NULL ? (uint32_t)CHIMERA_PORT_HAS_INITIAL : 0u);
}

static inline int32_t pboConstruct(void* state, chimera_fault* fault) {
  (void)state; /* zeroed by the framework */
  (void)fault;
  return CHIMERA_OK;
}
static inline void pboDestroy(void* state) { (void)state; }

#define PBO_RUN(m, Name, METHOD)                                                          \
  static int32_t m##Run##Name(void* state, const chimera_call* call) {                    \
    m##State_t* const s = (m##State_t*)state;                                             \
    s->call = call;                                                                       \
    return pboJudge(METHOD, m##Name(&s->local), call);                                    \
  }
/* Weak: without a definition its address is NULL, and the method is absent. */
#define PBO_OPTIONAL(m, Name, METHOD)                                     \
  int m##Name(m##Local_t* local) __attribute__((weak, visibility("hidden"))); \
  PBO_RUN(m, Name, METHOD)
#define PBO_BACKGROUND(m)                                                                   \
  void m##Background(m##Local_t* local) __attribute__((weak, visibility("hidden")));        \
  static int32_t m##RunBackground(void* state, chimera_fault* fault) {                      \
    (void)fault;                                                                            \
    m##Background(&((m##State_t*)state)->local);                                            \
    return CHIMERA_OK;                                                                      \
  }
#define PBO_EVENT_SOURCE(m)                                                                 \
  int m##EventSource(m##Local_t* local) __attribute__((weak, visibility("hidden")));        \
  static int32_t m##RunEventSource(void* state) { return m##EventSource(&((m##State_t*)state)->local); }
#define PBO_TAKE(m, Name, METHOD) \
  if (m##Name != NULL) m##Component.methods[METHOD] = m##Run##Name;

/* Declares the methods of module m and offers it: PBO_MODULE(m, .doc = "...", .default_rate_hz = 50). */
#define PBO_MODULE(...) PBO_MODULE_(__VA_ARGS__, .struct_size = sizeof(chimera_component))
#define PBO_MODULE_(m, ...)                                                                         \
  int m##Cycle(m##Local_t* local) __attribute__((visibility("hidden")));                            \
  PBO_RUN(m, Cycle, CHIMERA_CYCLE)                                                                  \
  PBO_OPTIONAL(m, Init, CHIMERA_INIT)                                                               \
  PBO_OPTIONAL(m, Reinit, CHIMERA_REINIT)                                                           \
  PBO_OPTIONAL(m, On, CHIMERA_ON)                                                                   \
  PBO_OPTIONAL(m, Sync, CHIMERA_SYNC)                                                               \
  PBO_OPTIONAL(m, Off, CHIMERA_OFF)                                                                 \
  PBO_OPTIONAL(m, Term, CHIMERA_KILL)                                                               \
  PBO_OPTIONAL(m, Kill, CHIMERA_KILL)                                                               \
  PBO_OPTIONAL(m, Error, CHIMERA_ERROR)                                                             \
  PBO_OPTIONAL(m, Clear, CHIMERA_CLEAR)                                                             \
  PBO_BACKGROUND(m)                                                                                 \
  PBO_EVENT_SOURCE(m)                                                                               \
  static chimera_port_decl m##Declared[sizeof m##PortList / sizeof m##PortList[0]];                 \
  static chimera_order m##Orders[sizeof m##PortList / sizeof m##PortList[0]];                       \
  static chimera_choice m##Choices[sizeof m##PortList / sizeof m##PortList[0]];                     \
  static chimera_component m##Component = {.name = #m, __VA_ARGS__};                                \
  static const chimera_component* m##Declare(void) {                                                \
    uint32_t i;                                                                                     \
    if (m##Component.abi_version != 0) return &m##Component;                                        \
    m##Component.abi_version = CHIMERA_ABI_VERSION;                                                 \
    m##Component.host_size = sizeof(chimera_host);                                                  \
    if (m##Component.doc == NULL) m##Component.doc = "";                                            \
    if (m##Component.source == NULL) m##Component.source = "";                                      \
    m##Component.state_size = sizeof(m##State_t);                                                   \
    m##Component.state_align = __alignof__(m##State_t);                                             \
    m##Component.n_ports = sizeof m##PortList / sizeof m##PortList[0];                              \
    for (i = 0; i < m##Component.n_ports; ++i) pboDeclarePort(&m##Declared[i], &m##PortList[i]);    \
    m##Component.ports = m##Declared;                                                               \
    for (i = 0; i < m##Component.n_ports; ++i) {                                                    \
      if (m##PortList[i].at_least != NULL)                                                          \
        m##Orders[m##Component.n_orders++] = (chimera_order){m##PortList[i].at_least, m##PortList[i].name}; \
      if (m##PortList[i].one_of != NULL)                                                            \
        m##Choices[m##Component.n_choices++] = (chimera_choice){m##PortList[i].name, m##PortList[i].one_of}; \
    }                                                                                               \
    m##Component.orders = m##Orders;                                                                \
    m##Component.choices = m##Choices;                                                              \
    m##Component.construct = pboConstruct;                                                          \
    m##Component.destroy = pboDestroy;                                                              \
    m##Component.methods[CHIMERA_CYCLE] = m##RunCycle;                                              \
    PBO_TAKE(m, Init, CHIMERA_INIT)                                                                 \
    PBO_TAKE(m, Reinit, CHIMERA_REINIT)                                                             \
    PBO_TAKE(m, On, CHIMERA_ON)                                                                     \
    PBO_TAKE(m, Sync, CHIMERA_SYNC)                                                                 \
    PBO_TAKE(m, Off, CHIMERA_OFF)                                                                   \
    PBO_TAKE(m, Term, CHIMERA_KILL)                                                                 \
    PBO_TAKE(m, Kill, CHIMERA_KILL)                                                                 \
    PBO_TAKE(m, Error, CHIMERA_ERROR)                                                               \
    PBO_TAKE(m, Clear, CHIMERA_CLEAR)                                                               \
    if (m##Background != NULL) m##Component.background = m##RunBackground;                          \
    if (m##EventSource != NULL) m##Component.event_source = m##RunEventSource;                      \
    return &m##Component;                                                                           \
  }                                                                                                 \
  __attribute__((constructor)) static void m##Offer(void) { (void)chimera_offer(m##Declare); }      \
  typedef int m##Module_t

#endif /* CHIMERA_TASK_PBO_H_ */
