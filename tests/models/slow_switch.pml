/* SPDX-License-Identifier: Apache-2.0 */
/* A slow switch (docs/decisions/0061-a-slow-switch.md): steps that contexts take in turn, forwards or backwards, by two
 * words. Context 0 has a task L that leaves, S that arrives and U that stays; context 1 has N that leaves, R that
 * arrives and P that stays; context 2 takes part without a step. R produces what L produced, S what N did. L and R need
 * one resource, which a task has from `spawn` to `kill`. P makes a constant that U is initialised with. The manager
 * announces the switch, again when it was aborted (TRIES times together), may cancel it, and brings back who died.
 * Up to DEATHS contexts die, between any two steps or within a method. A method may fail. The manager may be away.
 *
 * Claims: it ends on one side, on which all tasks are then, with those of who came back; never do two tasks produce a
 * variable or have the resource; while what is ON of those that live is of neither side, one of them holds the flag;
 * all that live come to an end, without a manager too; no step is done twice, or undone without having been done; one
 * method is under way at a time, so none while somebody undoes; U is initialised after P, forwards and on the way back.
 *
 * Left out, and why no fault hides there:
 *   old looks          the plan and the turn word are read at once, and may be old when they are used. A plan word read
 *                      earlier leads nowhere else: the plan may be aborted right after the look instead of before it,
 *                      and `back` of the turn word counts more than an old plan word.
 *   bells, deadlines   whoever has something to do does it at any time. An abort by a deadline is one by the manager.
 *   a failing undo     such a task is named (`not_back`), and the rest is as before.
 *   a successor        is told of no plan that is open, and is over from its start: as if it were still dead.
 *
 * Mutants: COMMITS_ALONE (not all have agreed), COMMIT_BLIND, ABORT_BLIND and LEFT_OUT_BLIND (a store, no compare-and-
 * swap), LEFT_OUT_EARLY (steps of one who is only slow), LEFT_OUT_NEVER, TURNED_BY_ANY (while a method may be under
 * way), TURNED_SHORT (among the `reinit` only so many are undone as were done), FLAG_OF_ONE (who takes the first step
 * has it for all), FLAG_DOWN_EARLY (at the abort), BACK_FORWARDS (undone in the order of doing), REINIT_BACKWARDS (the
 * users before the makers), SPAWN_FIRST (before `kill`), KILL_UNDONE_FIRST (before `spawn` is undone), AGAIN_EARLY (the
 * next try before all are over), DEATH_READ (the manager reads as what a dead one comes back while the plan is open),
 * BACK_EARLY (it comes back before the others are over). */

#ifndef DEATHS
#define DEATHS 3
#endif
#ifndef TRIES
#define TRIES 2
#endif
#define NOBODY 3

/* The list. */
#define CHECKS 1                     /* step 0, of context 1 */
#define OFF_N 1
#define OFF_L 2
#ifdef SPAWN_FIRST
#define KILL_L 4
#define SPAWN_R 3
#else
#define KILL_L 3
#define SPAWN_R 4
#endif
#define REINIT_P 5
#define REINIT_U 6
#define ON_S 7
#define ON_R 8
#define STEPS 9
#define BIT(s) ((1 << (s)) >> 1)     /* none of a check */
#define OF_0 (BIT(OFF_L) | BIT(KILL_L) | BIT(REINIT_U) | BIT(ON_S))
#define OF_1 (BIT(OFF_N) | BIT(SPAWN_R) | BIT(REINIT_P) | BIT(ON_R))
#define OWNER(s) ((BIT(s) & OF_0) != 0 -> 0 : 1)

mtype = { prepared, committed, aborted };

/* The decision page: two words that all may write, each changed as a whole. */
mtype phase = prepared;
byte number = 1;                     /* of both words */
byte done;                           /* steps that are done, or left to be undone: */
bool is_back;                        /* which of the two */
bool agreed[3];                      /* who is not missing */

byte over[3];                        /* last plan of which nothing is left to do there */
bool lives[3] = true;
bool flag[3];                        /* held by that context */

byte did;                            /* what the tasks are: a bit for each step */
byte busy = NOBODY;                  /* whose method is under way */
byte deaths;                         /* that may still come */
bool closed[3], after[3], came[3];   /* of who died: the manager knows, as what it comes back, it has */

#define IS_DONE(s) ((did & BIT(s)) != 0)
#define ALL_LIVE (lives[0] && lives[1] && lives[2])
#define IS_OVER(c) (!lives[c] || over[c] == number)
#define ALL_OVER (IS_OVER(0) && IS_OVER(1) && IS_OVER(2))
#define LIVING ((lives[0] -> OF_0 : 0) | (lives[1] -> OF_1 : 0))
#define ARE_THERE(c) (lives[c] || came[c])
#define IS_MINE(s) (OWNER(s) == i)

