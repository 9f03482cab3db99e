// SPDX-License-Identifier: Apache-2.0
// Passes questions to the analyst that has the present library, and ends the others when they have answered.
#include "chimera/web/analyses.h"

#include <algorithm>

namespace chimera::web {

void Analyses::ask(manager::Question question, std::uint64_t connection, Take take) {
  const std::uint64_t version = library_.version();
  const Result<FrozenBytes>& bundle = library_.bundle();
  if (!bundle)
    return take(control::RpcResponse::refused("library", bundle.error().message.c_str(),
                                              std::string(bundle.error().where.view())),
                {});
  if (all_.empty() || all_.back()->library != version) {
    auto copy = FrozenBytes::open(bundle->descriptor());
    if (!copy) return take(control::RpcResponse::refused("library", copy.error().message.c_str(), ""), {});
    auto made = std::make_unique<Generation>(Generation{version, *std::move(copy), nullptr});
    made->questions = std::make_unique<manager::Questions>(program_, made->bundle.descriptor(), tell_);
    all_.push_back(std::move(made));
  }
  all_.back()->questions->ask(std::move(question), connection, std::move(take), clock_.now());
}

void Analyses::forget(std::uint64_t connection) {
  for (const auto& one : all_) one->questions->forget(connection);
}

std::vector<int> Analyses::descriptors() const {
  std::vector<int> all;
  for (const auto& one : all_) all.push_back(one->questions->descriptor());
  return all;
}

Nanoseconds Analyses::next_due() const noexcept {
  Nanoseconds next = kNever;
  for (const auto& one : all_) next = std::min(next, one->questions->next_due());
  return next;
}

void Analyses::serve() {
  for (std::size_t i = 0; i < all_.size(); ++i) all_[i]->questions->serve(clock_.now());  // an answer may add one
  if (all_.empty()) return;
  const auto* last = all_.back().get();
  std::erase_if(all_, [&](const auto& one) { return one.get() != last && one->questions->waiting() == 0; });
}

}  // namespace chimera::web
