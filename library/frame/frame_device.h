// SPDX-License-Identifier: Apache-2.0
// Common part of the components that exchange frames with a device: ports, checks of commands, detection of a lost
// device. The component moves the bytes.
#pragma once

#include <array>
#include <span>
#include <stdexcept>

#include "chimera/base/math.h"
#include "chimera/task/component.h"
#include "library/device/answers.h"
#include "library/device/sentence.h"
#include "library/frame/frame.h"
#include "library/frame/values.h"

namespace chimera::library {

struct FrameDevice {
  In<double[]> command{"command", "U", "[m<=16]", doc = "Values to send in every cycle."};
  Out<double[]> state{"state", "X", "[fields<=16]", initial = 0.0, doc = "Last values of the device."};
  Out<double> age{"age", "s", initial = 0.0, doc = "Time since the last good frame, or since on."};
  Out<bool> connected{"connected", initial = false, doc = "A good frame came within the timeout."};
  Out<std::int64_t> received{"received", "1", initial = 0, doc = "Good frames."};
  Out<std::int64_t> wrong{"wrong", "1", initial = 0, doc = "Frames with a wrong CRC or a value that is not finite."};
  Out<bool> idled{"idled", initial = false, safe_state, doc = "The flag is up and a frame with `idle` was sent since."};
  Out<std::int64_t> unsent{"unsent", "1", initial = 0, doc = "Commands not sent: not finite, or the line was full."};
  InConst<std::int32_t> fields{"fields", "1", initial = 1, range(1, 16), doc = "Values in a frame of the device."};
  InConst<Text<8>> form{"form", initial = "float32", one_of = "float32 int16", doc = "Form of a value in a frame."};
  InConst<double> command_resolution{"command_resolution", "U", initial = 1.0, doc = "Command for a 1 in the frame."};
  InConst<double> state_resolution{"state_resolution", "X", initial = 1.0, doc = "State for a 1 in the frame."};
  InConst<double> limit{"limit", "U", initial = 1e6, range(0, 1e9), at_least = "idle",
                        doc = "Commands are cut at +- limit."};
  InConst<double> idle{"idle", "U", initial = 0.0,
                       doc = "Command until the first good frame, after the last one, at off, while the flag is up."};
  InConst<double> timeout{"timeout", "s", initial = 0.1, range(0.001, 3600),
                          doc = "Silence after which the device counts as lost."};

 protected:
  /// Checks the constants. Context: setup; wait-free.
  void prepare(std::string_view device, std::size_t number_bytes) {
    if (*form == "float32") form_ = Form::kFloat32;
    else if (*form == "int16") form_ = Form::kInt16;
    else throw std::runtime_error("`form` is float32 or int16");
    for (const double r : {*command_resolution, *state_resolution})
      if (!math::is_finite(r) || r == 0) throw std::runtime_error("a resolution is finite and not 0");
    if (*limit / math::fabs(*command_resolution) > 1e37)
      throw std::runtime_error("`limit` over `command_resolution` is above 1e37: no float32 holds it");
    if (!(math::fabs(*idle) <= *limit)) throw std::runtime_error("`idle` is within +- `limit`");
    number_bytes_ = number_bytes;
    gone_.set(device, "is gone");
    silent_.set(device, "is silent");
    refused_.set(device, "sends no good frame");
  }
  std::size_t payload() const { return number_bytes_ + state.size() * width(form_); }

  void begin(Cycle c) {
    answers_.begin(c.now());
    lost_ = nullptr;
    *connected = *idled = has_refused_ = false;
    *age = 0;
  }
  /// Writes the payload of this cycle at to[2 + number_bytes] and returns its size; 0 if nothing is to be sent.
  std::size_t put_command(std::uint8_t* to, bool is_idle) {
    std::uint8_t* at = to + 2 + number_bytes_;
    for (const double value : command) {
      if (!is_idle && !math::is_finite(value)) {
        *unsent += 1;
        return 0;
      }
      const double held = is_idle ? *idle : value > *limit ? *limit : value < -*limit ? -*limit : value;
      put_value(at, form_, held, *command_resolution);
      at += width(form_);
    }
    return static_cast<std::size_t>(at - to) - 2;
  }
  /// The device could not be heard so far: its silence begins now.
  void wait(Nanoseconds now) { answers_.wait(now); }
  /// For cycle, after sending. `is_idle_out`: a complete frame with the idle command went out in this cycle.
  void tell_idled(Cycle c, bool is_idle_out) { *idled = c.illegal() && (*idled || is_idle_out); }
  /// Counts a refused frame: the device is not silent.
  void refuse(Out<std::int64_t>& counter, std::int64_t frames = 1) {
    *counter += frames;
    has_refused_ = has_refused_ || frames > 0;
  }
  /// Reads the values of a frame. Returns false, and changes nothing but `wrong`, if one is not finite.
  bool take_state(std::span<const std::uint8_t> frame, Nanoseconds now) {
    std::array<double, 16> values{};
    for (std::size_t i = 0; i < state.size(); ++i) {
      values[i] = get_value(frame.data() + number_bytes_ + i * width(form_), form_, *state_resolution);
      if (math::is_finite(values[i])) continue;
      refuse(wrong);
      return false;
    }
    for (std::size_t i = 0; i < state.size(); ++i) state[i] = values[i];
    *received += 1;
    *connected = true;
    has_refused_ = false;
    answers_.take(now);
    return true;
  }
  /// True if this cycle sends the idle command. A lost device is a fault of the next cycle: this one still publishes.
  bool must_idle(Cycle c, bool is_open) { return is_lost(c, is_open) || answers_.must_idle(c); }
  bool is_lost(Cycle c, bool is_open) {
    *age = answers_.age(c.now());
    if (!is_open) lost_ = &gone_;
    else if (*age > *timeout) lost_ = has_refused_ ? &refused_ : &silent_;
    if (lost_ != nullptr) *connected = false;
    return lost_ != nullptr;
  }
  /// Fault text of a lost device; null while the device is not lost.
  const char* lost() const { return lost_ == nullptr ? nullptr : lost_->text(); }

 private:
  Form form_ = Form::kFloat32;
  std::size_t number_bytes_ = 0;
  Answers answers_;
  LostSentence gone_, silent_, refused_;
  bool has_refused_ = false;  // since the last good frame
  const LostSentence* lost_ = nullptr;
};

}  // namespace chimera::library
