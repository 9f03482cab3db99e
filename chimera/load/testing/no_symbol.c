/* SPDX-License-Identifier: Apache-2.0 */
/* An object that is no component. */
int chimera_test_nothing(void);
int chimera_test_nothing(void) { return 0; }
