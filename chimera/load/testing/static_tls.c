/* SPDX-License-Identifier: Apache-2.0 */
/* Two words for each thread, which every thread has from its start; the object offers no components. */
__attribute__((tls_model("initial-exec"))) _Thread_local long chimera_test_of_a_thread[2];
long chimera_test_first(void);
long chimera_test_first(void) { return chimera_test_of_a_thread[0]; }
