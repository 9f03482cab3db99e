/* SPDX-License-Identifier: Apache-2.0 */
/* The binary contract between a component and the framework: plain C, versioned, checked at load.
 *
 * A component is a `chimera_component`: a declaration (ports, methods, sizes) and function pointers.
 * A shared object offers its components through `chimera_components`. The C++ interface
 * (chimera/task/component.h) and the C interface (chimera/task/pbo.h) generate all of this.
 *
 * The declaration is constant after `declare`. The live half of a port (`chimera_port`) lies in the state of the
 * component. Only the framework writes it, between methods.
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

/* Signals. WAKEUP comes from the timer or the event source. Sent by a task, it is one event for its target, which must
 * be behind a server or, in the executive, have an event source. */
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

/* The status that a method returns. */
enum {
  CHIMERA_OK = 0,      /* done; error(): recovered; clear(): the cause is gone; sync(): one event taken */
  CHIMERA_FAULT = 1,   /* failed; text in call->fault; error(): not recovered; clear(): still there */
  CHIMERA_NO_EVENT = 2,/* sync() only: nothing pending, no cycle follows */
  CHIMERA_ABORTED = 3, /* cycle() only: gave up in time, publishes nothing */
  CHIMERA_PARTIAL = 4, /* cycle() only: gave up in time, its outputs are useful and are published */
  CHIMERA_NOT_YET = 5  /* on() only: the device is on its way; the task stays OFF, publishes nothing, and the
                          framework calls on() again */
};

enum {
  CHIMERA_PORT_SAFETY = 1u << 0,      /* never publishes NaN, infinity, or a value outside [min, max] */
  CHIMERA_PORT_REPEATED = 1u << 1,    /* instances come from the description */
  CHIMERA_PORT_HAS_RANGE = 1u << 2,   /* min and max count */
  CHIMERA_PORT_CONFIGURATION = 1u << 4, /* in-const of text: an argument of `request`, or empty */
  CHIMERA_PORT_SAFE_STATE = 1u << 5, /* out-var of bool: true while the device is in the state that the
                                        illegal-configuration flag requests; resource: no part of it ever moves */
  CHIMERA_PORT_SHARED = 1u << 6, /* resource: several tasks may open it together */
  CHIMERA_PORT_INTERMITTENT = 1u << 7, /* in-var: a configuration may lack a producer; the last value stands */
  CHIMERA_PORT_HAS_INITIAL = 1u << 3  /* out-var: value at spawn; in-const, in-var: default */
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
 * unit:  UDUNITS-2 text with the unit file of the framework; the letters U, X, Y and Z, which are no units, are unit
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

/* The value of an out-var when the present `on` began. It stays until the next `on`. */
typedef struct chimera_inherited {
  chimera_slot slot;  /* header of the publication with the value */
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

/* A text that the framework owns: `size` bytes, without a closing zero. */
typedef struct chimera_text {
  const char* at;
  uint32_t size;
} chimera_text;

/* The fault of a method. */
typedef struct chimera_fault {
  int32_t code; /* a number that the component defines, 0 if it has none */
  char text[CHIMERA_FAULT_TEXT];
} chimera_fault;

/* The functions of the framework for methods. All but safe_frame are wait-free and safe in the cycle context. */
typedef struct chimera_host {
  /* 1 if the job is past its deadline or must give up. */
  int32_t (*expired)(void* context);
  /* Sends `signal` to the task of that name (NULL: to itself). CHIMERA_OK, or CHIMERA_FAULT if the
   * task does not exist or the outbox is full. It acts after the present method, at a cycle boundary. */
  int32_t (*signal)(void* context, uint32_t signal, const char* task);
  /* Uses `ns` of execution time: computes in real time; in virtual time, adds it to the modelled time. */
  void (*spend)(void* context, int64_t ns);
  /* Shows the user one line, at most CHIMERA_FAULT_TEXT - 1 bytes of it, once, as an event. The last one of a method
   * counts. */
  void (*note)(void* context, const char* text);
  /* The variable or constant that the port is linked to, and the verified unit of its values; "" if there is none.
   * Valid as long as the task. `port` lies in the state of the component. */
  chimera_text (*variable)(void* context, const chimera_port* port);
  chimera_text (*unit)(void* context, const chimera_port* port);
  /* Requests a switch to the configuration of that name, or of tasks ("--on A --off B"), as an operator would. The last
   * request of a method counts; it acts after the method. CHIMERA_OK, or CHIMERA_FAULT if the name is unknown, or if
   * the run cannot switch: a note says so, once for each task. */
  int32_t (*request)(void* context, const char* configuration);
  /* Registers safe frame `index` of this task: another process writes it to a copy of `descriptor` if this process
   * dies. A `descriptor` below 0 removes the frame. Before the write, waiting output in the queue of a terminal is
   * dropped, and the line rests for `pause_ns`. Only for init and clear, because it may block for a moment.
   * CHIMERA_FAULT: no process would write it (virtual time, one process), or the index does not exist. */
  int32_t (*safe_frame)(void* context, uint32_t index, int32_t descriptor, int64_t pause_ns);
  /* Sets the bytes of safe frame `index`: a copy of `size` bytes, which stays until the next call. 0 bytes remove it; a
   * successful `off` or `kill` also removes it. From on onwards, in any method. CHIMERA_FAULT: the index does not
   * exist, or too many bytes. */
  int32_t (*safe_bytes)(void* context, uint32_t index, const void* bytes, uint32_t size);
  /* The name of the configuration in force; "" if none is. A slow switch changes it at its end. Valid as long as the
   * task. */
  chimera_text (*configuration)(void* context);
  /* Starts of the process that runs the task: 1, and one more after each of its deaths. In virtual time it is 1. */
  uint32_t (*incarnation)(void* context);
} chimera_host;

/* The argument of every method. */
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

/* Work that may wait: files, sockets. A thread without real-time rights calls it about every 10 ms from the end of init
 * on, and once more before kill. It runs beside the other methods, so shared data must be atomic. It reads and writes
 * no port. CHIMERA_OK, or CHIMERA_FAULT with a text: then it is not called again. */
typedef int32_t (*chimera_background)(void* state, chimera_fault* fault);

/* The event source of an aperiodic component: returns a descriptor that is readable while an event waits; below 0:
 * none. Called after init; the descriptor stays valid until kill. Behind a server the framework waits for the
 * descriptor, in the executive it looks every millisecond; there a component with an event source is not polled, and
 * without descriptor its events are rings. It calls sync, which reads one event and does not block, as long as the
 * descriptor is readable. Context: setup. */
typedef int32_t (*chimera_event_source)(void* state);

/* An order between two in-consts of one type, unit and shape: no element of `lower` is above that of `upper`. The
 * checker compares written values; init must check a value that another component produces. */
typedef struct chimera_order {
  const char* lower;
  const char* upper;
} chimera_order;

/* The legal words of an in-const of text: separated by single spaces, each once. The checker compares written values;
 * init must check a value that another component produces. */
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

/* The only symbol that a shared object must export. NULL if the object was built for another `abi_version`. */
typedef const chimera_component* const* (*chimera_components_fn)(uint32_t abi_version, uint32_t* count);
#define CHIMERA_COMPONENTS_SYMBOL "chimera_components"

/* First of the two words of the only thread_local variable in an object, which belongs to the framework. Others are
   refused: a thread may allocate them on the heap at its first use. */
#define CHIMERA_THREAD_MARK UINT64_C(0x454e4f4441455254)

#ifdef __cplusplus
}
#endif
#endif /* CHIMERA_TASK_ABI_H_ */
