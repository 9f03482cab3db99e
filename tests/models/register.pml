/* SPDX-License-Identifier: Apache-2.0 */
/* The register of chimera/table/group.h: a writer that may die at every step and is started again, a reader.
 * Every load and store of a word is a step of its own. A word holds the number of its publication.
 * Mutants: ACCEPT_N_MINUS_1 (reader believes one publication too many), PUBLISH_FIRST (counter before copy). */

#ifndef N
#define N 4
#endif
#define WORDS 2
#define VERSIONS 10
#define DEATHS 3
#define TRIES 4
#define READS 3

#ifdef ACCEPT_N_MINUS_1
#define WHOLE (N - 1)
#else
#define WHOLE (N - 2)
#endif

byte counter;
byte slot[N * WORDS];
byte deaths;

/* One step of the writer, or its death instead. */
#define STEP(action) \
  if \
  :: atomic { action } \
  :: atomic { deaths < DEATHS -> deaths++; goto start_again } \
  fi

active proctype Writer() {
  byte n, i;
start_again:
  atomic { n = counter; i = 0 }
  do
  :: n < VERSIONS ->
#ifdef PUBLISH_FIRST
     STEP(counter = n + 1;);
#endif
     i = 0;
     do
     :: i < WORDS -> STEP(slot[((n + 1) % N) * WORDS + i] = n + 1; i++;)
     :: else -> break
     od;
#ifndef PUBLISH_FIRST
     STEP(counter = n + 1;);
#endif
     n = n + 1
  :: else -> break
  od
}

active proctype Reader() {
  byte n, m, i, tries, last, first_counter, reads;
  byte copy[WORDS];
  do
  :: reads < READS ->
     atomic { n = counter; first_counter = n; tries = 0 };
     do
     :: tries < TRIES ->
        i = 0;
        do
        :: i < WORDS -> atomic { copy[i] = slot[(n % N) * WORDS + i]; i++ }
        :: else -> break
        od;
        m = counter;
        if
        :: m - n <= WHOLE ->
           i = 0;
           do
           :: i < WORDS -> assert(copy[i] == n); i++  /* whole, and the publication it claims to be */
           :: else -> break
           od;
           assert(n >= last);                         /* never backwards */
           last = n;
           break
        :: else -> atomic { n = m; tries++ }
        fi
     :: else ->
        assert(counter != first_counter);             /* refused only beside a writer that publishes */
        break
     od;
     reads++
  :: else -> break
  od
}
