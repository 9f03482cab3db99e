// SPDX-License-Identifier: Apache-2.0
// The facts about a port that follow from its type alone, without names, units and texts: constants of an image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <tuple>

#include "chimera/task/abi.h"
#include "chimera/task/fields.h"

namespace chimera {

/// One field of a struct element. Members as in chimera_field.
struct FieldForm {
  std::uint32_t type = CHIMERA_BOOL;
  std::uint32_t offset = 0;  ///< bytes from the start of the element
  std::uint32_t count = 1;
  std::uint32_t size = 1;  ///< bytes of one element of the field
};

/// A port without its names. Members as in chimera_port_decl.
struct PortForm {
  std::uint32_t element_size;
  std::uint8_t kind;
  std::uint8_t type;
  std::uint8_t max_instances;  ///< 0: not repeated
  std::uint8_t n_fields;
  FieldForm (*field)(std::uint32_t index) noexcept;  ///< index < n_fields; null if n_fields is 0
};

namespace component_api {

/// Bytes between the instance counter of a repeated port and its array of live halves, which follows it.
inline constexpr std::uint32_t kCounterToArray = alignof(chimera_port);

template <class S, class Member>
std::uint32_t offset_of(Member S::*member) noexcept {
  alignas(S) const std::byte room[sizeof(S)] = {};
  const auto* const sample = reinterpret_cast<const S*>(room);
  return static_cast<std::uint32_t>(reinterpret_cast<const std::byte*>(&(sample->*member)) - room);
}

template <class S, class Member>
FieldForm form_of_field(Member S::*member) noexcept {
  using Element = std::remove_all_extents_t<Member>;
  return {element_type<Element>(), offset_of(member), sizeof(Member) / sizeof(Element), sizeof(Element)};
}

/// Field `index` of struct S; index < kFieldCount<S>. Context: any; wait-free.
template <class S>
FieldForm field_form(std::uint32_t index) noexcept {
  FieldForm found;
  std::uint32_t i = 0;
  std::apply([&](const auto&... one) {
    ((i++ == index ? static_cast<void>(found = form_of_field(one.member)) : static_cast<void>(0)), ...);
  }, Fields<S>::list);
  return found;
}

/// N: the most instances of a repeated port; 0 for any other port.
template <class T, std::uint32_t Kind, std::uint32_t N>
constexpr PortForm port_form() noexcept {
  using E = typename PortType<T>::Element;
  PortForm form{8, Kind, static_cast<std::uint8_t>(element_type<E>()), N, 0, nullptr};
  if constexpr (!std::is_same_v<E, Any>) form.element_size = sizeof(E);
  if constexpr (element_type<E>() == CHIMERA_STRUCT) {
    static_assert(kFieldCount<E> <= UINT8_MAX, "a struct that a port carries has at most 255 fields");
    form.n_fields = kFieldCount<E>;
    form.field = &field_form<E>;
  }
  return form;
}

template <class T, std::uint32_t Kind, std::uint32_t N>
inline constexpr PortForm kPortForm = port_form<T, Kind, N>();

}  // namespace component_api
}  // namespace chimera
