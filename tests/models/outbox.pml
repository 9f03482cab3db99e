/* SPDX-License-Identifier: Apache-2.0 */
/* Posts between two peers (chimera/runtime/outbox.h). Sender and reader may die at every step and are replaced; each
 * learns of the other's successor whenever it likes. A new sender has a ring of its own, a new reader a progress word
 * of its own. A place holds the number of its post in each word.
 * Mutants: PUBLISH_FIRST (counted before it is whole), FREE_FIRST (progress before the copy), ONE_TOO_MANY (room in a
 * full ring), FROM_THE_START (a new reader takes what was posted before it lived), ANY_INCARNATION (progress made in
 * the ring of a predecessor counts as following). */

#define N 2
#define WORDS 2
#define SENDERS 2
#define READERS 3
#define POSTS 4

#ifdef ONE_TOO_MANY
#define ROOM (N + 1)
#else
#define ROOM N
#endif

byte living_sender = 1, living_reader = 1;      /* incarnations, from 1; the keeper says so */
byte posted[SENDERS];
byte place[SENDERS * N * WORDS];
byte progress_of[READERS];                      /* sender whose posts are counted; 0: none yet */
byte progress[READERS];

byte lived[SENDERS * N];                        /* for the claims: reader that lived when the post was made */
bool promised[SENDERS * READERS];               /* the sender saw this reader follow, and posted */

#define WORD(k, n, w) place[(k) * N * WORDS + ((n) % N) * WORDS + (w)]

#ifdef ANY_INCARNATION
#define FOLLOWS(r, k) (r > 0 && progress_of[r - 1] > 0)
#else
#define FOLLOWS(r, k) (r > 0 && progress_of[r - 1] == k + 1)
#endif

/* One step of a process, or its death instead. */
#define STEP(living, most, action) \
  if \
  :: atomic { action } \
  :: atomic { living < most -> living++; goto start_again } \
  fi
#define SEND(action) STEP(living_sender, SENDERS, action)
#define READ(action) STEP(living_reader, READERS, action)

#define COUNT_IT \
  posted[k] = n + 1; \
  lived[k * N + n % N] = living_reader; \
  if \
  :: follows -> promised[k * READERS + known - 1] = true \
  :: else \
  fi

active proctype Sender() {
  byte k, n, w, known, taken;
  bool follows;
start_again:
  atomic { k = living_sender - 1; n = 0; w = 0; known = 0; taken = 0; follows = false }
  do
  :: n < POSTS ->
     if
     :: SEND(known = living_reader;)            /* it is told of a new reader */
     :: skip
     fi;
     SEND(follows = FOLLOWS(known, k);
          if
          :: follows -> taken = progress[known - 1]
          :: else -> taken = 0
          fi;);
     if
     :: n - taken < ROOM && n >= taken ->
#ifdef PUBLISH_FIRST
        SEND(COUNT_IT;);
#endif
        do
        :: w < WORDS -> SEND(WORD(k, n, w) = n + 1; w++;)
        :: else -> break
        od;
#ifndef PUBLISH_FIRST
        SEND(COUNT_IT;);
#endif
        atomic { n++; w = 0; follows = false; taken = 0 }
     :: else                                     /* refused: the sender knows */
     fi
  :: else -> break
  od
}

#ifdef FROM_THE_START
#define ATTACH taken = 0
#else
#define ATTACH taken = posted[from - 1]
#endif

active proctype Reader() {
  byte mine, from, taken, w;
  byte copy[WORDS];
start_again:
  atomic { mine = living_reader - 1; from = 0; taken = 0; w = 0; copy[0] = 0; copy[1] = 0 }
end_nothing_to_read:
  do
  :: from != living_sender ->                    /* it is told of a new sender */
     READ(from = living_sender; ATTACH;);
     READ(progress_of[mine] = from;
          progress[mine] = taken;
          assert(!promised[(from - 1) * READERS + mine]););  /* nothing promised to me was posted before I attached */
  :: from > 0 && posted[from - 1] != taken ->
     assert(posted[from - 1] - taken <= N);      /* never overwritten before it is read */
#ifdef FREE_FIRST
     READ(progress[mine] = taken + 1;);
#endif
     do
     :: w < WORDS -> READ(copy[w] = WORD(from - 1, taken, w); w++;)
     :: else -> break
     od;
     assert(copy[0] == taken + 1 && copy[1] == taken + 1);             /* whole, the next one, once */
     assert(lived[(from - 1) * N + taken % N] == mine + 1);            /* not meant for a dead reader */
     READ(taken++; progress[mine] = taken; w = 0; copy[0] = 0; copy[1] = 0;)
  od
}