/* The step that is undone next when n are left, and how many are left when it is turned round after n. */
#define UNDONE(n) ((n) - 1 == REINIT_P || (n) - 1 == REINIT_U -> REINIT_P + REINIT_U + 1 - (n) : (n) - 1)
#define LEFT(n) ((n) == REINIT_U -> REINIT_U + 1 : (n))
#define MAY_BE_VAIN(s) ((s) == REINIT_P || (s) == REINIT_U)  /* to undo it */
#ifdef BACK_FORWARDS
#undef UNDONE
#define UNDONE(n) (STEPS + CHECKS - (n))
#undef LEFT
#define LEFT(n) ((n) > CHECKS -> STEPS : (n))
#undef MAY_BE_VAIN
#define MAY_BE_VAIN(s) true
#endif
#ifdef KILL_UNDONE_FIRST
#undef UNDONE
#define UNDONE(n) ((n) > KILL_L && (n) <= ON_S -> KILL_L + SPAWN_R + 1 + 4 * ((n) > REINIT_P) - (n) : (n) - 1)
#undef LEFT
#define LEFT(n) ((n) == SPAWN_R || (n) == REINIT_U -> 1 + (n) : (n))
#undef MAY_BE_VAIN
#define MAY_BE_VAIN(s) true
#endif
#ifdef REINIT_BACKWARDS
#undef UNDONE
#define UNDONE(n) ((n) - 1)
#endif
#ifdef TURNED_SHORT
#undef LEFT
#define LEFT(n) (n)
#endif

#if defined(LEFT_OUT_EARLY)
#define IS_LEFT_OUT(s) true
#elif defined(LEFT_OUT_NEVER)
#define IS_LEFT_OUT(s) false
#else
#define IS_LEFT_OUT(s) IS_OVER(OWNER(s))
#endif
#define LAST(n) ((n) < STEPS -> (n) : STEPS - 1)
#ifdef TURNED_BY_ANY
#define TURNS_ROUND true
#else
#define TURNS_ROUND (IS_MINE(LAST(done)) || IS_OVER(OWNER(LAST(done))))
#endif
#ifdef COMMITS_ALONE
#define MAY_COMMIT true
#else
#define MAY_COMMIT (agreed[0] && agreed[1] && agreed[2])
#endif

/* What context i, which takes part, has seen. */
#ifdef FLAG_OF_ONE
#define HAS_LOOKED true
#define TAKES_FLAG(n) ((n) == CHECKS)
#else
#define HAS_LOOKED (flag[i] || done <= CHECKS)
#define TAKES_FLAG(n) ((n) >= CHECKS)
#endif
#define IS_OPEN (part == number && HAS_LOOKED && phase == prepared && !is_back)
#define IS_ABORTED (part == number && HAS_LOOKED && phase == aborted && !is_back)
#define GOES_BACK (part == number && HAS_LOOKED && is_back && done > CHECKS)
#define IS_ENDED (phase == committed || (is_back && done <= CHECKS))

/* What holds after each change. */
inline check() {
  assert(!(ARE_THERE(0) && !IS_DONE(OFF_L) && ARE_THERE(1) && IS_DONE(ON_R)));      /* two producers */
  assert(!(ARE_THERE(1) && !IS_DONE(OFF_N) && ARE_THERE(0) && IS_DONE(ON_S)));
  assert(!(ARE_THERE(0) && !IS_DONE(KILL_L) && ARE_THERE(1) && IS_DONE(SPAWN_R)));  /* two have the resource */
  assert((did & LIVING) == 0 || (did & LIVING) == LIVING ||
         (lives[0] && flag[0]) || (lives[1] && flag[1]) || (lives[2] && flag[2]))
}

inline die() {
  deaths--;
  lives[i] = false;
  if :: busy == i -> busy = NOBODY :: else fi;
  check();
  goto dead
}

/* Between two steps. */
inline go_on() {
  if :: skip :: deaths > 0 -> die() fi
}

inline abort(plan) {
#ifdef ABORT_BLIND
  phase = aborted
#else
  if :: phase == prepared && number == plan -> phase = aborted :: else fi
#endif
}

inline move_turn(was_back, to, back) {
  if :: number == part && done == at && is_back == was_back -> done = to; is_back = back :: else fi;
  at = 0  /* fewer states */
}

inline begin(s) {
  assert(busy == NOBODY);
  assert(s != REINIT_U || !lives[1] || IS_DONE(REINIT_P) != IS_DONE(REINIT_U));
  busy = i
}

