// SPDX-License-Identifier: Apache-2.0
// Packs the contents of objects one behind the other, each after the lengths of its path and content, and finds them.
#include "chimera/load/sealed_objects.h"

#include <cstring>

namespace chimera {
namespace {

constexpr std::string_view kMark = "CHIMOBJ1";

struct Lengths {
  std::uint64_t path = 0, content = 0;
};

void append(std::vector<std::byte>& out, std::span<const std::byte> bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

Result<std::vector<std::byte>> SealedObjects::pack(std::span<const std::string> paths) {
  std::map<std::string_view, std::string> contents;
  for (const std::string& path : paths) {
    if (contents.contains(path)) continue;
    auto content = SharedObject::read(path);
    if (!content) return content.error();
    contents.emplace(path, *std::move(content));
  }
  std::vector<std::byte> out;
  append(out, bytes_of(kMark));
  for (const auto& [path, content] : contents) {
    const Lengths lengths{path.size(), content.size()};
    append(out, std::as_bytes(std::span(&lengths, 1)));
    append(out, bytes_of(path));
    append(out, bytes_of(content));
  }
  return out;
}

Result<SealedObjects> SealedObjects::open(std::span<const std::byte> bytes) {
  const Error cut = {ErrorCode::kBadInput, {"the memory of the objects is cut short"}, {}};
  if (bytes.size() < kMark.size() || text_of(bytes.first(kMark.size())) != kMark) return cut;
  SealedObjects objects;
  for (bytes = bytes.subspan(kMark.size()); !bytes.empty();) {
    Lengths lengths;
    if (bytes.size() < sizeof lengths) return cut;
    std::memcpy(&lengths, bytes.data(), sizeof lengths);
    bytes = bytes.subspan(sizeof lengths);
    if (lengths.path > bytes.size() || lengths.content > bytes.size() - lengths.path) return cut;
    objects.contents_.emplace(text_of(bytes.first(lengths.path)), bytes.subspan(lengths.path, lengths.content));
    bytes = bytes.subspan(lengths.path + lengths.content);
  }
  return objects;
}

Result<SharedObject> SealedObjects::link(const std::string& path) const {
  const auto found = contents_.find(path);
  if (found == contents_.end())
    return Error{ErrorCode::kNotFound, {"is not among the objects of this run"}, {std::string_view(path)}};
  return SharedObject::open(found->second, path);
}

}  // namespace chimera
