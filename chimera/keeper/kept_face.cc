// SPDX-License-Identifier: Apache-2.0
// Starts the client of a run, and counts its deaths.
#include "chimera/keeper/kept_face.h"

#include <csignal>
#include <new>

namespace chimera {

void KeptFace::end() {
  ProcessEnd end;
  process_.signal(SIGKILL);
  process_.wait(end, seconds(1).count);
}

Result<void> KeptFace::start() {
  if (pages_.bytes().empty()) {
    auto pages = SharedPages::create("chimera-face", sizeof(FacePage));
    if (!pages) return pages.error();
    pages_ = *std::move(pages);
    new (pages_.bytes().data()) FacePage;
  }
  std::vector<const char*> words;
  for (const std::string& word : words_) words.push_back(word.c_str());
  const int passed[] = {pages_.descriptor()};
  auto process = Process::start(words[0], words, passed, SIGTERM);  // SIGTERM stays pending until the client listens
  if (!process) return process.error();
  process_ = *std::move(process);
  return {};
}

KeptFace::Fate KeptFace::poll() {
  ProcessEnd end;
  if (!process_.has_ended(end)) return Fate::kNothingNew;
  if (!end.by_signal) {
    code_ = end.code;
    return Fate::kExited;
  }
  page().last_signal = end.code;
  ++page().deaths;
  const Nanoseconds now = clock_.now();
  std::erase_if(deaths_, [now](Nanoseconds at) { return at + kFaceDeathsWithin < now; });
  deaths_.push_back(now);
  return deaths_.size() < kMostFaceDeaths ? Fate::kDied : Fate::kGivenUp;
}

}  // namespace chimera
