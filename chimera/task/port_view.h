// SPDX-License-Identifier: Apache-2.0
// How the values of a port are reached: by shape (one value, a list, a matrix) or as bytes (any type).
// A view is nothing but the live half of the port (chimera_port), which the framework fills between methods: do not
// keep pointers or spans from one method to the next.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#ifdef __cpp_exceptions
#include <cstdio>
#include <stdexcept>
#endif

#include "chimera/base/assert.h"
#include "chimera/task/abi.h"
#include "chimera/task/fields.h"

namespace chimera::component_api {

/// Ends the method with a fault that says so. (Where exceptions are not built, the process ends.)
[[noreturn]] inline void index_beyond(std::size_t index, std::size_t size) {
#ifdef __cpp_exceptions
  char text[80];
  std::snprintf(text, sizeof(text), "index %zu of a port that has %zu", index, size);
  throw std::out_of_range(text);
#else
  static_cast<void>(index), static_cast<void>(size);
  assertion_failed("index < size", __FILE__, __LINE__);
#endif
}

inline void check_index(std::size_t index, std::size_t size) {
  if (index >= size) [[unlikely]] index_beyond(index, size);
}

/// The live half; not copyable, because the framework knows its place.
class PortBase {
 public:
  PortBase(const PortBase&) = delete;
  PortBase& operator=(const PortBase&) = delete;
  /// As the framework knows the port.
  const chimera_port* live() const noexcept { return &live_; }

 protected:
  PortBase() noexcept = default;
  chimera_port live_{};
};

/// One value.
template <class E>
class ScalarView : public PortBase {
 public:
  E& operator*() const noexcept { return *static_cast<E*>(live_.value); }
  E* operator->() const noexcept { return static_cast<E*>(live_.value); }
};

/// A list; size() is the extent in use, fixed at init. Indexes are checked, span() and iteration are not.
template <class E>
class VectorView : public PortBase {
 public:
  std::size_t size() const noexcept { return live_.count; }
  E* begin() const noexcept { return static_cast<E*>(live_.value); }
  E* end() const noexcept { return begin() + live_.count; }
  std::span<E> span() const noexcept { return {begin(), size()}; }
  operator std::span<E>() const noexcept { return span(); }  // NOLINT: a list is a span
  E& operator[](std::size_t i) const {
    check_index(i, size());
    return begin()[i];
  }
};

/// Rows and columns, row by row in memory without gaps. Indexes are checked, rows and span() are not.
template <class E>
class MatrixView : public PortBase {
 public:
  std::size_t rows() const noexcept { return live_.extent[0]; }
  std::size_t columns() const noexcept { return live_.extent[1]; }
  std::size_t size() const noexcept { return live_.count; }
  std::span<E> span() const noexcept { return {static_cast<E*>(live_.value), live_.count}; }
  std::span<E> operator[](std::size_t row) const {
    check_index(row, rows());
    return span().subspan(row * columns(), columns());
  }
  E& operator()(std::size_t row, std::size_t column) const {
    check_index(column, columns());
    return (*this)[row][column];
  }
};

/// Values whose type the component does not know.
template <class Byte>
class AnyView : public PortBase {
 public:
  std::size_t size() const noexcept { return live_.count; }
  std::size_t element_size() const noexcept { return live_.element_size; }
  /// CHIMERA_BOOL to CHIMERA_STRUCT, as verification found it.
  std::uint32_t element_type() const noexcept { return live_.type; }
  std::span<Byte> bytes() const noexcept {
    return {static_cast<Byte*>(live_.value), std::size_t{live_.count} * live_.element_size};
  }
};

template <class T, bool kReadOnly>
struct ViewOf {
  using Element = typename PortType<T>::Element;
  using E = std::conditional_t<kReadOnly, const Element, Element>;
  static auto choose() {
    if constexpr (std::is_same_v<Element, Any>)
      return std::type_identity<AnyView<std::conditional_t<kReadOnly, const std::byte, std::byte>>>{};
    else if constexpr (PortType<T>::kRank == 0) return std::type_identity<ScalarView<E>>{};
    else if constexpr (PortType<T>::kRank == 1) return std::type_identity<VectorView<E>>{};
    else return std::type_identity<MatrixView<E>>{};
  }
  using type = typename decltype(choose())::type;
};

template <class T, bool kReadOnly>
using View = typename ViewOf<T, kReadOnly>::type;

}  // namespace chimera::component_api
