// SPDX-License-Identifier: Apache-2.0
// The lines of `chimera watch`: one for each variable, with its value and its recent course.
#pragma once

#include <cstddef>
#include <deque>
#include <string>
#include <vector>

#include "chimera/cli/live/channel.h"
#include "chimera/text/json.h"

namespace chimera::cli {

/// Context: setup; may allocate.
class Watch {
 public:
  static constexpr std::size_t kKept = 400;  ///< values of its course

  explicit Watch(std::vector<ChannelName> channels);

  /// Takes the member `values` of a notification or of the answer `get`.
  void add(const Json& values);
  /// One line a channel, at most `width` columns: name, value, course, and the range of the course. Of a list the
  /// course is that of its first number. Why a value does not change stands behind it: its producer's state.
  std::vector<std::string> lines(std::size_t width, bool unicode) const;
  /// "q = [1 2] rad", without any course: for what is no terminal.
  std::string plain() const;

 private:
  struct Watched {
    ChannelName name;
    std::string text = "?";
    std::string remark;  ///< "arm is OFF"
    std::deque<double> course;
  };
  std::vector<Watched> watched_;
};

}  // namespace chimera::cli
