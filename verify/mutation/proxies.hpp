#pragma once
/// @file
/// What verify/mutation/instrument.py writes into a copy of the headers: each `a + b` becomes
/// `a + Add{17} + b`. The first operator returns its left operand half applied, the second applies
/// it: as written, or as the mutant says whose site 17 is. The operator is the same on both sides,
/// so precedence and associativity stay as they were. Includes nothing of the library, for its
/// lowest header includes this. Theory: verify/mutation/README.md.

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <type_traits>
#include <utility>

#define CROSSBEAM_PROXY [[gnu::always_inline]] inline

namespace crossbeam::mutation {

/// One flag per site; 0: as written, and nobody looks further.
inline constexpr int most_sites = 100000;
extern unsigned char flag[most_sites];
/// Notes that the site was reached. Returns its variant, 0 for as written.
int reached(int site);
/// The variant makes no sense for the types at hand.
void not_applicable();
void applied(bool differs);

/// A negative number stands in a constexpr function: as written where the compiler evaluates it.
CROSSBEAM_PROXY constexpr int variant(int site) {
  if (site < 0) {
    if (std::is_constant_evaluated()) return 0;
    site = -site;
  }
  return __builtin_expect(flag[site] != 0, 0) ? reached(site) : 0;
}

/// Values, not expressions that refer to operands.
template <class X>
CROSSBEAM_PROXY constexpr auto plain(X&& x) {
  if constexpr (requires { x.eval(); })
    return x.eval();
  else
    return std::decay_t<X>(std::forward<X>(x));
}
template <class X>
using plain_t = decltype(plain(std::declval<X>()));

template <class V>
constexpr bool differs(const V& a, const V& b) {
  if constexpr (requires {
                  { a == b } -> std::same_as<bool>;
                })
    return !(a == b);
  else
    return true;  // lanes, matrices: not looked into
}

/// `x` as a V, where that is the same kind of thing; nothing is converted to or from text.
template <class V, class X>
inline constexpr bool same_kind =
    !requires(V v) { v.c_str(); } &&
    (std::is_same_v<V, X> || (
                                 std::is_arithmetic_v<X> && !requires(V v) { v.rows(); } &&
                                 !requires(V v) { v.x; } && std::is_convertible_v<X, V>));

template <class V, class X>
constexpr V mutant(const V& original, const X& x) {
  if constexpr (same_kind<V, plain_t<const X&>>) {
    const V changed(plain(x));
    applied(differs(original, changed));
    return changed;
  } else {
    not_applicable();
    return original;
  }
}
/// One operand is left out: the right one where the left one has the type of the result.
template <class V, class L, class R>
constexpr V dropped(const V& original, const L& l, const R& r) {
  if constexpr (same_kind<V, plain_t<const L&>>)
    return mutant(original, l);
  else
    return mutant(original, r);
}

/// L is const where the operand is: an array decays to a pointer as it would without the proxy.
template <class Op, class L>
struct Half {
  L& l;
  int site;
};

/// A proxy for the binary operator `op`: variant 1 is `first`, variant 2 is `second`, expressions in
/// l, r and the original value v.
#define CROSSBEAM_MUTATION(Name, op, first, second)                                         \
  struct Name {                                                                             \
    int site;                                                                               \
    template <class V, class L, class R>                                                    \
    [[gnu::noinline, gnu::cold]] static constexpr V changed(int which, V v, L l, R r) {     \
      if (which == 1) {                                                                     \
        if constexpr (requires { first; }) return first;                                    \
      } else {                                                                              \
        if constexpr (requires { second; }) return second;                                  \
      }                                                                                     \
      not_applicable();                                                                     \
      return v;                                                                             \
    }                                                                                       \
    template <class L>                                                                      \
    CROSSBEAM_PROXY friend constexpr Half<Name, std::remove_reference_t<L>> operator op(    \
        L&& l, Name proxy) {                                                                \
      return {l, proxy.site};                                                               \
    }                                                                                       \
  };                                                                                        \
  template <class L, class R>                                                               \
  CROSSBEAM_PROXY constexpr auto operator op(Half<Name, L>&& half, const R& r) {            \
    auto v = plain(half.l op r);                                                            \
    if (const int which = variant(half.site))                                               \
      return Name::template changed<decltype(v), std::decay_t<L&>, std::decay_t<const R&>>( \
          which, v, half.l, r);                                                             \
    return v;                                                                               \
  }

CROSSBEAM_MUTATION(Add, +, mutant(v, l - r), dropped(v, l, r))
CROSSBEAM_MUTATION(Sub, -, mutant(v, l + r), dropped(v, l, r))
CROSSBEAM_MUTATION(Mul, *, mutant(v, l / r), dropped(v, l, r))
CROSSBEAM_MUTATION(Div, /, mutant(v, l* r), dropped(v, l, r))
CROSSBEAM_MUTATION(Mod, %, mutant(v, l / r), dropped(v, l, r))
CROSSBEAM_MUTATION(BitAnd, &, mutant(v, l | r), dropped(v, l, r))
CROSSBEAM_MUTATION(BitOr, |, mutant(v, l& r), dropped(v, l, r))
CROSSBEAM_MUTATION(ShiftLeft, <<, mutant(v, l >> r), dropped(v, l, r))
CROSSBEAM_MUTATION(ShiftRight, >>, mutant(v, l << r), dropped(v, l, r))
CROSSBEAM_MUTATION(Less, <, mutant(v, l <= r), mutant(v, l >= r))
CROSSBEAM_MUTATION(LessEqual, <=, mutant(v, l < r), mutant(v, l > r))
CROSSBEAM_MUTATION(Greater, >, mutant(v, l >= r), mutant(v, l <= r))
CROSSBEAM_MUTATION(GreaterEqual, >=, mutant(v, l > r), mutant(v, l < r))
CROSSBEAM_MUTATION(Equal, ==, mutant(v, l != r), mutant(v, l != r))
CROSSBEAM_MUTATION(NotEqual, !=, mutant(v, l == r), mutant(v, l == r))
// In the head of a for loop: one turn less, and none. (One more would read beyond arrays.)
CROSSBEAM_MUTATION(LoopLess, <, mutant(v, l + 1 < r), mutant(v, false))
CROSSBEAM_MUTATION(LoopLessEqual, <=, mutant(v, l < r), mutant(v, false))
CROSSBEAM_MUTATION(LoopGreaterEqual, >=, mutant(v, l > r), mutant(v, false))
#undef CROSSBEAM_MUTATION

// Prefix operators, written with ->*, which binds tighter than every binary operator.
template <class V, class X>
[[gnu::noinline, gnu::cold]] constexpr V changed_to(V v, X x) {
  return mutant(v, x);
}
struct Minus {
  int site;
};
template <class X>
CROSSBEAM_PROXY constexpr auto operator->*(Minus proxy, const X& x) {
  auto v = plain(-x);
  if (variant(proxy.site)) return changed_to<decltype(v), X>(v, x);
  return v;
}
struct Not {
  int site;
};
template <class X>
CROSSBEAM_PROXY constexpr auto operator->*(Not proxy, const X& x) {
  auto v = plain(!x);
  if (variant(proxy.site)) {
    if constexpr (std::is_same_v<decltype(v), bool>)
      return changed_to<bool, bool>(v, static_cast<bool>(x));
    else
      return changed_to<decltype(v), X>(v, x);
  }
  return v;
}
/// `x.transpose() ->* Transposed{7}`
struct Transposed {
  int site;
};
template <class X>
CROSSBEAM_PROXY constexpr auto operator->*(const X& x, Transposed proxy) {
  auto v = plain(x);
  if (variant(proxy.site)) {
    if constexpr (int(X::RowsAtCompileTime) == int(X::ColsAtCompileTime))
      return changed_to<decltype(v), decltype(v)>(v, plain(x.transpose()));
    not_applicable();
  }
  return v;
}
/// `x += Increment{7} *= y`
struct Increment {
  int site;
};
template <class Y>
CROSSBEAM_PROXY constexpr auto operator*=(Increment proxy, const Y& y) {
  auto v = plain(y);
  if (const int which = variant(proxy.site)) {
    if constexpr (requires { v - v; }) {
      const decltype(v) none = plain(v - v);
      return changed_to<decltype(v), decltype(v)>(v, which == 1 ? decltype(v)(none - v) : none);
    }
    not_applicable();
  }
  return v;
}

/// A mask of lanes, or a bool.
template <class C>
inline constexpr bool is_mask = !std::is_arithmetic_v<C> && requires(const C& c) {
  { c || !c } -> std::same_as<C>;
};
template <class C>
using condition_t = std::conditional_t<is_mask<C>, C, bool>;

/// `a && b` becomes `(True{7, 1} || (a)) && (True{7, 2} || (b))`: mutant 1 forgets a, mutant 2 b, and b
/// is still looked at only where a holds. `a || b` likewise with False and &&.
struct True {
  int site, which;
  template <class C>
  CROSSBEAM_PROXY friend constexpr condition_t<C> operator||(True proxy, const C& c) {
    condition_t<C> v = static_cast<condition_t<C>>(c);
    if (variant(proxy.site) == proxy.which) return changed_to<condition_t<C>>(v, v || !v);
    return v;
  }
};
struct False {
  int site, which;
  template <class C>
  CROSSBEAM_PROXY friend constexpr condition_t<C> operator&&(False proxy, const C& c) {
    condition_t<C> v = static_cast<condition_t<C>>(c);
    if (variant(proxy.site) == proxy.which) return changed_to<condition_t<C>>(v, v && !v);
    return v;
  }
};

/// `if (c || Choice{7})`, `c || Choice{7} ? a : b`: the other way.
struct Choice {
  int site;
  template <class C>
  CROSSBEAM_PROXY friend constexpr auto operator||(const C& c, Choice proxy) {
    constexpr bool lanes = requires {
      { c == 0 } -> std::same_as<C>;
    } && !std::is_arithmetic_v<C>;
    using V = std::conditional_t<lanes, C, bool>;
    V v = static_cast<V>(c);
    if (variant(proxy.site)) {
      applied(true);
      if constexpr (lanes)
        v = (c == 0);
      else
        v = !v;
    }
    return v;
  }
};

/// `if (kept(7)) statement;`
CROSSBEAM_PROXY constexpr bool kept(int site) {
  if (!variant(site)) return true;
  applied(true);
  return false;
}

template <class X>
CROSSBEAM_PROXY constexpr X constant(int site, X as_written, X changed) {
  if (variant(site)) {
    applied(true);
    return changed;
  }
  return as_written;
}

/// Another variable of the same type.
template <class X, class Y>
CROSSBEAM_PROXY constexpr decltype(auto) twin(int site, X& x, [[maybe_unused]] Y& y) {
  if constexpr (std::is_same_v<X, Y>) {
    if (variant(site)) {
      applied(differs(x, y));
      return static_cast<X&>(y);
    }
  } else {
    if (variant(site)) not_applicable();
  }
  return static_cast<X&>(x);
}

}  // namespace crossbeam::mutation
