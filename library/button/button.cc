// SPDX-License-Identifier: Apache-2.0
// Reads a push button and sends signals to a task. README.md is the data sheet.
#include "chimera/base/math.h"
#include "chimera/task/component.h"
#include "library/button/debounce.h"
#include "library/button/input_pin.h"

using namespace chimera;
using library::Debounce, library::InputPin;

namespace {

struct Button {
  Resource pin{"pin", safe_state, shared,
               doc = "On Linux a file that begins with 0 or 1; on a target the name of a pin."};
  InConst<double> debounce{"debounce", "s", range(0, 10), initial = 0.02,
                           doc = "A new level counts when it has lasted for this time."};
  InConst<bool> active_low{"active_low", "1", initial = false, doc = "True: 0 is pressed."};
  InConst<Text<64>> target{"target", initial = "", doc = "The task that gets the signals."};
  InConst<Text<16>> press{"press", initial = "wakeup", doc = "Signal when it is pressed; empty: none."};
  InConst<Text<16>> release{"release", initial = "", doc = "Signal when it is released; empty: none."};
  Out<bool> pressed{"pressed", "1", initial = false, doc = "It is pressed."};
  Out<std::int64_t> presses{"presses", "1", initial = 0, doc = "Number of presses so far."};

  Outcome init() {
    if (Outcome read = reinit(); read.status() != CHIMERA_OK) return read;
    const InputPin::Refusal refusal = input_.open(pin.text());
    return refusal.view().empty() ? ok() : fault(refusal.view());
  }
  Outcome reinit() {
    if (!(*debounce >= 0 && *debounce <= 10)) return fault("debounce is 0 to 10 s");
    contact_.set_time({static_cast<std::int64_t>(math::floor(*debounce * 1e9 + 0.5))});
    if (!find(press->view(), at_press_)) return fault("press is no signal");
    if (!find(release->view(), at_release_)) return fault("release is no signal");
    return ok();
  }
  // A button that is pressed already gives no signal.
  void on() { contact_.forget(); }
  Outcome cycle(Cycle c) {
    const InputPin::Level level = input_.read();
    if (level == InputPin::Level::kUnreadable) return fault("the pin cannot be read");
    const Debounce::Edge edge = contact_.follow((level == InputPin::Level::kHigh) != *active_low, c.now());
    *pressed = contact_.level();
    if (edge == Debounce::Edge::kNone) return ok();
    const bool is_press = edge == Debounce::Edge::kRise;
    if (is_press) *presses += 1;
    return send(is_press ? at_press_ : at_release_, c);
  }
  // The contact is unknown while the task is OFF.
  void off() { *pressed = false; }
  void kill() { input_.close(); }

 private:
  static constexpr int kNone = -1;

  static bool find(std::string_view name, int& found) noexcept {
    found = kNone;
    for (int s = 0; s < CHIMERA_SIGNALS; ++s)
      if (name == signal_name(static_cast<Signal>(s))) found = s;
    return name.empty() || found != kNone;
  }
  Outcome send(int signal, Cycle c) const {
    if (signal == kNone || target->empty()) return ok();
    return c.signal(static_cast<Signal>(signal), target->c_str()) ? ok() : fault("the target does not take the signal");
  }

  InputPin input_;
  Debounce contact_;
  int at_press_ = kNone, at_release_ = kNone;
};

CHIMERA_COMPONENT(Button, "button", "Reads a push button and sends signals.", rate = 100.0);

}  // namespace
