// SPDX-License-Identifier: Apache-2.0
// Edits all descriptions of the tree by seed: text_edit_stress [--seconds N] [--edits N] [--from SEED]
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "chimera/description/testing/edit_campaign.h"

using namespace chimera;  // NOLINT: a main() of this project

int main(int argc, char** argv) {
  double limit = 0;
  unsigned seed = 1;
  unsigned long long most = 0;
  for (int a = 1; a + 1 < argc; a += 2) {
    const std::string key = argv[a];
    if (key == "--seconds")
      limit = std::strtod(argv[a + 1], nullptr);
    else if (key == "--edits")
      most = std::strtoull(argv[a + 1], nullptr, 10);
    else if (key == "--from")
      seed = static_cast<unsigned>(std::strtoul(argv[a + 1], nullptr, 10));
    else
      return 2;
  }
  if (most == 0) most = limit > 0 ? ~0ull : 10'000;
  constexpr std::size_t kRound = 120;  // edits of one text by one seed
  const auto began = std::chrono::steady_clock::now();
  const auto elapsed = [began] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  };
  const auto texts = texts_to_edit();
  unsigned long long edits = 0, faults = 0;
  for (unsigned long long done = 0; done < most && faults < 5 && (limit <= 0 || elapsed() < limit);
       done += kRound, ++seed)
    for (const auto& [path, text] : texts) {
      const std::string wrong = EditCampaign(text, seed).run(kRound);
      edits += kRound;
      if (wrong.empty()) continue;
      ++faults;
      std::printf("%s, seed %u: %s\n", path.c_str(), seed, wrong.c_str());
    }
  std::printf("{\"name\": \"text_edit\", \"n\": %llu, \"faults\": %llu, \"seconds\": %.1f}\n", edits, faults,
              elapsed());
  return faults == 0 && edits > 0 ? 0 : 1;
}
