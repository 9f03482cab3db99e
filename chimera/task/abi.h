/* SPDX-License-Identifier: Apache-2.0 */
/* The binary contract between a component and the framework: plain C, versioned, checked at load.
 *
 * A component is a `chimera_component`: a declaration (ports, methods, sizes) and function pointers.
 * A shared object offers its components through `chimera_components`. Nobody writes this by hand: the C++
 * face (chimera/task/component.h) and the C face (chimera/task/pbo.h) make it.
 *
 * Who writes what: the declaration is constant after `declare`. The live half of a port (`chimera_port`)
 * lies in the component's state and is written by the framework only, between methods.
 */
#ifndef CHIMERA_TASK_ABI_H_
#define CHIMERA_TASK_ABI_H_

#include <stdint.h>

#include "chimera/table/slot_header.h"

#ifdef __cplusplus
extern "C" {
#endif

#define CHIMERA_ABI_VERSION 1u

/* Kinds of port (1994 paper 3.3; 2000 paper figure 2). Streams are reserved: declared, never bound yet. */
enum {
  CHIMERA_IN_VAR = 0,
  CHIMERA_OUT_VAR = 1,
  CHIMERA_IN_CONST = 2,
  CHIMERA_OUT_CONST = 3,
  CHIMERA_RESOURCE = 4,
  CHIMERA_IN_STREAM = 5,
  CHIMERA_OUT_STREAM = 6
};

/* Element types. CHIMERA_ANY is a type variable (named by type_name), solved by verification per task. */
enum {
  CHIMERA_BOOL = 0,    /* 1 byte, 0 or 1 */
  CHIMERA_INT32 = 1,
  CHIMERA_INT64 = 2,
  CHIMERA_FLOAT32 = 3,
  CHIMERA_FLOAT64 = 4,
  CHIMERA_STRING = 5,  /* element_size bytes, zero-terminated, zero-filled */
  CHIMERA_STRUCT = 6,  /* fields below */
  CHIMERA_ANY = 7
};

/* Methods, in the order of the paper's table. */
enum {
  CHIMERA_INIT = 0,
  CHIMERA_REINIT = 1,
  CHIMERA_ON = 2,
  CHIMERA_CYCLE = 3,
  CHIMERA_SYNC = 4,
  CHIMERA_OFF = 5,
  CHIMERA_KILL = 6,
  CHIMERA_ERROR = 7,
  CHIMERA_CLEAR = 8,
  CHIMERA_METHODS = 9
};

/* Signals. WAKEUP comes from the timer or the event source; sent to a task behind a server it is
   one event for it, and no other task can be sent it. */
enum {
  CHIMERA_SIGNAL_SPAWN = 0,
  CHIMERA_SIGNAL_ON = 1,
  CHIMERA_SIGNAL_OFF = 2,
  CHIMERA_SIGNAL_KILL = 3,
  CHIMERA_SIGNAL_CLEAR = 4,
  CHIMERA_SIGNAL_REINIT = 5,
  CHIMERA_SIGNAL_WAKEUP = 6,
  CHIMERA_SIGNALS = 7
};

/* What a method answers. */
enum {
  CHIMERA_OK = 0,      /* done; error(): recovered; clear(): the cause is gone; sync(): one event taken */
  CHIMERA_FAULT = 1,   /* failed; text in call->fault; error(): not recovered; clear(): still there */
  CHIMERA_NO_EVENT = 2,/* sync() only: nothing pending, no cycle follows */
  CHIMERA_ABORTED = 3, /* cycle() only: gave up in time, publishes nothing */
  CHIMERA_PARTIAL = 4, /* cycle() only: gave up in time, what it has put out is of use and is published */
  CHIMERA_NOT_YET = 5  /* on() only: the device is on its way and needs no other answer; the task stays OFF, publishes
                          nothing, and on() is asked again */
};

enum {
  CHIMERA_PORT_SAFETY = 1u << 0,      /* never publishes NaN, infinity, or a value outside [min, max] */
  CHIMERA_PORT_REPEATED = 1u << 1,    /* instances come from the description */
  CHIMERA_PORT_HAS_RANGE = 1u << 2,   /* min and max count */
  CHIMERA_PORT_CONFIGURATION = 1u << 4, /* in-const of text: what `request` takes, or empty */
  CHIMERA_PORT_SAFE_STATE = 1u << 5, /* out-var of bool: true while the device is in the state that the
                                        illegal-configuration flag asks for; resource: nothing of it ever moves */
  CHIMERA_PORT_SHARED = 1u << 6, /* resource: several tasks may have it open at one time */
  CHIMERA_PORT_HAS_INITIAL = 1u << 3  /* out-var: value at spawn; in-const: default when nobody produces it */
};

#define CHIMERA_MAX_PORTS 64u      /* ports of one component, every instance of a repeated one counted */
#define CHIMERA_MAX_EXTENTS 2u     /* dimensions of a shape */
#define CHIMERA_MAX_INSTANCES 16u  /* instances of one repeated port */
#define CHIMERA_FAULT_TEXT 160u
#define CHIMERA_SAFE_FRAMES 4u     /* of a task */
#define CHIMERA_SAFE_BYTES 256u    /* of a safe frame */

/* One field of a struct element. */
typedef struct chimera_field {
  const char* name;
  const char* unit; /* "1" for none */
  uint32_t type;    /* BOOL to STRING; no struct in a struct */
  uint32_t offset;  /* bytes from the start of the element */
  uint32_t count;   /* elements of a plain array, 1 for a scalar */
  uint32_t size;    /* bytes of one element */
} chimera_field;

/* A port as declared in code.
 * shape: "" scalar; "[6]" literal; "[ndof<=10]" an extent given by the constant port `ndof`, at most 10;
 *        "[n<=16]" where no constant port is called n: an extent variable, solved by verification;
 *        two dimensions as "[3][3]"; "[n...<=64]" a shape variable: any dimensions of at most 64 elements together.
 * unit:  UDUNITS-2 text with our unit file; the letters U, X, Y and Z, which are no units, are unit
 *        variables ("U", "U/s", "U.X"; V is the volt).
 */
typedef struct chimera_port_decl {
  const char* name;      /* a repeated port: without the '*' */
  const char* doc;       /* one sentence; may be "" */
  const char* unit;      /* "1" for none */
  const char* shape;
  const char* frame;     /* reference frame of the values; "" for none */
  const char* type_name; /* name of the struct, or of the type variable; "" otherwise */
  uint32_t kind;
  uint32_t type;
  uint32_t element_size;  /* bytes of one element; ANY: the largest, 8 */
  uint32_t flags;
  uint32_t max_instances; /* 1 unless repeated */
  uint32_t live_offset;   /* of the chimera_port (repeated: array of max_instances) in the state */
  uint32_t instances_offset; /* repeated: of the uint32_t with the number of instances in use, in the state */
  uint32_t n_fields;
  const chimera_field* fields;
  const void* initial;    /* initial_count elements; 1 means the same for every element */
  uint32_t initial_count;
  double min, max;        /* in the port's unit */
} chimera_port_decl;

/* What an out-var held when the present `on` began. Stands until the next one. */
typedef struct chimera_inherited {
  chimera_slot slot;  /* header of the publication that the value was taken from */
  int64_t age_ns;     /* of that publication when `on` began, 0 or more */
  int64_t period_ns;  /* of the task that published it; 0 for an aperiodic one */
} chimera_inherited;

/* The live half of a port. Written by the framework between methods, read by the component in them. */
typedef struct chimera_port {
  void* value;               /* the elements; resource: a zero-terminated text */
  const chimera_slot* slot;  /* in-var: of the group the value came from. Out-var: the first member of the
                                chimera_inherited of the present `on`; NULL before `on`, and when no task had published
                                the variable. NULL for constants and resources */
  const int64_t* now_ns;     /* release of the present job, for age */
  uint64_t seen;             /* sequence at this task's previous cycle: fresh = slot->sequence != seen */
  uint32_t bit;              /* of the value in slot->valid */
  uint32_t count;            /* elements in use = product of extents */
  uint32_t extent[CHIMERA_MAX_EXTENTS]; /* 1 where the shape has fewer dimensions */
  uint32_t type;             /* of the elements as solved: differs from the declaration for CHIMERA_ANY only */
  uint32_t element_size;     /* bytes of one element, as solved */
} chimera_port;

/* A text that somebody else keeps: `size` bytes, without a zero behind them. */
typedef struct chimera_text {
  const char* at;
  uint32_t size;
} chimera_text;

/* Where a method leaves the text of its fault. */
typedef struct chimera_fault {
  int32_t code; /* the component's own number, 0 if it has none */
  char text[CHIMERA_FAULT_TEXT];
} chimera_fault;

/* What a method may ask of the framework. All but safe_frame are wait-free and safe in the cycle context. */
typedef struct chimera_host {
  /* 1 when the job is past its deadline or was told to give up. */
  int32_t (*expired)(void* context);
  /* Sends `signal` to the task of that name (NULL: to itself). CHIMERA_OK, or CHIMERA_FAULT when there is
   * no such task or the outbox is full. Acted upon after the present method, at a cycle edge. */
  int32_t (*signal)(void* context, uint32_t signal, const char* task);
  /* Uses `ns` of execution time: computes in real time, is added to the modelled time in virtual time. */
  void (*spend)(void* context, int64_t ns);
  /* One line for whoever runs the application, at most CHIMERA_FAULT_TEXT - 1 bytes of it. Told once, as an event; the
   * last one of a method counts. */
  void (*note)(void* context, const char* text);
  /* What the port is joined to: the name of the variable or constant and the unit of its values, as verified; "" where
   * there is none. Good as long as the task. `port` lies in the component's state. */
  chimera_text (*variable)(void* context, const chimera_port* port);
  chimera_text (*unit)(void* context, const chimera_port* port);
  /* Asks for a switch to the configuration of that name, or of tasks ("--on A --off B"), as an operator would; the last
   * request of a method counts. CHIMERA_OK, or CHIMERA_FAULT when there is no such configuration or task, or nothing
   * can be switched in this run: told as a note, once for each task. Acted upon after the present method. */
  int32_t (*request)(void* context, const char* configuration);
  /* Safe frame `index` of this task is written to `descriptor`, of which a copy is kept, by another process, when this
   * one is dead; below 0: there is no such frame any more. Before it is written, output that waits in the queue of a
   * terminal is dropped, and the line rests for `pause_ns`. In init or clear; may block for a moment, the only one
   * here that does. CHIMERA_FAULT: nobody would write it (virtual time, one process), or there is no such index. */
  int32_t (*safe_frame)(void* context, uint32_t index, int32_t descriptor, int64_t pause_ns);
  /* What is written there: a copy of `size` bytes. It stands until the next one; 0 bytes take it back, and so do an
   * `off` and a `kill` that end well. From on on, in any method. CHIMERA_FAULT: no such index, or too many bytes. */
  int32_t (*safe_bytes)(void* context, uint32_t index, const void* bytes, uint32_t size);
} chimera_host;

/* Given to every method. */
typedef struct chimera_call {
  int64_t now_ns;      /* release of this job; outside cycles the time of the call */
  int64_t dt_ns;       /* release minus release of the last completed cycle; the period after on */
  int64_t deadline_ns;
  uint64_t cycle;      /* completed cycles since on */
  uint32_t dropped;    /* releases dropped since the last completed cycle */
  uint32_t illegal;    /* the illegal-configuration flag, read once per job */
  chimera_fault* fault;
  const chimera_host* host;
  void* context;       /* for the host's functions */
} chimera_call;

typedef int32_t (*chimera_method)(void* state, const chimera_call* call);

/* What may wait: files, sockets. Called about every 10 ms by a thread without real-time rights from the end of init
 * on, and once more before kill; beside the other methods, so what both sides touch crosses by atomics. Reads and
 * writes no port. CHIMERA_OK, or CHIMERA_FAULT with a text: then it is not called again. */
typedef int32_t (*chimera_background)(void* state, chimera_fault* fault);

/* Where the events of an aperiodic component come from: a descriptor that is readable while there is one, asked for
 * after init and good until kill; below 0: none. Behind a server the framework waits for it, and calls sync, which
 * takes one event from it and does not block, for as long as it is readable. Context: setup. */
typedef int32_t (*chimera_event_source)(void* state);

/* What holds between two in-consts of one type, unit and shape: no element of `lower` is above that of `upper`. The
 * checker holds written values against it; a value that another component tells is the business of init. */
typedef struct chimera_order {
  const char* lower;
  const char* upper;
} chimera_order;

/* The words that an in-const of text may be: separated by single spaces, each once. The checker holds written values
 * against them; a value that another component tells is the business of init. */
typedef struct chimera_choice {
  const char* port;
  const char* words;
} chimera_choice;

/* A component. Constant, lives as long as the shared object. */
typedef struct chimera_component {
  uint32_t abi_version; /* CHIMERA_ABI_VERSION */
  uint32_t struct_size; /* sizeof(chimera_component); an object that ends before `background`, `event_source`,
                           `n_orders`, `n_choices` or `host_size` has none, nor what comes behind it */
  const char* name;
  const char* doc;
  const char* source;   /* paper or book behind it; "" for none */
  double default_rate_hz; /* 0: the description must give one */
  uint32_t state_size;
  uint32_t state_align;
  uint32_t n_ports;
  const chimera_port_decl* ports;
  /* Makes a component in `state` (state_size zeroed bytes). CHIMERA_OK or CHIMERA_FAULT. Context: setup. */
  int32_t (*construct)(void* state, chimera_fault* fault);
  void (*destroy)(void* state);
  chimera_method methods[CHIMERA_METHODS]; /* NULL: not written */
  chimera_background background;           /* NULL: not written */
  chimera_event_source event_source;       /* NULL: not written */
  uint32_t n_orders;
  const chimera_order* orders;
  uint32_t n_choices;
  const chimera_choice* choices;
  uint32_t host_size; /* sizeof(chimera_host): the functions of the framework that it knows of */
} chimera_component;

/* The one symbol of a shared object. NULL when `abi_version` is not the one it was built with. */
typedef const chimera_component* const* (*chimera_components_fn)(uint32_t abi_version, uint32_t* count);
#define CHIMERA_COMPONENTS_SYMBOL "chimera_components"

/* An object has no thread_local variables but one of the framework, two words long of which this is the first: others
   may ask the heap when a thread first uses them. */
#define CHIMERA_THREAD_MARK UINT64_C(0x454e4f4441455254)

#ifdef __cplusplus
}
#endif
#endif /* CHIMERA_TASK_ABI_H_ */
