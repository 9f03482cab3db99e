// SPDX-License-Identifier: Apache-2.0
// The named extras of a port and of a component: `initial = 0.0`, `range(-1, 1)`, `safety`, `frame = "base"`,
// `doc = "..."`, `type = "T"`, `at_least = "low"`, `one_of = "sine square"`, `configuration`, `safe_state`,
// `shared`;
// `rate = 1000.0`, `source = "..."`.
#pragma once

#include <concepts>
#include <cstddef>
#include <initializer_list>
#include <string_view>
#include <type_traits>

namespace chimera {
namespace component_api {

/// A string literal: it lives as long as the component's object. Text made at run time does not compile here.
struct Literal {
  consteval Literal(const char* literal) : text(literal) {}  // NOLINT: a literal is one
  const char* text;
};

/// If the compiler evaluates a call of this function, compilation ends at the line with the reason. Has no body.
void refused(const char* why);

/// [a-z][a-z0-9_]*, at most 64 letters, for the first `size` characters.
consteval void check_name(const char* name, std::size_t size) {
  if (size == 0 || size > 64 || *name < 'a' || *name > 'z')
    refused("a name begins with a small letter: \"r\", not \"R\"");
  for (std::size_t i = 0; i < size; ++i) {
    const char c = name[i];
    if (!(c >= 'a' && c <= 'z') && !(c >= '0' && c <= '9') && c != '_')
      refused("a name has small letters, digits and '_' only");
  }
}

/// The name of a port or of a component.
struct PortName {
  consteval PortName(const char* literal) : text(literal) {  // NOLINT: a literal is a name
    check_name(literal, std::char_traits<char>::length(literal));
  }
  const char* text;
};

/// The name of a repeated port: ends in '*', which is not part of the names of its instances.
struct RepeatedName {
  consteval RepeatedName(const char* literal) : text(literal) {  // NOLINT: a literal is a name
    const std::size_t size = std::char_traits<char>::length(literal);
    if (size == 0 || literal[size - 1] != '*') refused("the name of a repeated port ends in '*'");
    check_name(literal, size - 1);
  }
  const char* text;
};

struct OptionBase {};
template <class T>
concept Option = std::derived_from<T, OptionBase>;

/// Options live during the constructor call that uses them, so they may point at temporaries.
template <class V>
struct InitialIs : OptionBase {
  explicit InitialIs(const V& v) : value(v) {}
  const V& value;
};
template <class V>
struct InitialListIs : OptionBase {
  explicit InitialListIs(std::initializer_list<V> v) : values(v) {}
  std::initializer_list<V> values;
};
struct RangeIs : OptionBase {
  RangeIs(double low, double high) : min(low), max(high) {}
  double min, max;
};
struct SafetyIs : OptionBase {};
struct ConfigurationIs : OptionBase {};
struct SafeStateIs : OptionBase {};
struct SharedIs : OptionBase {};
struct IntermittentIs : OptionBase {};
struct FrameIs : OptionBase {
  explicit constexpr FrameIs(const char* t) : text(t) {}
  const char* text;
};
struct DocIs : OptionBase {
  explicit constexpr DocIs(const char* t) : text(t) {}
  const char* text;
};
struct TypeIs : OptionBase {
  explicit constexpr TypeIs(const char* t) : text(t) {}
  const char* text;
};
struct AtLeastIs : OptionBase {
  explicit constexpr AtLeastIs(const char* p) : port(p) {}
  const char* port;
};
struct OneOfIs : OptionBase {
  explicit constexpr OneOfIs(const char* w) : words(w) {}
  const char* words;
};
struct RateIs {
  double hertz;
};
struct SourceIs {
  const char* text;
};

struct InitialName {
  template <class V>
  InitialIs<V> operator=(const V& value) const { return InitialIs<V>(value); }  // NOLINT: reads as a name
  template <class V>
  InitialListIs<V> operator=(std::initializer_list<V> values) const { return InitialListIs<V>(values); }  // NOLINT
};
struct FrameName {
  constexpr FrameIs operator=(Literal t) const { return FrameIs(t.text); }  // NOLINT
};
struct DocName {
  constexpr DocIs operator=(Literal t) const { return DocIs(t.text); }  // NOLINT
};
struct TypeName {
  constexpr TypeIs operator=(Literal t) const { return TypeIs(t.text); }  // NOLINT
};
struct AtLeastName {
  constexpr AtLeastIs operator=(PortName p) const { return AtLeastIs(p.text); }  // NOLINT
};
struct OneOfName {
  constexpr OneOfIs operator=(Literal words) const { return OneOfIs(words.text); }  // NOLINT
};
struct RateName {
  constexpr RateIs operator=(double hertz) const { return {hertz}; }  // NOLINT
};
struct SourceName {
  constexpr SourceIs operator=(Literal t) const { return {t.text}; }  // NOLINT
};

/// The names are in a namespace of their own, so that a variable called `rate` elsewhere in chimera hides none of them.
namespace names {
inline constexpr InitialName initial{};  ///< out-var: value at spawn; in-const: default if the description gives none
inline constexpr SafetyIs safety{};      ///< never publishes NaN, infinity or a value outside range()
inline constexpr FrameName frame{};      ///< reference frame of the values
inline constexpr DocName doc{};          ///< one sentence for the data sheet
inline constexpr TypeName type{};        ///< name of the type variable of an Any port ("T" if not given)
inline constexpr AtLeastName at_least{};  ///< in-const: the in-const that no element of this one is below
inline constexpr OneOfName one_of{};      ///< in-const of text: the legal words, with spaces between them
inline constexpr ConfigurationIs configuration{};  ///< in-const of text: names a configuration, or is empty
inline constexpr SafeStateIs safe_state{};  ///< bool out-var: the device obeys the flag; resource: it never moves
inline constexpr SharedIs shared{};  ///< resource: several tasks may open it together
inline constexpr IntermittentIs intermittent{};  ///< in-var: a configuration may lack a producer
inline constexpr RateName rate{};         ///< CHIMERA_COMPONENT: default rate in Hz
inline constexpr SourceName source{};     ///< CHIMERA_COMPONENT: the paper or book behind it

/// The legal values of this port, in its unit, ends included.
inline RangeIs range(double min, double max) { return RangeIs(min, max); }
}  // namespace names
}  // namespace component_api

using namespace component_api::names;

}  // namespace chimera
