// SPDX-License-Identifier: Apache-2.0
// An image that cannot go on names the place. So do the functions that a C++ library would bring for such cases.
#include "firmware/boot/stop.h"

#include "chimera/base/assert.h"
#include "chimera/base/message.h"
#include "chimera/base/mechanisms.h"
#include "chimera/platform/bare/core.h"
#include "chimera/runtime/executive/baked.h"
#include "firmware/boards/board.h"
#include "firmware/boot/kept.h"
#include "firmware/serial_text.h"

namespace chimera::firmware {
namespace {

constinit bool is_over = false;

[[noreturn]] void sleep_for_ever() noexcept {
  for (;;) {
    bare::wait_for_interrupt();
    if constexpr (mechanisms::kWatchdog) board_watchdog().stroke();
  }
}

// SYS_EXIT of semihosting: 0x20026 is success, any other reason a failure. A chip without a debugger has a hard fault
// there.
[[noreturn]] void end_simulation(int code) noexcept {
  is_over = true;
#ifdef CHIMERA_SIMULATED
  register std::uint32_t operation asm("r0") = 0x18;
  register std::uint32_t reason asm("r1") = code == 0 ? 0x20026 : 0x20024;
  asm volatile("bkpt 0xab" : : "r"(operation), "r"(reason) : "memory");
#else
  static_cast<void>(code);
#endif
  sleep_for_ever();
}

constexpr const char* kExceptions[] = {"no exception", "reset", "NMI",        "hard fault",
                                       "memory fault", "bus fault", "usage fault"};

}  // namespace

void end_image(int code) noexcept {
  if constexpr (mechanisms::kSerial) uart().flush();
  end_simulation(code);
}

// A failure in here resets at once. The words come last, because a serial line may take its time.
void stop(ResetCause cause, std::uint32_t pc, std::string_view words) noexcept {
  static constinit bool is_stopping = false;
  asm volatile("cpsid i" ::: "memory");
  if (is_stopping) bare::reset_chip();
  is_stopping = true;
  for (const baked::RegisterWrite& write : baked::kTarget.safe_writes) bare::register_at(write.address) = write.value;
  note_end(reset_record(), cause, running_method(), pc);
  if constexpr (mechanisms::kSerial) {
    uart().flush();
    uart().send("stop ");
    uart().send(words.substr(0, kSendBytes - 1));
    uart().flush();
    uart().send("\n");
    uart().flush();
  }
  if (is_in_setup && cause == ResetCause::kAssertion) end_simulation(1);
  bare::reset_chip();
}

void stop_at_exception(std::uint32_t number, std::uint32_t pc) noexcept {
  if (is_over) sleep_for_ever();
  constexpr std::uint32_t kNmi = 2;
  Message words;
  const bool is_watchdog = mechanisms::kWatchdog && number == kNmi;
  if (is_watchdog)
    words << "watchdog";
  else if (number < std::size(kExceptions))
    words << kExceptions[number];
  else if (number < 16)
    words << "exception " << number;
  else
    words << "interrupt " << number - 16 << " has no handler";
  words << " at 0x";
  stop(is_watchdog ? ResetCause::kWatchdog : ResetCause::kFault, pc, add_hex(words, pc, 8).view());
}

namespace {

[[noreturn]] void fail(const char* words) noexcept { stop(ResetCause::kAssertion, 0, words); }

}  // namespace
}  // namespace chimera::firmware

namespace chimera {

void assertion_failed(const char* condition, const char* file, int line) noexcept {
  const auto pc = static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(__builtin_return_address(0)));
  firmware::stop(firmware::ResetCause::kAssertion, pc, (Message() << file << ":" << line << ": " << condition).view());
}

}  // namespace chimera

namespace std {

[[noreturn]] void __glibcxx_assert_fail(const char* file, int line, const char*, const char* condition) noexcept {
  chimera::assertion_failed(condition, file, line);
}
[[noreturn]] void __throw_out_of_range_fmt(const char* format, ...) { chimera::firmware::fail(format); }
[[noreturn]] void __throw_length_error(const char* words) { chimera::firmware::fail(words); }

}  // namespace std

extern "C" {

[[noreturn]] void abort() { chimera::firmware::fail("abort"); }
[[noreturn]] void __cxa_pure_virtual() { chimera::firmware::fail("call of a function that its class does not define"); }
[[noreturn]] void __aeabi_atexit() { chimera::firmware::fail("a static object has a destructor"); }

}  // extern "C"
