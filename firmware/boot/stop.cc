// SPDX-License-Identifier: Apache-2.0
// An image that cannot go on names the place. So do the functions that a C++ library would bring for such cases.
#include "firmware/boot/stop.h"

#include "chimera/base/assert.h"
#include "chimera/base/message.h"
#include "chimera/platform/bare/core.h"
#include "firmware/boards/board.h"
#include "firmware/serial_text.h"

namespace chimera::firmware {
namespace {

// SYS_EXIT of semihosting: 0x20026 is success, any other reason a failure.
[[noreturn]] void end_simulation(int code) noexcept {
#ifdef CHIMERA_SIMULATED
  register std::uint32_t operation asm("r0") = 0x18;
  register std::uint32_t reason asm("r1") = code == 0 ? 0x20026 : 0x20024;
  asm volatile("bkpt 0xab" : : "r"(operation), "r"(reason) : "memory");
#else
  static_cast<void>(code);
#endif
  for (;;) bare::wait_for_interrupt();
}

constexpr const char* kExceptions[] = {"no exception", "reset", "NMI",        "hard fault",
                                       "memory fault", "bus fault", "usage fault"};

}  // namespace

void end_image(int code) noexcept {
  uart().flush();
  end_simulation(code);
}

void stop(std::string_view words) noexcept {
  uart().flush();
  uart().send("stop ");
  uart().send(words.substr(0, kSendBytes - 1));
  uart().flush();
  uart().send("\n");
  end_image(1);
}

void stop_at_exception(std::uint32_t number, std::uint32_t pc) noexcept {
  Message words;
  if (number < std::size(kExceptions))
    words << kExceptions[number];
  else if (number < 16)
    words << "exception " << number;
  else
    words << "interrupt " << number - 16 << " has no handler";
  words << " at 0x";
  stop(add_hex(words, pc, 8).view());
}

}  // namespace chimera::firmware

namespace chimera {

void assertion_failed(const char* condition, const char* file, int line) noexcept {
  firmware::stop((Message() << file << ":" << line << ": " << condition).view());
}

}  // namespace chimera

namespace std {

[[noreturn]] void __glibcxx_assert_fail(const char* file, int line, const char*, const char* condition) noexcept {
  chimera::assertion_failed(condition, file, line);
}
[[noreturn]] void __throw_out_of_range_fmt(const char* format, ...) { chimera::firmware::stop(format); }
[[noreturn]] void __throw_length_error(const char* words) { chimera::firmware::stop(words); }

}  // namespace std

extern "C" {

[[noreturn]] void abort() { chimera::firmware::stop("abort"); }
[[noreturn]] void __cxa_pure_virtual() { chimera::firmware::stop("call of a function that its class does not define"); }
[[noreturn]] void __aeabi_atexit() { chimera::firmware::stop("a static object has a destructor"); }

}  // extern "C"
