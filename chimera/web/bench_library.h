// SPDX-License-Identifier: Apache-2.0
// The installed components as the bench knows them: read again when a folder or descriptor changes.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "chimera/base/result.h"
#include "chimera/catalogue/workplace.h"
#include "chimera/control/rpc_response.h"
#include "chimera/platform/clock.h"
#include "chimera/platform/shared_memory.h"

namespace chimera::web {

/// Context: setup; may block on the disk.
class BenchLibrary {
 public:
  static constexpr Nanoseconds kPeriod = seconds(1);  ///< of looks at the folders, if there is a question

  /// `file`: the description, or "". `program`: the version, for the bundle. `clock` outlives it.
  BenchLibrary(Workplace workplace, std::string file, std::string program, Clock& clock)
      : workplace_(std::move(workplace)), file_(std::move(file)), program_(std::move(program)), clock_(clock) {}

  /// Grows with each change of the library; reads it if it has changed.
  std::uint64_t version();
  /// The bundle for an analyst, of the last version(); or why there is none.
  const Result<FrozenBytes>& bundle() const noexcept { return bundle_; }
  /// The answer of `library`, of the last version().
  control::RpcResponse answer() const;

 private:
  using Stamp = std::vector<std::pair<std::string, std::filesystem::file_time_type>>;

  Stamp stamp() const;
  void read();

  Workplace workplace_;
  std::string file_, program_;
  Clock& clock_;
  Nanoseconds looked_at_{INT64_MIN / 2};
  std::uint64_t version_ = 0;
  Stamp stamp_;
  Result<FrozenBytes> bundle_ = Error{};
  std::shared_ptr<const std::string> list_;
};

}  // namespace chimera::web
