// SPDX-License-Identifier: Apache-2.0
// Starts `chimera run FILE`, collects it, and reads the end of its output.
#include "chimera/web/started_run.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include "chimera/platform/file.h"
#include "chimera/text/json.h"
#include "chimera/web/draft_file.h"

namespace chimera::web {

using control::RpcResponse;

RpcResponse StartedRun::start(const std::string& file) {
  if (process_.is_held())
    return RpcResponse::refused("under-way", "process " + std::to_string(pid_) + ", started before, has not ended", "",
                                "end it first");
  const auto refuse = [](const Error& error) {
    return RpcResponse::refused("other", std::string(error.where.view()) + ": " + error.message.c_str(), "");
  };
  if (const auto made = make_drafts_folder(folder_); !made) return refuse(made.error());
  const std::string path = folder_ + "/output";
  std::error_code error;
  std::filesystem::remove(path, error);  // an earlier process may still write to it
  auto opened = open_to_append(path);
  if (!opened) return refuse(opened.error());
  std::filesystem::permissions(path, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write, error);
  const std::array<const char*, 3> words = {program_.c_str(), "run", file.c_str()};
  auto started = Process::start_apart(program_.c_str(), words, {.output = opened->fd, .error = opened->fd});
  if (!started) return refuse(started.error());
  process_ = *std::move(started);
  output_ = *std::move(opened);
  pid_ = process_.pid();
  ended_.clear();
  return RpcResponse::good({{"pid", pid_}});
}

RpcResponse StartedRun::output() const {
  std::string text;
  if (const auto size = static_cast<std::uint64_t>(std::max<std::int64_t>(file_size(output_.fd), 0)); size > 0) {
    text.resize(std::min<std::uint64_t>(size, kShown));
    const auto got = read_at(output_.fd, size - text.size(), std::as_writable_bytes(std::span(text)));
    text.resize(static_cast<std::size_t>(std::max<std::int64_t>(got, 0)));
  }
  Json answer = Json::object();
  answer["pid"] = pid_ == 0 ? Json() : Json(pid_);
  answer["ended"] = ended_.empty() ? Json() : Json(ended_);
  answer["text"] = text;
  return RpcResponse::good(answer);
}

void StartedRun::serve(Nanoseconds now) {
  if (ProcessEnd end; process_.has_ended(end))
    ended_ =
        end.by_signal ? "by " + std::string(signal_text(end.code).view()) : "with status " + std::to_string(end.code);
  if (output_.fd < 0 || now - bounded_at_ < seconds(1)) return;
  bounded_at_ = now;
  const std::int64_t size = file_size(output_.fd);
  if (size > static_cast<std::int64_t>(kMaxBytes))
    (void)free_bytes_before(output_.fd, static_cast<std::uint64_t>(size) - kShown);
}

}  // namespace chimera::web
