// SPDX-License-Identifier: Apache-2.0
// The proof over many seeds: schedule_stress [--seconds N] [--sets N] [--from SEED]
#include "tests/schedule/campaign.h"
#include "tests/schedule/proof.h"

using namespace chimera::proof;  // NOLINT: a main() of this project

namespace {

void tell(const Tallies& tallies) {
  std::printf("%-18s %9s %9s %12s %9s %9s %9s %11s\n", "kind", "sets", "fit", "called bad", "not seen", "exact",
              "demands", "bound/seen");
  for (std::size_t k = 0; k < tallies.size(); ++k) {
    const Tally& t = tallies[k];
    std::printf("%-18s %9llu %9llu %12llu %9llu %9llu %9llu %11.3f\n", kKindNames[k],
                static_cast<unsigned long long>(t.sets), static_cast<unsigned long long>(t.fit),
                static_cast<unsigned long long>(t.sets - t.fit), static_cast<unsigned long long>(t.not_seen_to_miss),
                static_cast<unsigned long long>(t.exact), static_cast<unsigned long long>(t.failing_demands),
                t.bounds == 0 ? 0 : t.bound_over_seen / static_cast<double>(t.bounds));
  }
}

}  // namespace

int main(int argc, char** argv) {
  Tallies tallies{};
  return campaign(argc, argv, {"schedule_analysis", "--sets"}, [&](std::uint32_t seed) { return judge(seed, tallies); },
                  [&] { tell(tallies); });
}
