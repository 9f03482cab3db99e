// SPDX-License-Identifier: Apache-2.0
// The part of a description that one board runs, as a description of its own: docs/formats/link.md. In it, a
// variable that another rtpu produces is an operator variable; the link sets its value.
#pragma once

#include "chimera/verify/configuration.h"
#include "chimera/verify/verify.h"

namespace chimera::bake {

/// The verified part of `rtpu`, a board of `whole`, with places in the same file; its rtpu has no link. Without a
/// configuration if the part differs from the whole: then the report says how. Context: setup.
Verdict board_part(const Configuration& whole, RtpuId rtpu, const Library& library);

}  // namespace chimera::bake
