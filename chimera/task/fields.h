// SPDX-License-Identifier: Apache-2.0
// Decides which C++ types may be the element of a port, and declares each. A type may cross processes if its bytes mean
// the same in all of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <tuple>
#include <type_traits>

#include "chimera/task/abi.h"
#include "chimera/task/text.h"

namespace chimera {

/// A type variable: the port accepts each element type that verification finds for it, as bytes.
struct Any {};
/// Marks a port of two dimensions; the shape gives its extents: In<Matrix<double>>.
template <class T>
struct Matrix;

/// Names and units of the members of a struct that a port carries. Specialise it beside the struct:
///   template <> struct chimera::Fields<Battery> {
///     static constexpr const char* name = "battery";
///     static constexpr auto list = std::tuple{chimera::field("voltage", "V", &Battery::voltage), ...};
///   };
template <class T>
struct Fields;

template <class Struct, class Member>
struct FieldOf {
  const char* name;
  const char* unit;
  Member Struct::*member;
};

/// One member of a struct, with its unit. Members are scalars, Text<N>, or arrays of these.
template <class Struct, class Member>
constexpr FieldOf<Struct, Member> field(const char* name, const char* unit, Member Struct::*member) {
  return {name, unit, member};
}

namespace component_api {

template <class T>
inline constexpr bool kIsText = false;
template <std::size_t N>
inline constexpr bool kIsText<Text<N>> = true;

template <class T>
concept HasFields = requires { Fields<T>::name; Fields<T>::list; };

/// The ABI element type of a scalar or text; CHIMERA_STRUCT for all others.
template <class T>
constexpr std::uint32_t element_type() {
  if constexpr (std::is_same_v<T, bool>) return CHIMERA_BOOL;
  else if constexpr (std::is_integral_v<T> && std::is_signed_v<T> && sizeof(T) == 4) return CHIMERA_INT32;
  else if constexpr (std::is_integral_v<T> && std::is_signed_v<T> && sizeof(T) == 8) return CHIMERA_INT64;
  else if constexpr (std::is_same_v<T, float>) return CHIMERA_FLOAT32;
  else if constexpr (std::is_same_v<T, double>) return CHIMERA_FLOAT64;
  else if constexpr (kIsText<T>) return CHIMERA_STRING;
  else if constexpr (std::is_same_v<T, Any>) return CHIMERA_ANY;
  else return CHIMERA_STRUCT;
}

/// Explains in a sentence why T cannot be the element of a port.
template <class T>
constexpr bool check_element() {
  static_assert(!std::is_pointer_v<T> && !std::is_member_pointer_v<T> && !std::is_reference_v<T>,
                "a port cannot carry a pointer: it means nothing in another process");
  static_assert(!std::is_arithmetic_v<T> || element_type<T>() != CHIMERA_STRUCT,
                "a port carries bool, int32, int64, float or double: no other number type is known everywhere");
  if constexpr (!std::is_same_v<T, Any>) {
    static_assert(std::is_trivially_copyable_v<T>,
                  "a port cannot carry this type: it keeps its value elsewhere or needs a constructor to be copied; "
                  "use Text<N> for text, T[N] for a list, or a plain struct");
    static_assert(!std::is_enum_v<T>, "a port cannot carry an enum: use std::int32_t and say the values in doc");
    if constexpr (std::is_class_v<T> && !kIsText<T>) {
      static_assert(HasFields<T>, "a struct needs names and units for its members to go through a port: "
                                  "specialise chimera::Fields for it");
    }
  }
  return true;
}

template <class Member>
chimera_field describe_field(const char* name, const char* unit, std::size_t offset) {
  using Element = std::remove_all_extents_t<Member>;
  static_assert(std::is_trivially_copyable_v<Member>, "a member of a struct port must be plain bytes");
  static_assert(element_type<Element>() <= CHIMERA_STRING, "a member of a struct port is a number, a bool or a "
                                                           "Text<N>, or an array of these");
  chimera_field made{};
  made.name = name;
  made.unit = unit;
  made.type = element_type<Element>();
  made.offset = static_cast<std::uint32_t>(offset);
  constexpr std::size_t size = sizeof(Element);
  made.count = static_cast<std::uint32_t>(sizeof(Member) / size);
  made.size = static_cast<std::uint32_t>(size);
  return made;
}

template <class S>
inline constexpr std::size_t kFieldCount = std::tuple_size_v<std::remove_cvref_t<decltype(Fields<S>::list)>>;

/// The fields of S for the declaration; made once. Context: setup.
template <class S>
const chimera_field* fields_of() {
  static chimera_field made[kFieldCount<S>];
  const S sample{};
  const auto* base = reinterpret_cast<const std::byte*>(&sample);
  std::size_t i = 0;
  std::apply([&](const auto&... one) {
    ((made[i++] = describe_field<std::remove_cvref_t<decltype(sample.*(one.member))>>(
          one.name, one.unit,
          static_cast<std::size_t>(reinterpret_cast<const std::byte*>(&(sample.*(one.member))) - base))), ...);
  }, Fields<S>::list);
  return made;
}

/// Decimal text of a shape, made at compile time: "[6]", "[3][3]".
template <std::size_t... N>
struct ShapeText {
  static constexpr auto make() {
    struct { char text[2 * 12 + 1] = {}; } out;
    std::size_t at = 0;
    auto put = [&](std::size_t n) {
      char digits[20] = {};
      std::size_t used = 0;
      do { digits[used++] = static_cast<char>('0' + n % 10); n /= 10; } while (n != 0);
      out.text[at++] = '[';
      while (used != 0) out.text[at++] = digits[--used];
      out.text[at++] = ']';
    };
    (put(N), ...);
    return out;
  }
  static constexpr auto kMade = make();
};

/// Splits the T of In<T> into element and shape. `kRank` dimensions; `kOpen`: the declaration needs a shape text.
template <class T>
struct PortType {
  using Element = T;
  static constexpr int kRank = 0;
  static constexpr bool kOpen = false;
  static constexpr const char* kShape = "";
};
template <class T>
struct PortType<T[]> : PortType<T> {
  static constexpr int kRank = 1;
  static constexpr bool kOpen = true;
};
template <class T, std::size_t N>
struct PortType<T[N]> : PortType<T> {
  static constexpr int kRank = 1;
  static constexpr const char* kShape = ShapeText<N>::kMade.text;
};
template <class T, std::size_t N, std::size_t M>
struct PortType<T[N][M]> : PortType<T> {
  static constexpr int kRank = 2;
  static constexpr const char* kShape = ShapeText<N, M>::kMade.text;
};
template <class T>
struct PortType<Matrix<T>> : PortType<T> {
  static constexpr int kRank = 2;
  static constexpr bool kOpen = true;
};

}  // namespace component_api
}  // namespace chimera
