/* SPDX-License-Identifier: Apache-2.0 */
/* An object that needs a function that no object defines. */
void chimera_test_that_nobody_has(void);
void chimera_test_calls(void);
void chimera_test_calls(void) { chimera_test_that_nobody_has(); }
