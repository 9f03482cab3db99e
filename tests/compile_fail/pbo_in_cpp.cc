// SPDX-License-Identifier: Apache-2.0
#include "chimera/task/pbo.h"
