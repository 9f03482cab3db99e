// SPDX-License-Identifier: Apache-2.0
// refused: pbo.h is the C face of a component; a C++ source includes chimera/task/component.h
#include "chimera/task/pbo.h"
