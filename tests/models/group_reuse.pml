/* SPDX-License-Identifier: Apache-2.0 */
/* Hand-over by rebinding and the reuse of groups (chimera/table/binding.h, group_pool.h). Three incarnations of one
 * task follow each other over a pool of two groups. The old writer is told to go OFF and acknowledges when it comes
 * to that - until then it may wake up late and write - or is killed. One ON task reads and adopts generations at its
 * cycle edge. A word holds incarnation * 16 + publication.
 * Mutants: BEFORE_ADOPTION (reuse though a reader has not adopted), WITHOUT_PROOF (reuse though the old writer has
 * neither acknowledged nor been proved dead), COUNTER_BACK (a new incarnation counts from 0 again). */

#define GROUPS 2
#define N 3
#define WORDS 2
#define TRIES 2
#define INCARNATIONS 3
#define PUBLICATIONS(k) (k == INCARNATIONS -> 2 : (k == 1 -> 3 : 2))

#define FREE 0
#define IN_USE 1
#define RETIRED 2

byte counter[GROUPS];
byte slot[GROUPS * N * WORDS];
byte state[GROUPS], writer_of[GROUPS], retired_at[GROUPS];
byte generation;                      /* latest binding table; generation k binds incarnation k */
byte group_of[INCARNATIONS + 1];
byte adopted;                         /* by the reader */
bool reader_is_on;
bool told_off[INCARNATIONS + 1], is_off[INCARNATIONS + 1], is_dead[INCARNATIONS + 1];
bool published[INCARNATIONS + 1];

#define WORD(g, n, i) slot[(g) * N * WORDS + ((n) % N) * WORDS + (i)]

#ifdef WITHOUT_PROOF
#define WRITER_ENDED(g) true
#else
#define WRITER_ENDED(g) (is_off[writer_of[g]] || is_dead[writer_of[g]])
#endif
#ifdef BEFORE_ADOPTION
#define ADOPTED(g) true
#else
#define ADOPTED(g) (!reader_is_on || adopted >= retired_at[g])
#endif
#define CAN_TAKE(g) (state[g] == FREE || (state[g] == RETIRED && WRITER_ENDED(g) && ADOPTED(g)))

proctype Writer(byte k; byte g) {
  byte n, i, cycles;
#ifdef COUNTER_BACK
  counter[g] = 0;
#endif
  n = counter[g];
  do
  :: atomic { is_dead[k] -> break }
  :: atomic { !is_dead[k] && told_off[k] -> is_off[k] = true; break }
  :: atomic { !is_dead[k] && cycles < PUBLICATIONS(k) -> i = 0 };
     do
     :: atomic { !is_dead[k] && i < WORDS -> WORD(g, n + 1, i) = k * 16 + n + 1; i++ }
     :: atomic { !is_dead[k] && i == WORDS -> n++; counter[g] = n; published[k] = true; cycles++; i = 0; break }
     :: atomic { is_dead[k] -> goto ended }
     od
  od;
ended:
  skip
}

active proctype Manager() {
  byte k = 1, g, old;
  do
  :: k <= INCARNATIONS ->
     atomic {
       if
       :: CAN_TAKE(0) -> g = 0
       :: CAN_TAKE(1) -> g = 1
       fi;
       state[g] = IN_USE;
       writer_of[g] = k;
       run Writer(k, g)
     };
     published[k];                    /* the new task's first outputs, into its still unbound group */
     atomic {
       group_of[k] = g;
       generation = k;
       if
       :: k > 1 -> state[old] = RETIRED; retired_at[old] = k
       :: else
       fi
     };
     if
     :: k > 1 -> told_off[k - 1] = true
     :: k > 1 -> is_dead[k - 1] = true /* killed; proved by the process descriptor */
     :: k == 1
     fi;
     old = g;
     k++
  :: else -> break
  od;
  told_off[INCARNATIONS] = true
}

active proctype Reader() {
  byte g, n, m, i, tries, mine;
  byte copy[WORDS];
  byte last[GROUPS];
  atomic { generation > 0 -> reader_is_on = true; adopted = generation };
  do
  :: mine = generation;
     adopted = mine;                  /* published before the first read by it */
     g = group_of[mine];
     n = counter[g];
     tries = 0;
     do
     :: tries < TRIES ->
        i = 0;
        do
        :: i < WORDS -> atomic { copy[i] = WORD(g, n, i); i++ }
        :: else -> break
        od;
        m = counter[g];
        if
        :: m - n <= N - 2 && m >= n ->
           assert(copy[0] == copy[1]);
           assert(copy[0] == mine * 16 + n); /* of the incarnation that is bound, the publication it names */
           assert(n >= last[g]);             /* counters never go back */
           last[g] = n;
           tries = 0;
           break
        :: m < n -> assert(false)
        :: else -> n = m; tries++
        fi
     :: else -> tries = 0; break
     od;
     atomic { n = 0; m = 0; i = 0; copy[0] = 0; copy[1] = 0; mine = 0; g = 0 } /* forgotten: fewer states */
  :: reader_is_on = false; break
  od
}
