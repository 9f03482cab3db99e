// SPDX-License-Identifier: Apache-2.0
// `chimera bake`.
#include "apps/chimera/commands.h"
#include "apps/chimera/option_values.h"
#include "chimera/cli/batch/bake.h"

using namespace chimera;  // NOLINT: a part of a main()
using cli::Call;
using cli::WordKind;
using Repeats = cli::Option::Repeats;

namespace {

int bake_image(const Call& call, const Workplace& workplace) {
  cli::BakeRequest request{.file = call.operand(0),
                           .target = call.value("--target"),
                           .rtpu = call.value("--rtpu"),
                           .profile = call.value("--profile"),
                           .out = call.value("--out"),
                           .at = call.values("--at"),
                           .settings = settings_of(call),
                           .json = call.json};
  if (request.out.empty()) return print({"", "chimera bake: give --out DIR\n", cli::kUsage});
  if (!read_duration(call, "--for", request.duration)) return cli::kUsage;
  return print(cli::bake(request, workplace));
}

}  // namespace

FileCommand bake_row() {
  return {.words = {.name = "bake",
                    .help = "Write an application as constant tables for a microcontroller",
                    .operands = "FILE",
                    .least = 1,
                    .most = 1,
                    .operand_kind = WordKind::kDescription,
                    .operand_help = "the description",
                    .options = {{.name = "--target",
                                 .value = "NAME",
                                 .help = "the board: a name of firmware/targets, or a file NAME.yaml",
                                 .manual = "The board: a name of firmware/targets, or a file NAME.yaml "
                                           "(docs/formats/target.md). Required unless FILE has a board.",
                                 .kind = WordKind::kFile},
                                {.name = "--out",
                                 .value = "DIR",
                                 .help = "the folder of the files; required",
                                 .manual = "The folder of the files, which is made if it is missing. Required.",
                                 .kind = WordKind::kFile},
                                {.name = "--rtpu",
                                 .value = "NAME",
                                 .help = "the board to bake; default: the first rtpu with 'target'",
                                 .manual = "The rtpu of FILE to bake: one with 'target' and 'link' "
                                           "(docs/formats/link.md). Default: the first one."},
                                {.name = "--profile",
                                 .value = "FILE",
                                 .help = "prove all deadlines by this profile, recorded on the target",
                                 .manual = "Proves all deadlines by this profile (docs/formats/profile.md), which was "
                                           "recorded on the target. Without it no deadline is judged, and budgets of "
                                           "FILE are left out.",
                                 .kind = WordKind::kFile},
                                {.name = "--at",
                                 .value = "ACT",
                                 .help = "a timed act of the image, as of `run`; may be repeated",
                                 .manual = "A timed act that the image does itself, as of `run`. May be repeated.",
                                 .repeats = Repeats::kManyEach},
                                {.name = "--for",
                                 .value = "DURATION",
                                 .help = "the image prints its digest and ends after this time",
                                 .manual = "The image prints its digest (docs/formats/digest.md) and ends after this "
                                           "time; without it, it runs for ever."},
                                set_option("This value instead of the file's, as of `run`.")},
                    .json = "sizes, files and faults as one JSON object",
                    .footer = "Nothing is written if FILE and target do not suit each other.",
                    .example = "chimera bake firmware/images/servo/servo.yaml --target mps2-an385 --out image",
                    .manual = "Writes the legal description FILE as constant tables for an image of a microcontroller "
                              "(docs/formats/baked.md), or prints every reason why the target cannot run it. Prints "
                              "flash, RAM and stack of each task, and what its numbers of double precision cost."},
          .carry_out = bake_image};
}
