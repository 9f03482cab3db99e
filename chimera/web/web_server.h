// SPDX-License-Identifier: Apache-2.0
// Serves the page to browsers of this machine, and passes lines between a browser and a server of the control protocol.
// docs/formats/web.md. One thread; the only file that sees Boost.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "chimera/base/result.h"
#include "chimera/web/bench.h"
#include "chimera/web/page_files.h"

namespace chimera::web {

struct WebRequest {
  std::optional<std::uint16_t> port;  ///< 0: any free one; none: the first free one of 7440 to 7449
  BenchFacts facts;
};

class WebServer {
 public:
  using Tell = std::function<void(const std::string&)>;

  /// Listens at 127.0.0.1. Refuses if the port, or each of the ten, is in use. `tell` gets a sentence for each refusal,
  /// 16 at most and then one in 10 s. Context: setup.
  static Result<std::unique_ptr<WebServer>> open(const WebRequest& request, PageContents page, Tell tell);
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;
  ~WebServer();

  /// "http://127.0.0.1:7440/#KEY".
  const std::string& link() const noexcept;
  /// Serves until SIGINT or SIGTERM. Context: setup; blocks.
  void run();

 private:
  class Connection;
  class Loop;
  explicit WebServer(std::unique_ptr<Loop> loop);
  std::unique_ptr<Loop> loop_;
};

}  // namespace chimera::web
