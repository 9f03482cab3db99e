/* SPDX-License-Identifier: Apache-2.0 */
/* An object with the symbol but without a component. */
#include "chimera/task/registry.h"
