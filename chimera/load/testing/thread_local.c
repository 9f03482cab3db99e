/* SPDX-License-Identifier: Apache-2.0 */
/* One byte for each thread, made when a thread first uses it. */
_Thread_local char chimera_test_of_a_thread;
