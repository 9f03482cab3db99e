// SPDX-License-Identifier: Apache-2.0
// Compares the link of a board with its target.
#include "chimera/bake/refusals.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/text/time_text.h"

namespace chimera::bake {

void refuse_link(const Configuration& configuration, const LinkSpec& link, const Target& target, Report& description,
                 Report& of_target) {
  const Place at = configuration.draft().rtpus.empty() ? Place{} : configuration.draft().rtpus[0].name.at;
  if (!target.uart)
    of_target.add({.rule = "board-rtpu",
                   .at = target.flash.at,
                   .message = "the target has no 'uart', and the image has a link to Linux",
                   .remedy = "write 'uart: {address: ADDRESS, interrupt: NAME, baud: 115200}'"});
  else if (!link.is_udp && target.uart->baud != link.baud)
    description.add({.rule = "board-rtpu",
                     .at = at,
                     .message = "the link of rtpu " + in_quotes(configuration.rtpus()[0].name) + " has " +
                                std::to_string(link.baud) + " baud, and 'uart' of the target " +
                                in_quotes(target.name) + " has " + std::to_string(target.uart->baud),
                     .remedy = "write 'baud: " + std::to_string(target.uart->baud) + "' in 'link'"});
  if (const ResourceTexts* const user = target.user_of_uart())
    of_target.add({.rule = "resource-twice",
                   .at = user->texts[0].at,
                   .message = "'uart' belongs to task " + in_quotes(user->task.text) + ", and the image has a link",
                   .remedy = "take 'link' or the task out of the description"});
  if (link.period.count % target.tick.value.count != 0)
    description.add({.rule = "link-time",
                     .at = at,
                     .message = "a frame of the link of rtpu " + in_quotes(configuration.rtpus()[0].name) +
                                " is sent every " + time_text(link.period) + ", which is no multiple of the tick of " +
                                time_text(target.tick.value),
                     .remedy = "write a 'rate' whose period is a multiple"});
}

}  // namespace chimera::bake