proctype Context(byte i) {
  byte part, at;                     /* the plan it takes part in; where the turn word was */
end:
  do
  :: atomic { deaths > 0 -> die() }

  /* takes part, or comes too late for that */
  :: atomic { over[i] < number && part < number && phase == prepared };
     atomic { go_on(); part = number; agreed[i] = true }
  :: atomic { over[i] < number && part < number && phase != prepared -> assert(phase == aborted); over[i] = number }

  /* sees that steps behind the checks are done, and what became of it */
  :: atomic { over[i] < part && part == number && phase != committed && !HAS_LOOKED -> flag[i] = true }
  :: atomic { over[i] < part && part == number && IS_ENDED -> flag[i] = false; over[i] = part; check() }
  :: atomic { over[i] < part && part != number -> assert(false) }
#ifdef FLAG_DOWN_EARLY
  :: atomic { over[i] < part && part == number && phase == aborted && flag[i] -> flag[i] = false; check() }
#endif

  /* forwards: its own step, which may fail; or the end */
  :: atomic { IS_OPEN && ALL_LIVE && done < STEPS && IS_MINE(done) ->
              at = done;
              flag[i] = flag[i] || TAKES_FLAG(at);
              assert(!IS_DONE(at));
              begin(at) };
     if
     :: atomic { did = did | BIT(at); busy = NOBODY; check() };
        atomic { go_on(); move_turn(false, at + 1, false) }
     :: atomic { busy = NOBODY; at = 0 };
        atomic { go_on(); abort(part) }
     :: atomic { deaths > 0 -> die() }
     fi
  :: atomic { IS_OPEN && done == STEPS && MAY_COMMIT &&
              (IS_MINE(STEPS - 1) -> ALL_LIVE : !lives[OWNER(STEPS - 1)]) };  /* who died since all were seen to live */
     atomic { go_on();
#ifdef COMMIT_BLIND
              phase = committed
#else
              if :: phase == prepared && number == part -> phase = committed :: else fi
#endif
              }
  :: atomic { IS_OPEN && !ALL_LIVE };
     atomic { go_on(); abort(part) }

  /* backwards: who is initialised as before is left as it is */
  :: atomic { IS_ABORTED && TURNS_ROUND -> at = done };
     atomic { go_on(); move_turn(false, LEFT(at), true) }
  :: atomic { GOES_BACK && IS_MINE(UNDONE(done)) && IS_DONE(UNDONE(done)) -> at = done; begin(UNDONE(at)) };
     atomic { go_on(); did = did & ~BIT(UNDONE(at)); busy = NOBODY; check() };
     atomic { go_on(); move_turn(true, at - 1, true) }
  :: atomic { GOES_BACK && IS_MINE(UNDONE(done)) && !IS_DONE(UNDONE(done)) ->
              at = done; assert(MAY_BE_VAIN(UNDONE(at))) };
     atomic { go_on(); move_turn(true, at - 1, true) }
  :: atomic { GOES_BACK && !IS_MINE(UNDONE(done)) && IS_LEFT_OUT(UNDONE(done)) -> at = done };
     atomic { go_on();
#ifdef LEFT_OUT_BLIND
              done--; at = 0
#else
              move_turn(true, at - 1, true)
#endif
              }
  od;
dead:
  atomic { part = 0; at = 0 }
}

/* The plan is over before the manager reads how it ended. */
inline close(c) {
#ifndef DEATH_READ
  abort(number);
#endif
  after[c] = (phase == committed);
  closed[c] = true
}

inline bring_back(c) {
  came[c] = true;
  if
  :: c == 0 -> did = (did & OF_1) | (after[c] -> OF_0 : 0)
  :: c == 1 -> did = (did & OF_0) | (after[c] -> OF_1 : 0)
  :: else
  fi;
  check()
}

#ifdef BACK_EARLY
#define MAY_COME true
#else
#define MAY_COME ALL_OVER
#endif

active proctype Manager() {
  byte seen;
  if :: true :: ALL_OVER fi;         /* there all the time, or away */
end:
  do
  :: atomic { phase == prepared -> seen = number };
     atomic { abort(seen); seen = 0 }
#if TRIES > 1
#ifdef AGAIN_EARLY
  :: atomic { phase == aborted && number < TRIES && ALL_LIVE ->
#else
  :: atomic { phase == aborted && number < TRIES && ALL_LIVE && ALL_OVER ->
#endif
     number++; phase = prepared; done = 0; is_back = false; agreed[0] = false; agreed[1] = false; agreed[2] = false }
#endif
  :: atomic { !lives[0] && !closed[0] -> close(0) }
  :: atomic { !lives[1] && !closed[1] -> close(1) }
  :: atomic { !lives[2] && !closed[2] -> close(2) }
  :: atomic { closed[0] && !came[0] && MAY_COME -> bring_back(0) }
  :: atomic { closed[1] && !came[1] && MAY_COME -> bring_back(1) }
  :: atomic { closed[2] && !came[2] && MAY_COME -> bring_back(2) }
  od
}

init {
  atomic {
    select(deaths: 0 .. DEATHS);
    run Context(0); run Context(1); run Context(2)
  };
  timeout ->
  assert(ALL_OVER && phase != prepared);
  assert(did == (phase == committed -> OF_0 | OF_1 : 0));
  assert(!(lives[0] && flag[0]) && !(lives[1] && flag[1]) && !(lives[2] && flag[2]))
}
