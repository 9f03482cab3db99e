// SPDX-License-Identifier: Apache-2.0
// How the fields of an application image become bytes and come out of them again. Writer and reader offer the same
// operations, so that the fields are listed once and cannot drift apart. Context: setup; may block.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace chimera {

/// Appends each value.
class ImageWriter {
 public:
  template <class T>
  void number(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* at = reinterpret_cast<const std::byte*>(&value);
    out_.insert(out_.end(), at, at + sizeof value);
  }
  template <class T>
  void choice(const T& value, T) { number(value); }
  void text(const std::string_view& text) { values(std::as_bytes(std::span(text.data(), text.size()))); }
  void values(const std::span<const std::byte>& bytes) {
    number(static_cast<std::uint32_t>(bytes.size()));
    out_.insert(out_.end(), bytes.begin(), bytes.end());
  }
  template <class T, class Each>
  void list(const std::span<const T>& items, std::vector<T>&, std::size_t, const char*, Each each) {
    number(static_cast<std::uint32_t>(items.size()));
    for (const T& item : items) each(item);
  }
  void require(bool, const char*) {}

  std::span<std::byte> bytes() & { return out_; }
  std::vector<std::byte> bytes() && { return std::move(out_); }

 private:
  std::vector<std::byte> out_;
};

/// Reads each value, and judges it: the bytes may come from any source. Texts and bytes that it makes point into them.
/// After the first fault nothing more is read.
class ImageReader {
 public:
  explicit ImageReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <class T>
  void number(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto from = take(sizeof value);
    if (!from.empty()) std::memcpy(static_cast<void*>(&value), from.data(), sizeof value);
  }
  /// An enumeration or a bool, `last` its greatest: judged before it becomes one.
  template <class T>
  void choice(T& value, T last) {
    unsigned char read = 0;
    static_assert(sizeof(T) == 1);
    number(read);
    require(read <= static_cast<unsigned char>(last), "a choice that does not exist");
    if (is_good()) value = static_cast<T>(read);
  }
  void text(std::string_view& text) {
    std::span<const std::byte> bytes;
    values(bytes);
    text = {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  void values(std::span<const std::byte>& bytes) {
    std::uint32_t n = 0;
    number(n);
    bytes = take(n);
  }
  template <class T, class Each>
  void list(std::span<const T>& items, std::vector<T>& storage, std::size_t most, const char* what, Each each) {
    std::uint32_t n = 0;
    number(n);
    // Every item takes at least a byte: a count beyond them is not believed, and no memory is taken for it.
    require(n <= most && n <= bytes_.size() - at_, what);
    if (!is_good()) return;
    storage.resize(n);
    for (std::uint32_t i = 0; i < n && is_good(); ++i) each(storage[i]);
    items = storage;
  }
  /// Checks a condition on the values read up to now.
  void require(bool kept, const char* broken) {
    if (!kept && why_ == nullptr) why_ = broken;
  }
  bool is_good() const { return why_ == nullptr; }
  /// The first fault; null: none.
  const char* why() const { return why_; }
  std::size_t position() const { return at_; }

 private:
  std::span<const std::byte> take(std::size_t n) {
    require(n <= bytes_.size() - at_, "cut short");
    if (!is_good()) return {};
    at_ += n;
    return bytes_.subspan(at_ - n, n);
  }
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  const char* why_ = nullptr;
};

}  // namespace chimera
