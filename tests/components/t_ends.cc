// SPDX-License-Identifier: Apache-2.0
#include "tests/components/ends.h"

CHIMERA_COMPONENT(Ends, "t_ends", "Ends badly in one method.", rate = 1000.0);
