// SPDX-License-Identifier: Apache-2.0
// Detects values that are no longer renewed, and acts. README.md is the data sheet.
#include <algorithm>

#include "chimera/base/message.h"
#include "chimera/base/number_text.h"
#include "chimera/task/component.h"

using namespace chimera;

namespace {

enum class Action { kReport, kFault, kOff };

struct Watchdog {
  Many<In<Any[]>>    in{"in*", "U", "[n...<=64]", type = "T", doc = "Values to watch, of one type and unit."};
  InConst<double>    max_age{"max_age", "s", range(1e-6, 86400), doc = "Largest age of a live value."};
  InConst<Text<16>>  action{"action", "1", initial = "report", one_of = "report fault off",
                            doc = "Action when alive falls."};
  InConst<Text<64>>  target{"target", "1", initial = "", doc = "Task for the action off."};
  Out<bool>          alive{"alive", "1", initial = true, doc = "All values are renewed in time."};
  Out<std::int32_t>  late{"late", "1", initial = 0, range(0, 16), doc = "Number of values that are too old."};
  Out<double>        oldest{"oldest", "s", initial = 0.0, doc = "Age of the oldest value."};
  Out<std::int64_t>  alarms{"alarms", "1", initial = 0, doc = "Times that alive fell."};

  Outcome init() {
    if (in.size() == 0) return fault("there is nothing to watch: name at least one input");
    if (!(*max_age >= 1e-6 && *max_age <= 86400)) return fault("max_age must be 0.000001 to 86400 s");
    if (*action == "report") action_ = Action::kReport;
    else if (*action == "fault") action_ = Action::kFault;
    else if (*action == "off") action_ = Action::kOff;
    else return fault("action must be report, fault or off");
    if ((action_ == Action::kOff) == target->empty())
      return fault("the action off needs a target, the others have none");
    return ok();
  }
  Outcome reinit() { return init(); }
  void on(Cycle c) {
    since_ = c.now();
    *alive = true;
    *late = 0;
    *oldest = 0;
  }
  Outcome cycle(Cycle c) {
    const bool was_alive = *alive;
    *late = 0;
    *oldest = 0;
    std::size_t worst = 0;
    for (std::size_t i = 0; i < in.size(); ++i) {
      const double age = to_seconds(in[i].valid() ? std::min(in[i].age(), c.now() - since_) : c.now() - since_);
      if (age > *max_age) ++*late;
      if (age > *oldest) *oldest = age, worst = i;
    }
    *alive = *late == 0;
    if (*alive || !was_alive) return ok();
    *alarms += 1;
    if (action_ == Action::kOff && !c.signal(Signal::kOff, target->c_str()))
      return fault("the target is no task of this application");
    if (action_ != Action::kFault) return ok();
    return fault(
        (Message("in[") << worst << "] has not been renewed for " << number_text(*oldest, 3).view() << " s").view());
  }
  // Always succeeds, because a person turns the task on again after removing the cause.
  bool clear() { return true; }

 private:
  Action action_ = Action::kReport;
  Nanoseconds since_;
};

CHIMERA_COMPONENT(Watchdog, "watchdog",
                  "Detects values that are no longer renewed, and acts.", rate = 100.0);

}  // namespace
