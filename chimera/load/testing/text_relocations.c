/* SPDX-License-Identifier: Apache-2.0 */
/* Code that has to be written when it is loaded: built without -fPIC. */
void chimera_test_elsewhere(void);
void chimera_test_calls(void);
void chimera_test_calls(void) { chimera_test_elsewhere(); }
void chimera_test_elsewhere(void) {}
