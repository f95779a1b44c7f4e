// SPDX-License-Identifier: Apache-2.0
// For scripts/mutate: one program with many mutants of a source. The environment variable GRAZE_MUTANT selects one by
// its number. A switch is inserted beside a token such that precedence does not change: `a < b` becomes `a <
// graze_mutant::Switch<7>{} < b`. In constant expressions, every mutant is off.
#pragma once

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <type_traits>

namespace graze_mutant {

constexpr int kNotSwitched = 98;  // exit status: the chosen mutant does not compile with a switch; build it separately

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
inline Asked asked;  // initialised before everything in the source, because this header comes first
// Always inlined, even in unoptimised code, because switches are in the innermost loops.
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

// Switches at a unary operator, as in Not<7>{}->*!x. The right operand of ->* is the unary expression, nothing more.
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
