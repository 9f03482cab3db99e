/* SPDX-License-Identifier: Apache-2.0 */
/* Two words for each thread, made when a thread first uses them. */
_Thread_local long chimera_test_of_a_thread[2];
