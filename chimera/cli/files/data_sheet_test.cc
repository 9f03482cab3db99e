// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/files/data_sheet.h"

#include <gtest/gtest.h>

namespace chimera::cli {
namespace {

TEST(PlainSheet, ShowsEverySectionButThePorts) {
  EXPECT_EQ(plain_sheet("# gain\n\nMultiplies, see [car](../car).\n\n## Equation\n\n    y[i] = k x(i)\n\n## Ports\n\n"
                        "| a |\n\n## Refused\n\nNothing.\n"),
            "Multiplies, see car.\n\nEquation\n\n    y[i] = k x(i)\n\nRefused\n\nNothing.\n");
}

TEST(PlainSheet, NamesPicturesAndLeavesBracketsAlone) {
  EXPECT_EQ(plain_sheet("# g\n![A step](s.svg) and in[0] (one) and [open\n"),
            "(picture: A step) and in[0] (one) and [open\n");
  EXPECT_EQ(plain_sheet("# s\n`[0.5, 0.5]`. All in one unit; [gain](../gain/README.md) and m[1][2] [a](b)\n"),
            "`[0.5, 0.5]`. All in one unit; gain and m[1][2] a\n");
  EXPECT_EQ(plain_sheet(""), "");
  EXPECT_EQ(plain_sheet("# only"), "");
}

TEST(DataSheet, ShowsDefaultsRangesAndFrames) {
  LibraryEntry entry;
  entry.descriptor.name = "g";
  entry.descriptor.doc = "Does.";
  PortDescriptor port;
  port.name = "k";
  port.doc = "The factor.";
  port.kind = CHIMERA_IN_CONST;
  port.unit = "m";
  port.frame = "base";
  port.has_range = true;
  port.min = -1;
  port.max = 2;
  port.at_least = "low";
  const double initial = 0.5;
  const auto* bytes = reinterpret_cast<const std::byte*>(&initial);
  port.initial.assign(bytes, bytes + sizeof initial);
  PortDescriptor wave{.name = "wave", .kind = CHIMERA_IN_CONST, .type = CHIMERA_STRING, .one_of = {"sine", "step"}};
  entry.descriptor.ports = {port, wave};
  entry.descriptor_file = "/nowhere/g.component.json";
  entry.object_file = "/nowhere/g.so";
  EXPECT_EQ(data_sheet(entry),
            "g: Does.\nrate     stated by the description\nreleased by the timer\nmethods \nports\n"
            "  in-const   k     float64  m     The factor; frame base; from -1 to 2; at least low; default 0.5\n"
            "  in-const   wave  string   1     one of sine step\n"
            "file     /nowhere/g.so\n");
}

}  // namespace
}  // namespace chimera::cli
