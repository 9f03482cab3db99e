// SPDX-License-Identifier: Apache-2.0
// Waits for pages, the analyst and what was started in one set of descriptors.
#include "chimera/web/bench_server.h"

#include "chimera/platform/process_state.h"

namespace chimera::web {

Result<void> BenchServer::open() {
  auto server = control::ControlServer::open(-1, bench_, own_user(), {});
  if (!server) return server.error();
  server_ = *std::move(server);
  const Message what("the server of the page cannot be watched");
  auto watched = DescriptorSet::open(what);
  if (!watched) return watched.error();
  watched_ = *std::move(watched);
  if (!watched_.add(server_->descriptor(), kToRead, 0)) return system_error(what, "epoll");
  return {};
}

void BenchServer::serve() {
  bench_.serve();
  server_->serve(clock_.now());
  // One that is closed has left the set; one that is in it is not added again.
  for (const int descriptor : bench_.descriptors())
    if (descriptor >= 0) (void)watched_.add(descriptor, kToRead, 1);
}

void BenchServer::enter(int connected) {
  server_->enter(OwnedDescriptor(connected), {own_user(), control::Role::kConfigure, 0}, clock_.now());
}

}  // namespace chimera::web
