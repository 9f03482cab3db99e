// SPDX-License-Identifier: Apache-2.0
// Replaces MuJoCo's handlers of errors and warnings, and returns from an error by longjmp.
#include "library/mujoco/mujoco_guard.h"

#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>

namespace chimera::library {
namespace {

// In static thread storage, because the first access from a real-time thread must not allocate.
struct Landing {
  std::jmp_buf* place;
  char text[120];
};
__attribute__((tls_model("initial-exec"))) thread_local Landing landing{};

// MuJoCo is C, so there is nothing to unwind. If the handler returned, MuJoCo would continue with a broken state.
[[noreturn]] void on_error(const char* text) {
  if (landing.place == nullptr) {
    std::fprintf(stderr, "mujoco: %s\n", text);
    std::abort();
  }
  std::snprintf(landing.text, sizeof landing.text, "%s", text);
  std::longjmp(*landing.place, 1);
}

// The state counts warnings, too, and guarded() reads these counts.
void on_warning(const char*) {}

int bad_numbers(const mjData* state) noexcept {
  return state->warning[mjWARN_BADQPOS].number + state->warning[mjWARN_BADQVEL].number +
         state->warning[mjWARN_BADQACC].number + state->warning[mjWARN_BADCTRL].number;
}

template <class Part>
bool returns(Part part) noexcept {
  std::jmp_buf here;
  landing.place = &here;
  if (setjmp(here) != 0) {
    landing.place = nullptr;
    return false;
  }
  part();
  landing.place = nullptr;
  return true;
}

}  // namespace

void install_mujoco_handlers() noexcept {
  mju_user_error = on_error;
  mju_user_warning = on_warning;
}

bool guarded(void (*part)(const mjModel*, mjData*), const mjModel* model, mjData* state) noexcept {
  landing.text[0] = '\0';
  // A reset clears the counts and then adds its own, so each warning shows if the counts start at 0.
  for (int kind : {mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC, mjWARN_BADCTRL}) state->warning[kind].number = 0;
  return returns([=] { part(model, state); }) && bad_numbers(state) == 0;
}

bool guarded_setup(void (*part)(void*), void* with) noexcept {
  landing.text[0] = '\0';
  return returns([=] { part(with); });
}

const char* mujoco_error() noexcept { return landing.text; }

}  // namespace chimera::library
