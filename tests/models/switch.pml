/* SPDX-License-Identifier: Apache-2.0 */
/* A switch between two configurations (docs/decisions/0045-a-switch-is-committed-by-the-rtpus.md). One variable is
 * produced by task A of rtpu 0 in one configuration and by task B of rtpu 1 in the other; a job of each rtpu reads the
 * variable at every tick. Task S of rtpu 1 is the standby of A. The manager plans PLANS switches, there and back. One
 * rtpu may die between any two of its steps, the manager too (a successor starts), and STALLS times a process is held
 * up between two of its steps for as long as the others like.
 *
 * Claims: a job released before T reads the old producer, one released at T or later the new one, never what `on`
 * wrote without a commit, what `off` wrote, or a group written anew; at the commit no rtpu has used a release from T
 * on; never do two tasks produce; in the end each plan is over and has a receipt, and no living rtpu has an armed task.
 *
 * Left out, and why no fault hides there:
 *   more hold-ups      a process that is not held up takes its next step at once; one is held up at a time. That is
 *                      enough for a word to be old when it is used. -DSTALLS=2 (19 million states, 1 GB) finds no more.
 *   `max_step`, wishes, reasons, retries: an abort at any step stands for every cause of one.
 *   groups by task     the two groups of the variable alternate by generation, which reuses them sooner than groups
 *                      that alternate by incarnation of each of two tasks.
 *   threads of an rtpu jobs, arming and agreement of one rtpu follow each other here. An rtpu with several threads must
 *                      agree and adopt under the lock that releases take, and adopt after its last old job ended.
 *
 * Mutants: NO_AGREEMENT (the last to arm commits), LATE_GOES_ON (a release from T on does not abort a plan that is only
 * proposed), OFF_EARLY (`off` of the old producer before all have adopted), FREED_EARLY (its group is given away
 * before), NO_PROOF (the standby takes over from a task that is only silent), JOURNAL_LATE (journal after the plan),
 * ARMED_STAYS (an abort leaves the armed task), TWO_PLANS (the next plan before the one before is over).
 *
 * With RECORDED the model follows a run of real units (switching_stress --record): what EVENT names happens in the
 * order of that run, or the search goes on elsewhere; it ends with an error when the model has made the whole run. */

#define RTPUS 2
#ifndef PLANS
#define PLANS 2
#endif
#ifndef STALLS
#define STALLS 1
#endif
#define TICKS (PLANS + 1)
#define LEAD 1
#define MANAGER RTPUS
#define NOBODY 3

/* Whether the run goes on with that event (recorded_run.c). Without RECORDED an event is nothing, and no state. */
#define PREPARED 1
#define ARMED 2
#define PROPOSED 3
#define AGREED 4
#define COMMITTED 5
#define ADOPTED 6
#define OVER 7
#define ABORTED 8
#define DIED 9
#define FILED 10
#ifdef RECORDED
c_decl { extern int is_next(int at, int event, int who); };
byte n_events, event, event_of;
bool has_strayed, is_whole;
#define EVENT(what, who) \
  event = what; event_of = who; \
  c_code { now.has_strayed = !is_next(now.n_events, now.event, now.event_of); }; \
  n_events++; event = 0; event_of = 0; \
  c_code { now.is_whole = !now.has_strayed && is_next(now.n_events, 0, 0); };
#define FOLLOWS provided (!has_strayed)
#else
#define EVENT(what, who)
#define FOLLOWS
#endif

mtype = { idle, prepared, proposed, committed, aborted };
mtype = { nothing, of_even, of_odd, of_off };

/* The decision page: words that all may write, each changed as a whole. */
mtype phase = idle;
byte number, at;                     /* with phase: the plan word */
byte turn, missing;                  /* the turn word, of plan `number` */

/* What each rtpu tells in its own block. */
byte adopted[RTPUS];                 /* last plan whose bindings its jobs use, or that it found aborted */
byte over[RTPUS];                    /* last plan of which nothing is left to do here: `off` has run */
bool lives[RTPUS] = true;
byte next[RTPUS];                    /* release of its next job */
byte generation[RTPUS];              /* whose bindings its jobs use */
bool armed[RTPUS];
bool standby_on;

mtype group[2] = nothing;            /* of the producers of even and of odd generations */
byte latest;                         /* newest generation that was committed */
byte from;                           /* its T, for the claims */
byte now;                            /* the clock */

