/* SPDX-License-Identifier: Apache-2.0 */
/* For components in C11, in the style of the papers (2000 paper, figures 7 to 9). docs/howto/component-in-c.md.
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
 * The framework allocates the local state and zeroes it. If PBO_PAPER is defined before this header is included, Init
 * returns (int)local as in the papers: 0 is a failure, all other numbers mean ok.
 *
 * Port: (kind, name, type, shape, unit, options...). Kinds: in_var out_var in_const out_const resource, and repeated
 * in_vars out_vars in_consts out_consts. Types: bool int32 int64 float32 float64 text (64 bytes), any (with PBO_TYPE),
 * and structs that PBO_STRUCT declares.
 *
 * All tables are constant. With CHIMERA_BARE they are not registered by a constructor: a table of the system names
 * chimera_component_tball. The compiler needs the attributes and __typeof__ that gcc and clang share, and no C library.
 */
#ifndef CHIMERA_TASK_PBO_H_
#define CHIMERA_TASK_PBO_H_

#ifdef __cplusplus
#error "pbo.h is the C face of a component; a C++ source includes chimera/task/component.h"
#endif

#include <stddef.h>
#include <stdint.h>

#include "chimera/task/abi.h"
#include "chimera/task/handover.h"
#include "chimera/task/pbo_each.h"
#ifndef CHIMERA_BARE
#include "chimera/task/registry.h"
#endif
#ifdef PBO_PAPER
#pragma GCC diagnostic ignored "-Wpointer-to-int-cast"
#endif

enum { PBO_OK = CHIMERA_OK, PBO_ERROR = CHIMERA_FAULT, PBO_NO_EVENT = CHIMERA_NO_EVENT, PBO_ABORTED = CHIMERA_ABORTED,
       PBO_PARTIAL = CHIMERA_PARTIAL, PBO_NOT_YET = CHIMERA_NOT_YET };

/* For Init without PBO_PAPER: ok unless `local` is NULL. */
#define PBO_LOCAL(local) ((local) != NULL ? PBO_OK : PBO_ERROR)

typedef char pboText_t[64];

