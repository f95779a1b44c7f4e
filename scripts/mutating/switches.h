// SPDX-License-Identifier: Apache-2.0
// For scripts/mutate: many mutants of a source in one program, of which the environment variable GRAZE_MUTANT switches
// on one, by its number. Switches stand beside a token so that what binds to it stays the same. `a < b` becomes
// `a < graze_mutant::Switch<7>{} < b`. In constant expressions every mutant is off.
#pragma once

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <type_traits>

namespace graze_mutant {

constexpr int kNotSwitched = 98;  // exit status: switched on, this one does not compile; it has to be tried by itself

struct Asked {
  bool of[8192] = {};
  int chosen = std::getenv("GRAZE_MUTANT") ? std::atoi(std::getenv("GRAZE_MUTANT")) : -1;
  ~Asked() {
    const char* name = std::getenv("GRAZE_MUTANTS_ASKED");
    std::FILE* file = name ? std::fopen(name, "a") : nullptr;
    if (!file) return;
    for (int id = 0; id < 8192; ++id) {
      if (of[id]) std::fprintf(file, "%d\n", id);
    }
    std::fclose(file);
  }
};
inline Asked asked;  // before all that a source initialises, as this header comes first
// Unoptimised code as well: a switch stands in the innermost loops.
#define GRAZE_INLINE [[gnu::always_inline]]
GRAZE_INLINE inline bool is_chosen(int id) {
  asked.of[id] = true;
  return asked.chosen == id;
}
GRAZE_INLINE constexpr bool on(int id) { return std::is_constant_evaluated() ? false : is_chosen(id); }

template <int id>
struct Switch {};
template <class Left, int id>
struct Half {
  Left&& left;
};

#define GRAZE_BINARY(op, other)                                                           \
  template <class Left, int id>                                                           \
  GRAZE_INLINE constexpr Half<Left, id> operator op(Left&& left, Switch<id>) {            \
    return {static_cast<Left&&>(left)};                                                   \
  }                                                                                       \
  template <class Left, int id, class Right>                                              \
  GRAZE_INLINE constexpr decltype(auto) operator op(Half<Left, id> half, Right&& right) { \
    using Result = decltype(half.left op right);                                          \
    if (on(id)) {                                                                         \
      if constexpr (requires { static_cast<Result>(half.left other right); })             \
        return static_cast<Result>(half.left other right);                                \
      else                                                                                \
        std::_Exit(kNotSwitched);                                                         \
    }                                                                                     \
    return static_cast<Result>(half.left op right);                                       \
  }
GRAZE_BINARY(<, <=)
GRAZE_BINARY(<=, <)
GRAZE_BINARY(>, >=)
GRAZE_BINARY(>=, >)
GRAZE_BINARY(==, !=)
GRAZE_BINARY(!=, ==)
GRAZE_BINARY(+, -)
GRAZE_BINARY(-, +)
GRAZE_BINARY(*, +)
GRAZE_BINARY(&, |)
GRAZE_BINARY(|, &)
GRAZE_BINARY(<<, >>)
GRAZE_BINARY(>>, <<)

#define GRAZE_ASSIGNMENT(op, other)                                               \
  template <class Right, int id>                                                  \
  GRAZE_INLINE constexpr Half<Right, id> operator op(Switch<id>, Right&& right) { \
    return {static_cast<Right&&>(right)};                                         \
  }                                                                               \
  template <class Left, class Right, int id>                                      \
  GRAZE_INLINE constexpr Left& operator op(Left& left, Half<Right, id> right) {   \
    if (!on(id)) return left op right.left, left;                                 \
    if constexpr (requires { left other right.left; })                            \
      return left other right.left, left;                                         \
    else                                                                          \
      std::_Exit(kNotSwitched);                                                   \
  }
GRAZE_ASSIGNMENT(+=, -=)
GRAZE_ASSIGNMENT(-=, +=)
GRAZE_ASSIGNMENT(&=, |=)
GRAZE_ASSIGNMENT(|=, &=)

// Before a unary operator, to whose result they bind closer than any binary one.
template <int id>
struct Not {};
template <int id>
struct Minus {};
template <int id, bool up>
struct Step {};
template <int id, class Value>
GRAZE_INLINE constexpr bool operator->*(Not<id>, Value&& value) {
  return on(id) ? !static_cast<bool>(value) : static_cast<bool>(value);
}
template <int id, class Value>
GRAZE_INLINE constexpr Value operator->*(Minus<id>, const Value& value) {
  return on(id) ? static_cast<Value>(-value) : value;
}
template <int id, bool up, class Value>
GRAZE_INLINE constexpr Value& operator->*(Step<id, up>, Value& value) {
  return on(id) != up ? ++value : --value;
}

template <int id, class... Values>
GRAZE_INLINE constexpr auto min(const Values&... values) {
  return on(id) ? std::max(values...) : std::min(values...);
}
template <int id, class... Values>
GRAZE_INLINE constexpr auto max(const Values&... values) {
  return on(id) ? std::min(values...) : std::max(values...);
}

}  // namespace graze_mutant