/* The manager's memory, which outlives it. */
byte journal, receipts;              /* newest plan in the journal; newest one with a receipt */
byte made;                           /* newest plan that was announced, for the claims */

byte stalls = STALLS;
byte stalled = NOBODY;
bool rtpu_may_die = true, manager_may_die = true;

#define PRODUCER(g) ((g) % 2)        /* rtpu whose task produces in generation g */
#define VALUE(g) ((g) % 2 -> of_odd : of_even)
#define IS_OPEN (phase == prepared || phase == proposed)
#define ALL_ADOPTED(n) ((!lives[0] || adopted[0] >= n) && (!lives[1] || adopted[1] >= n))
#define ALL_OVER(n) ((!lives[0] || over[0] >= n) && (!lives[1] || over[1] >= n))
#define IS(p) (phase == p && number == of_plan)
#define ABORT(before, who) if :: IS(before) -> EVENT(ABORTED, who) phase = aborted :: else fi

/* Between two steps: goes on, is held up, or dies. */
inline step(i) {
  if
  :: skip
  :: stalls > 0 && stalled == NOBODY -> stalls--; stalled = i; (stalled != i)
  fi;
  if
  :: skip
  :: i == MANAGER && manager_may_die -> manager_may_die = false; EVENT(DIED, i) goto dead
  :: i < RTPUS && rtpu_may_die -> rtpu_may_die = false; lives[i % RTPUS] = false; EVENT(DIED, i) goto dead
  fi
}

inline commit() {
  assert(!lives[0] || next[0] <= at);  /* nobody who lives has used a release from T on */
  assert(!lives[1] || next[1] <= at);
  EVENT(COMMITTED, i)
  phase = committed;
  latest++;
  from = at
}

/* The job of release next[i]. */
inline take_job(i) {
  seen = phase; of_plan = number; t = at;
  step(i);
  if
  :: of_plan > adopted[i] && seen == proposed && next[i] >= t ->
#ifndef LATE_GOES_ON
     ABORT(proposed, i);
#endif
     seen = phase;
     step(i)
  :: else
  fi;
  if
  :: of_plan > adopted[i] && seen == committed && next[i] >= t ->
     assert(!(PRODUCER(latest) == i && standby_on));  /* else two tasks of this rtpu produce */
     generation[i] = latest;
     armed[i] = false;
     step(i)
  :: else
  fi;
  next[i]++;
  assert(generation[i] == latest || (generation[i] + 1 == latest && next[i] <= from));
  assert(generation[i] < latest || latest == 0 || next[i] > from);
  step(i);
  assert((standby_on && i == 1) || group[generation[i] % 2] == VALUE(generation[i]));
  if
  :: of_plan > adopted[i] && seen == committed && generation[i] == latest && next[i] > t ->
     step(i);
     EVENT(ADOPTED, i)
     adopted[i] = of_plan
  :: else
  fi
}

inline arm(i) {
  of_plan = number;
  step(i);
  if
  :: PRODUCER(latest + 1) == i -> armed[i] = true; group[(latest + 1) % 2] = VALUE(latest + 1)  /* `on` */
  :: else
  fi;
  step(i);
  if
  :: i + 1 < RTPUS -> if :: IS(prepared) -> EVENT(ARMED, i) turn = i + 1 :: else fi
  :: else ->
     t = now + LEAD;
     step(i);                        /* may be held up before it writes T */
     if
     :: IS(prepared) && t > TICKS -> EVENT(ABORTED, i) phase = aborted  /* no release is left to change at */
#ifdef NO_AGREEMENT
     :: IS(prepared) && t <= TICKS -> at = t; commit()
#else
     :: IS(prepared) && t <= TICKS -> EVENT(PROPOSED, i) at = t; missing = RTPUS; phase = proposed
#endif
     :: else
     fi
  fi
}

inline agree(i) {
  of_plan = number; t = at; agreed = number;
  seen = (now < t && next[i] <= t -> proposed : aborted);
  step(i);
  if
  :: seen == aborted -> ABORT(proposed, i)
  :: else ->
     t = RTPUS;
     if :: IS(proposed) -> EVENT(AGREED, i) missing--; t = missing :: else fi;
     step(i);
     if :: t == 0 && IS(proposed) -> commit() :: else fi
  fi
}