/* Options of a port: (tag, flags, argument, members of chimera_port_decl). */
#define PBO_DOC(text) (doc, 0u, text, )
#define PBO_FRAME(text) (frame, 0u, text, )
#define PBO_RANGE(low, high) (range, CHIMERA_PORT_HAS_RANGE, , .min = (low), .max = (high), )
#define PBO_SAFETY (safety, CHIMERA_PORT_SAFETY, , )
/* in_const of numbers: no element is below that of in_const `lower` */
#define PBO_AT_LEAST(lower) (at_least, 0u, lower, )
#define PBO_ONE_OF(words) (one_of, 0u, words, ) /* in_const of text: "the legal words", with spaces between them */
/* in_const of text: a configuration, tasks (--on a --off b), or empty */
#define PBO_CONFIGURATION (configuration, CHIMERA_PORT_CONFIGURATION, , )
/* out_var of bool: the device obeys the flag; resource: it never moves */
#define PBO_SAFE_STATE (safe_state, CHIMERA_PORT_SAFE_STATE, , )
#define PBO_SHARED (shared, CHIMERA_PORT_SHARED, , ) /* resource: several tasks may open it together */
#define PBO_INTERMITTENT (intermittent, CHIMERA_PORT_INTERMITTENT, , ) /* in_var: a configuration may lack a producer */
#define PBO_TYPE(variable) (type, 0u, variable, ) /* any: ports with the same type variable have the same type */
#define PBO_UP_TO(instances) (up_to, 0u, instances, ) /* repeated port: 16 without this option */
#define PBO_INITIAL(type, ...)                                                              \
  (initial, CHIMERA_PORT_HAS_INITIAL, type, .initial = (const pbo_c_##type[]){__VA_ARGS__}, \
   .initial_count = sizeof((const pbo_c_##type[]){__VA_ARGS__}) / sizeof(pbo_c_##type), )

/* True if an array was declared with its size, false if `extern const char array[];` is all there is. Both compile, so
 * that a static assertion can explain what is missing. */
#define PBO_DECLARED(array) _Generic(&array, const char (*)[1]: 0, default: 1)
#define PBO_MUST(n, condition, sentence) _Static_assert(condition, #n ": " sentence);

/* A type is known by five names: pbo_c_T, pbo_code_T, pbo_known_T, pbo_fields_T and pbo_n_fields_T. */
#define PBO_BUILT_IN(type, c, code)                         \
  typedef c pbo_c_##type;                                   \
  enum { pbo_code_##type = code, pbo_n_fields_##type = 0 }; \
  extern const char pbo_known_##type[2];                    \
  extern const chimera_field pbo_fields_##type[1] /* nowhere defined, because no expression reads it */
PBO_BUILT_IN(bool, uint8_t, CHIMERA_BOOL);
PBO_BUILT_IN(_Bool, uint8_t, CHIMERA_BOOL); /* `bool` where <stdbool.h> is included */
PBO_BUILT_IN(int32, int32_t, CHIMERA_INT32);
PBO_BUILT_IN(int64, int64_t, CHIMERA_INT64);
PBO_BUILT_IN(float32, float, CHIMERA_FLOAT32);
PBO_BUILT_IN(float64, double, CHIMERA_FLOAT64);
PBO_BUILT_IN(text, pboText_t, CHIMERA_STRING);
PBO_BUILT_IN(any, unsigned char, CHIMERA_ANY);
#define PBO_CODE(t) ((int)pbo_code_##t)
#define PBO_KNOWN_TYPE(n, t)                                                                                           \
  extern const char pbo_known_##t[];                                                                                   \
  PBO_MUST(n, PBO_DECLARED(pbo_known_##t), #t " is no type of a port; the types are bool int32 int64 float32 float64 " \
           "text any, and structs that PBO_STRUCT declares before")

/* A struct that ports carry: PBO_STRUCT(battery, (float64, voltage, "V"), (float64, cell, "V", [4])) makes a C struct
 * `battery` and the type `battery` of ports. */
#define PBO_STRUCT(s, ...)                                                                                     \
  PBO_EACH(PBO_CHECK_MEMBER, s, __VA_ARGS__)                                                                   \
  typedef struct s { PBO_EACH(PBO_DECLARE_MEMBER, s, __VA_ARGS__) } s;                                         \
  typedef s pbo_c_##s;                                                                                         \
  extern const char pbo_known_##s[2];                                                                          \
  static const chimera_field pbo_fields_##s[] __attribute__((unused)) = {PBO_EACH(PBO_FIELD, s, __VA_ARGS__)}; \
  enum { pbo_code_##s = CHIMERA_STRUCT, pbo_n_fields_##s = sizeof pbo_fields_##s / sizeof pbo_fields_##s[0] }
#define PBO_CHECK_MEMBER(s, t, n, ...)       \
  PBO_KNOWN_TYPE(n, t)                       \
  PBO_MUST(n, PBO_CODE(t) <= CHIMERA_STRING, \
           "a member of a struct is a number, a bool or a text, or a list of these")
#define PBO_DECLARE_MEMBER(s, t, n, u, dimensions, ...) pbo_c_##t n dimensions;
#define PBO_FIELD(s, t, n, u, ...) \
  {#n, u, pbo_code_##t, offsetof(s, n), sizeof(((s*)0)->n) / sizeof(pbo_c_##t), sizeof(pbo_c_##t)},

/* A kind of port: its code, the side on which SVAR_ macros find it, 1 if it is repeated. */
#define PBO_KIND_in_var ~, CHIMERA_IN_VAR, in, 0
#define PBO_KIND_out_var ~, CHIMERA_OUT_VAR, out, 0
#define PBO_KIND_in_const ~, CHIMERA_IN_CONST, in, 0
#define PBO_KIND_out_const ~, CHIMERA_OUT_CONST, out, 0
#define PBO_KIND_resource ~, CHIMERA_RESOURCE, resource, 0
#define PBO_KIND_in_vars ~, CHIMERA_IN_VAR, ins, 1
#define PBO_KIND_out_vars ~, CHIMERA_OUT_VAR, outs, 1
#define PBO_KIND_in_consts ~, CHIMERA_IN_CONST, ins, 1
#define PBO_KIND_out_consts ~, CHIMERA_OUT_CONST, outs, 1
enum { pbo_no_kind = 99 };
#define PBO_KIND(k) ((int)PBO_2(PBO_KIND_##k, pbo_no_kind))
#define PBO_SIDE(k) PBO_3(PBO_KIND_##k, ~, none)
#define PBO_MANY(k) PBO_4(PBO_KIND_##k, ~, ~, 0)

/* The argument of the option `tag`, nothing for other options. */
#define PBO_NOTHING(n, arg)
#define PBO_ITSELF(n, arg) arg
#define PBO_ADDED(n, arg) +(arg)
#define PBO_PAIR(n, arg) {arg, #n},
#define PBO_PAIR_BEHIND(n, arg) {#n, arg},
#define PBO_DOC_doc ~, PBO_ITSELF
#define PBO_FRAME_frame ~, PBO_ITSELF
#define PBO_TYPE_type ~, PBO_ITSELF
#define PBO_UP_TO_up_to ~, PBO_ADDED
#define PBO_ORDER_at_least ~, PBO_PAIR
#define PBO_CHOICE_one_of ~, PBO_PAIR_BEHIND
#define PBO_GET_DOC(k, n, t, tag, flags, arg, ...) PBO_2(PBO_DOC_##tag, PBO_NOTHING)(n, arg)
#define PBO_GET_FRAME(k, n, t, tag, flags, arg, ...) PBO_2(PBO_FRAME_##tag, PBO_NOTHING)(n, arg)
#define PBO_GET_TYPE(k, n, t, tag, flags, arg, ...) PBO_2(PBO_TYPE_##tag, PBO_NOTHING)(n, arg)
#define PBO_GET_UP_TO(k, n, t, tag, flags, arg, ...) PBO_2(PBO_UP_TO_##tag, PBO_NOTHING)(n, arg)
#define PBO_GET_ORDER(k, n, t, tag, flags, arg, ...) PBO_2(PBO_ORDER_##tag, PBO_NOTHING)(n, arg)
#define PBO_GET_CHOICE(k, n, t, tag, flags, arg, ...) PBO_2(PBO_CHOICE_##tag, PBO_NOTHING)(n, arg)
#define PBO_GET_FLAGS(k, n, t, tag, flags, ...) | flags
#define PBO_GET_MEMBERS(k, n, t, tag, flags, arg, ...) __VA_ARGS__

/* What each option requires of its port, with the sentences of the C++ interface. */
#define PBO_CHECK_OPTION(k, n, t, tag, flags, arg, ...) PBO_CHECK_##tag(PBO_KIND(k), PBO_MANY(k), n, t, arg)
#define PBO_CHECK_doc(k, many, n, t, arg)
#define PBO_CHECK_frame(k, many, n, t, arg)
#define PBO_CHECK_range(k, many, n, t, arg) PBO_MUST(n, k != CHIMERA_RESOURCE, "a resource has no range")
#define PBO_CHECK_safety(k, many, n, t, arg) \
  PBO_MUST(n, k == CHIMERA_OUT_VAR, "safety goes with an out-var: it guards what is published")
#define PBO_CHECK_at_least(k, many, n, t, arg) \
  PBO_MUST(n, k == CHIMERA_IN_CONST,           \
           "at_least goes with an in-const, and names another: it is checked before anything runs")
#define PBO_CHECK_one_of(k, many, n, t, arg)                                                                     \
  PBO_MUST(n, k == CHIMERA_IN_CONST, "one_of goes with an in-const of text: it is checked before anything runs") \
  PBO_MUST(n, PBO_CODE(t) == CHIMERA_STRING, "one_of goes with text: numbers have a range")
#define PBO_CHECK_configuration(k, many, n, t, arg)                                           \
  PBO_MUST(n, k == CHIMERA_IN_CONST,                                                          \
           "configuration goes with an in-const of text: it is checked before anything runs") \
  PBO_MUST(n, PBO_CODE(t) == CHIMERA_STRING, "configuration goes with text: a configuration has a name")
#define PBO_CHECK_safe_state(k, many, n, t, arg)                                              \
  PBO_MUST(n, k == CHIMERA_RESOURCE || (k == CHIMERA_OUT_VAR && PBO_CODE(t) == CHIMERA_BOOL), \
           "safe_state goes with an out-var of bool, or with a resource that never moves")
#define PBO_CHECK_shared(k, many, n, t, arg) \
  PBO_MUST(n, k == CHIMERA_RESOURCE, "shared goes with a resource that several tasks may have open at one time")
#define PBO_CHECK_intermittent(k, many, n, t, arg) \
  PBO_MUST(n, k == CHIMERA_IN_VAR, "intermittent goes with an in-var that some configurations do not produce")
#define PBO_CHECK_type(k, many, n, t, arg) \
  PBO_MUST(n, PBO_CODE(t) == CHIMERA_ANY, "PBO_TYPE goes with the type any: it names the type variable")
#define PBO_CHECK_up_to(k, many, n, t, arg)                                                       \
  PBO_MUST(n, many, "PBO_UP_TO goes with a repeated port: in_vars out_vars in_consts out_consts") \
  PBO_MUST(n, (arg) >= 1 && (arg) <= CHIMERA_MAX_INSTANCES, "a repeated port has 1 to 16 instances")
#define PBO_CHECK_initial(k, many, n, t, arg)                                                                \
  PBO_MUST(n, k <= CHIMERA_IN_CONST,                                                                         \
           "initial goes with an out-var (its value at spawn), or with an in-const or in-var (its default)") \
  PBO_MUST(n, PBO_CODE(t) != CHIMERA_ANY, "a port of any type has no initial value: none fits all types")    \
  PBO_MUST(n, _Generic((pbo_c_##arg*)0, pbo_c_##t*: 1, default: 0), "initial must be of the type of the port, " #t)

/* Each of these makes one part of PBO_PORTS from a port. */
#define PBO_CHECK(m, k, n, t, s, u, ...)                                                                             \
  PBO_KNOWN_TYPE(n, t)                                                                                               \
  PBO_MUST(n, PBO_KIND(k) != pbo_no_kind, #k " is no kind of port; the kinds are in_var out_var in_const out_const " \
           "resource, and repeated in_vars out_vars in_consts out_consts")                                           \
  PBO_MUST(n, PBO_KIND(k) != CHIMERA_RESOURCE || PBO_CODE(t) == CHIMERA_STRING, "a resource has the type text")      \
  PBO_MUST(n, PBO_CODE(t) != CHIMERA_ANY || sizeof("" PBO_OPTIONS(PBO_GET_TYPE, k, n, t, __VA_ARGS__)) > 1,          \
           "the type any needs the name of a type variable: PBO_TYPE(\"T\")")                                        \
  PBO_OPTIONS(PBO_CHECK_OPTION, k, n, t, __VA_ARGS__)                                                                \
  enum { pbo_up_to_##n = 0 PBO_OPTIONS(PBO_GET_UP_TO, k, n, t, __VA_ARGS__),                                         \
         pbo_most_##n = !PBO_MANY(k) ? 1 : pbo_up_to_##n != 0 ? pbo_up_to_##n : (int)CHIMERA_MAX_INSTANCES };
#define PBO_LIVE(m, k, n, ...) PBO_JOIN(PBO_LIVE_, PBO_MANY(k))(n)
#define PBO_LIVE_0(n) chimera_port n;
#define PBO_LIVE_1(n) chimera_port n[pbo_most_##n]; uint32_t pbo_count_##n;
#define PBO_PLACE(m, k, n, t, ...)                        \
  PBO_SEEN(PBO_SIDE(k), n, t)                             \
  enum { pbo_at_##n = (int)offsetof(struct m##Head, n) }; \
  PBO_JOIN(PBO_PLACE_, PBO_MANY(k))(m, n)
#define PBO_PLACE_0(m, n)
#define PBO_PLACE_1(m, n) enum { pbo_count_at_##n = (int)offsetof(struct m##Head, pbo_count_##n) };
/* The type that SVAR_ macros find by the name of the port. Only the one of its side exists, so that a write to an input
 * does not compile. */
#define PBO_SEEN(...) PBO_SEEN_(__VA_ARGS__)
#define PBO_SEEN_(side, n, t) typedef PBO_CONST_##side pbo_c_##t pbo_##side##_##n;
#define PBO_CONST_in const
#define PBO_CONST_ins const
#define PBO_CONST_resource const
#define PBO_CONST_out
#define PBO_CONST_outs
#define PBO_CONST_none
#define PBO_ROW(m, k, n, t, s, u, ...)                                                                             \
  {.name = #n, .doc = "" PBO_OPTIONS(PBO_GET_DOC, k, n, t, __VA_ARGS__), .unit = u, .shape = s,                    \
   .frame = "" PBO_OPTIONS(PBO_GET_FRAME, k, n, t, __VA_ARGS__),                                                   \
   .type_name = PBO_CODE(t) == CHIMERA_STRUCT ? #t : "" PBO_OPTIONS(PBO_GET_TYPE, k, n, t, __VA_ARGS__),           \
   .kind = PBO_KIND(k), .type = pbo_code_##t,                                                                      \
   .element_size = PBO_CODE(t) == CHIMERA_ANY ? 8 : sizeof(pbo_c_##t),                                             \
   .flags = (PBO_MANY(k) ? (uint32_t)CHIMERA_PORT_REPEATED : 0u) PBO_OPTIONS(PBO_GET_FLAGS, k, n, t, __VA_ARGS__), \
   .max_instances = pbo_most_##n, .live_offset = offsetof(struct m##Head, n),                                      \
   .instances_offset = PBO_JOIN(PBO_COUNT_AT_, PBO_MANY(k))(n), .n_fields = pbo_n_fields_##t,                      \
   .fields = PBO_CODE(t) == CHIMERA_STRUCT ? pbo_fields_##t : NULL,                                                \
   PBO_OPTIONS(PBO_GET_MEMBERS, k, n, t, __VA_ARGS__)},
#define PBO_COUNT_AT_0(n) 0
#define PBO_COUNT_AT_1(n) pbo_count_at_##n
#define PBO_ORDERS(m, k, n, t, s, u, ...) PBO_OPTIONS(PBO_GET_ORDER, k, n, t, __VA_ARGS__)
#define PBO_CHOICES(m, k, n, t, s, u, ...) PBO_OPTIONS(PBO_GET_CHOICE, k, n, t, __VA_ARGS__)

/* The ports of module m, before PBO_MODULE. The last order and the last choice are empty. */
#define PBO_PORTS(m, ...)                                                                         \
  PBO_EACH(PBO_CHECK, m, __VA_ARGS__)                                                             \
  struct m##Head { const chimera_call* pbo_call; PBO_EACH(PBO_LIVE, m, __VA_ARGS__) };            \
  PBO_EACH(PBO_PLACE, m, __VA_ARGS__)                                                             \
  static const chimera_port_decl m##Ports[] = {PBO_EACH(PBO_ROW, m, __VA_ARGS__)};                \
  static const chimera_order m##Orders[] = {PBO_EACH(PBO_ORDERS, m, __VA_ARGS__){NULL, NULL}};    \
  static const chimera_choice m##Choices[] = {PBO_EACH(PBO_CHOICES, m, __VA_ARGS__){NULL, NULL}}; \
  extern const char pbo_ports_of_##m[1 + sizeof m##Ports / sizeof m##Ports[0]];
struct pboNoPorts { const chimera_call* pbo_call; };
/* `with` if PBO_PORTS was there for module m, else `without`. */
#define PBO_IF_PORTS(m, with, without) _Generic(&pbo_ports_of_##m, const char (*)[1]: without, default: with)
#define PBO_LENGTH(m, type, array) (sizeof(*PBO_IF_PORTS(m, &array, (const type(*)[1])0)) / sizeof(type) - 1)

/* Inside a method: the values of a port. `local` is the method's argument. */
#define PBO_PORT_AT(name, i) ((const chimera_port*)(const void*)((const char*)local - pbo_back + pbo_at_##name) + (i))
#define PBO_PORT(name) PBO_PORT_AT(name, 0)
#define SVAR_IN(name) pbo_in_##name* const name = (pbo_in_##name*)PBO_PORT(name)->value
#define SVAR_OUT(name) pbo_out_##name* const name = (pbo_out_##name*)PBO_PORT(name)->value
#define SVAR_RESOURCE(name) const char* const name = (const char*)(pbo_resource_##name*)PBO_PORT(name)->value
#define SVAR_SIZE(name) (PBO_PORT(name)->count) /* elements in use */
#define SVAR_ROWS(name) (PBO_PORT(name)->extent[0])
#define SVAR_COLUMNS(name) (PBO_PORT(name)->extent[1])
#define SVAR_TYPE(name) (PBO_PORT(name)->type)                 /* any: CHIMERA_BOOL to CHIMERA_STRUCT, as linked */
#define SVAR_ELEMENT_SIZE(name) (PBO_PORT(name)->element_size) /* any: bytes of one element, as linked */
/* Repeated port: instances in use, fixed at init, and the values of instance i, which is below SVAR_COUNT(name). The
 * functions pboValid, pboFresh, pboAge and pboInherited take PBO_PORT_AT(name, i). */
#define SVAR_COUNT(name) (*(const uint32_t*)(const void*)((const char*)local - pbo_back + pbo_count_at_##name))
#define SVAR_IN_AT(name, i) ((pbo_ins_##name*)PBO_PORT_AT(name, i)->value)
#define SVAR_OUT_AT(name, i) ((pbo_outs_##name*)PBO_PORT_AT(name, i)->value)
#define SVAR_VALID(name) pboValid(PBO_PORT(name)) /* in-var: a task wrote it, or it has an initial value */
#define SVAR_FRESH(name) pboFresh(PBO_PORT(name)) /* in-var: published since the previous cycle */
#define SVAR_AGE(name) pboAge(PBO_PORT(name))     /* in-var: ns since it was published; -1 while not valid */
/* out-var: age in ns of its value when the present `on` began; -1: no task had published it */
#define SVAR_INHERITED(name) pboInherited(PBO_PORT(name))
#define SVAR_HANDED_OVER(name) chimera_is_handed_over(PBO_PORT(name)) /* out-var: continue from it (handover.h) */

/* Inside a method: the present call. */
#define PBO_CALL (*(const chimera_call* const*)(const void*)((const char*)local - pbo_back))
#define PBO_DT ((double)PBO_CALL->dt_ns * 1e-9) /* s since the last completed cycle */
#define PBO_NOW (PBO_CALL->now_ns)              /* ns, release of this job */
#define PBO_DROPPED (PBO_CALL->dropped)         /* releases dropped since the last completed cycle */
#define PBO_NOTE(text) PBO_CALL->host->note(PBO_CALL->context, text) /* one line for the user */
#define PBO_ILLEGAL (PBO_CALL->illegal)         /* the illegal-configuration flag */
#define PBO_EXPIRED (PBO_CALL->host->expired(PBO_CALL->context))
#define PBO_SIGNAL(which, task) (PBO_CALL->host->signal(PBO_CALL->context, which, task))
#define PBO_RING(task) PBO_SIGNAL(CHIMERA_SIGNAL_WAKEUP, task) /* one event for a task that events release */
#define PBO_SAFE_FRAME(index, descriptor, pause_ns) /* written if this process dies; CHIMERA_OK or not */ \
  (PBO_CALL->host->safe_frame(PBO_CALL->context, index, descriptor, pause_ns))
#define PBO_CONFIGURATION_IN_FORCE (PBO_CALL->host->configuration(PBO_CALL->context)) /* a chimera_text */
#define PBO_INCARNATION (PBO_CALL->host->incarnation(PBO_CALL->context)) /* starts of this process; from 1 */
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
  uint32_t i = 0;
  for (; i < CHIMERA_FAULT_TEXT - 1 && text[i] != '\0'; ++i) call->fault->text[i] = text[i];
  call->fault->text[i] = '\0';
  return PBO_ERROR;
}

/* Checks that `method` may return `status`; an unknown status is a fault. */
static inline int32_t pboJudge(uint32_t method, int status, const void* local, const chimera_call* call) {
#ifdef PBO_PAPER
  /* Init returned (int)local, which may be 0 for a 64-bit address. A fault with a text stays one. */
  if (method == CHIMERA_INIT && call->fault->text[0] == '\0') {
    if (status != 0 || status == (int)(intptr_t)local) return PBO_OK;
    return pboFault(call, "Init returned 0, which says that it failed");
  }
#endif
  (void)local;
  if (status == PBO_OK) return status;
  if (status == PBO_NO_EVENT && method == CHIMERA_SYNC) return status;
  if (status == PBO_NOT_YET && method == CHIMERA_ON) return status;
  if ((status == PBO_ABORTED || status == PBO_PARTIAL) && method == CHIMERA_CYCLE) return status;
  if (status != PBO_ERROR) call->fault->code = status;
  if (call->fault->text[0] == '\0') pboFault(call, "the method returned neither PBO_OK nor a fault with a text");
  return CHIMERA_FAULT;
}

static inline int32_t pboConstruct(void* state, chimera_fault* fault) {
  (void)state; /* zeroed by the framework */
  (void)fault;
  return CHIMERA_OK;
}
static inline void pboDestroy(void* state) { (void)state; }

#define PBO_RUN(m, Name, METHOD)                                       \
  static int32_t m##Run##Name(void* state, const chimera_call* call) { \
    m##State_t* const s = (m##State_t*)state;                          \
    s->head.pbo_call = call;                                           \
    return pboJudge(METHOD, m##Name(&s->local), &s->local, call);      \
  }
/* Weak: without a definition its address is NULL, and `missing` is the answer. */
#define PBO_WEAK __attribute__((weak, visibility("hidden")))
#define PBO_OPTIONAL(m, Name, METHOD, missing)                                                \
  PBO_WEAK int m##Name(m##Local_t* local);                                                    \
  static int32_t m##Run##Name(void* state, const chimera_call* call) {                        \
    m##State_t* const s = (m##State_t*)state;                                                 \
    s->head.pbo_call = call;                                                                  \
    return m##Name == NULL ? missing : pboJudge(METHOD, m##Name(&s->local), &s->local, call); \
  }
#define PBO_METHODS(do, m)                           \
  do(m, Init, CHIMERA_INIT, CHIMERA_OK)              \
  do(m, Reinit, CHIMERA_REINIT, CHIMERA_OK)          \
  do(m, On, CHIMERA_ON, CHIMERA_OK)                  \
  do(m, Sync, CHIMERA_SYNC, CHIMERA_OK)              \
  do(m, Off, CHIMERA_OFF, CHIMERA_OK)                \
  do(m, Kill, CHIMERA_KILL, m##RunTerm(state, call)) \
  do(m, Error, CHIMERA_ERROR, CHIMERA_FAULT)         \
  do(m, Clear, CHIMERA_CLEAR, CHIMERA_OK)
#define PBO_ENTRY(m, Name, METHOD, missing) [METHOD] = m##Run##Name,
#define PBO_BESIDE(m)                                                                  \
  PBO_WEAK void m##Background(m##Local_t* local);                                      \
  PBO_WEAK int m##EventSource(m##Local_t* local);                                      \
  static int32_t m##RunBackground(void* state, chimera_fault* fault) {                 \
    (void)fault;                                                                       \
    if (m##Background != NULL) m##Background(&((m##State_t*)state)->local);            \
    return CHIMERA_OK;                                                                 \
  }                                                                                    \
  static int32_t m##RunEventSource(void* state) {                                      \
    return m##EventSource == NULL ? -1 : m##EventSource(&((m##State_t*)state)->local); \
  }

/* Declares the methods of module m and offers it: PBO_MODULE(m, .doc = "...", .default_rate_hz = 50). */
#define PBO_MODULE(...) PBO_MODULE_(__VA_ARGS__, .struct_size = sizeof(chimera_component))
#define PBO_MODULE_(m, ...)                                                               \
  extern const char pbo_ports_of_##m[];                                                   \
  extern const chimera_port_decl m##Ports[];                                              \
  extern const chimera_order m##Orders[];                                                 \
  extern const chimera_choice m##Choices[];                                               \
  typedef struct {                                                                        \
    __typeof__(*PBO_IF_PORTS(m, (struct m##Head*)0, (struct pboNoPorts*)0)) head;         \
    m##Local_t local;                                                                     \
  } m##State_t;                                                                           \
  enum { pbo_back = (int)offsetof(m##State_t, local) };                                   \
  int m##Cycle(m##Local_t* local) __attribute__((visibility("hidden")));                  \
  PBO_RUN(m, Cycle, CHIMERA_CYCLE)                                                        \
  PBO_OPTIONAL(m, Term, CHIMERA_KILL, CHIMERA_OK)                                         \
  PBO_METHODS(PBO_OPTIONAL, m)                                                            \
  PBO_BESIDE(m)                                                                           \
  __attribute__((visibility("hidden"))) const chimera_component chimera_component_##m = { \
      .abi_version = CHIMERA_ABI_VERSION,                                                 \
      .name = #m,                                                                         \
      .state_size = sizeof(m##State_t),                                                   \
      .state_align = __alignof__(m##State_t),                                             \
      .n_ports = PBO_LENGTH(m, char, pbo_ports_of_##m),                                   \
      .ports = PBO_IF_PORTS(m, m##Ports, NULL),                                           \
      .construct = pboConstruct,                                                          \
      .destroy = pboDestroy,                                                              \
      .methods = {[CHIMERA_CYCLE] = m##RunCycle, PBO_METHODS(PBO_ENTRY, m)},              \
      .background = m##RunBackground,                                                     \
      .event_source = m##RunEventSource,                                                  \
      .n_orders = PBO_LENGTH(m, chimera_order, m##Orders),                                \
      .orders = PBO_IF_PORTS(m, m##Orders, NULL),                                         \
      .n_choices = PBO_LENGTH(m, chimera_choice, m##Choices),                             \
      .choices = PBO_IF_PORTS(m, m##Choices, NULL),                                       \
      .host_size = sizeof(chimera_host),                                                  \
      __VA_ARGS__};                                                                       \
  PBO_OFFER(m)                                                                            \
  typedef int m##Module_t

#ifdef CHIMERA_BARE
#define PBO_OFFER(m)
#else
/* Offers a copy of the table in which the methods are absent that the source does not define. */
#define PBO_LEAVE_OUT(m, Name, METHOD, missing) \
  if (m##Name == NULL) made.methods[METHOD] = NULL;
#define PBO_OFFER(m)                                                                 \
  static const chimera_component* m##Declare(void) {                                 \
    static chimera_component made;                                                   \
    if (made.abi_version != 0) return &made;                                         \
    made = chimera_component_##m;                                                    \
    if (made.doc == NULL) made.doc = "";                                             \
    if (made.source == NULL) made.source = "";                                       \
    PBO_METHODS(PBO_LEAVE_OUT, m)                                                    \
    if (m##Kill == NULL && m##Term != NULL) made.methods[CHIMERA_KILL] = m##RunTerm; \
    if (m##Background == NULL) made.background = NULL;                               \
    if (m##EventSource == NULL) made.event_source = NULL;                            \
    return &made;                                                                    \
  }                                                                                  \
  __attribute__((constructor)) static void m##Offer(void) { (void)chimera_offer(m##Declare); }
#endif

#endif /* CHIMERA_TASK_PBO_H_ */