/* The plan is aborted: what was armed goes `off` into its own group. */
inline disarm(i) {
  of_plan = number;
  step(i);
#ifndef ARMED_STAYS
  if :: armed[i] -> armed[i] = false; group[(latest + 1) % 2] = of_off :: else fi;
  step(i);
#endif
  EVENT(OVER, i)
  adopted[i] = of_plan; over[i] = of_plan
}

inline finish(i) {
  of_plan = number;
  step(i);
  if :: latest > 0 && PRODUCER(latest - 1) == i -> group[(latest - 1) % 2] = of_off :: else fi;
  step(i);
  EVENT(OVER, i)
  over[i] = of_plan
}

inline take_over() {
  of_plan = number;
  if :: IS_OPEN -> EVENT(ABORTED, 1) phase = aborted :: else fi;
  step(1);
  if
  :: phase != committed || number <= adopted[1] ->
     assert(!lives[0]);              /* else two tasks produce */
     standby_on = true
  :: else
  fi
}

proctype Rtpu(byte i) FOLLOWS {
  byte of_plan, t, agreed;
  mtype seen;
again:
  atomic { of_plan = 0; t = 0; seen = idle }  /* fewer states */
end:
  do
  :: atomic { next[i] <= now -> take_job(i); goto again }
  :: atomic { phase == prepared && turn == i && number > adopted[i] -> arm(i); goto again }
  :: atomic { phase == proposed && agreed < number -> agree(i); goto again }
  :: atomic { phase == aborted && number > adopted[i] -> disarm(i); goto again }
#ifdef OFF_EARLY
  :: atomic { phase == committed && number > over[i] -> finish(i); goto again }
#else
  :: atomic { phase == committed && number > over[i] && ALL_ADOPTED(number) -> finish(i); goto again }
#endif
#ifdef FREED_EARLY
  :: atomic { phase == committed && number > over[i] && PRODUCER(latest - 1) == i &&
              group[(latest - 1) % 2] != nothing -> group[(latest - 1) % 2] = nothing; goto again }
#endif
  :: atomic { IS_OPEN && !lives[1 - i] -> of_plan = number; step(i);
              if :: IS_OPEN && number == of_plan -> EVENT(ABORTED, i) phase = aborted :: else fi; goto again }
#ifdef NO_PROOF
  :: atomic { i == 1 && generation[1] % 2 == 0 && !standby_on && !(phase == committed && number > adopted[1]) &&
              (!lives[0] || stalled == 0) -> take_over(); goto again }
#else
  :: atomic { i == 1 && generation[1] % 2 == 0 && !standby_on && !(phase == committed && number > adopted[1]) &&
              !lives[0] -> take_over(); goto again }
#endif
  od;
dead:
  atomic { of_plan = 0; t = 0; seen = idle; agreed = 0 }
}

active proctype Manager() FOLLOWS {
dead:
  do
  :: atomic { number < journal && receipts < journal -> receipts = journal }  /* never announced: told so */
  :: atomic { number == journal && receipts < journal && IS_OPEN -> step(MANAGER);
              if :: IS_OPEN -> EVENT(ABORTED, MANAGER) phase = aborted :: else fi }  /* cancelled, late, a death */
  :: atomic { number == journal && receipts < journal && !IS_OPEN && ALL_OVER(number) -> step(MANAGER);
              EVENT(FILED, MANAGER)
              receipts = number }
#ifdef TWO_PLANS
  :: atomic { journal < PLANS ->
#else
  :: atomic { receipts == journal && journal < PLANS && lives[0] && lives[1] ->
#endif
#ifdef JOURNAL_LATE
     number = journal + 1; phase = prepared; turn = 0; at = 0; made = number; step(MANAGER);
     journal = number
#else
     journal++; step(MANAGER);
     EVENT(PREPARED, MANAGER)
     number = journal; phase = prepared; turn = 0; at = 0; made = number
#endif
     }
  :: receipts == journal && (journal == PLANS || !lives[0] || !lives[1]) -> break
  od
}

/* Time goes on, and who was held up too. */
active proctype World() FOLLOWS {
end:
  do
  :: atomic { now < TICKS -> now++ }
  :: atomic { stalled != NOBODY -> stalled = NOBODY }
  od
}

init {
  atomic { group[0] = of_even; run Rtpu(0); run Rtpu(1) };
#ifdef RECORDED
  is_whole -> assert(false);  /* the model has made the run */
#endif
  timeout ->
  assert(!IS_OPEN);
  assert(receipts >= made);
  assert(!lives[0] || !armed[0]);
  assert(!lives[1] || !armed[1])
}
