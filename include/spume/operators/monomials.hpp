// SPDX-License-Identifier: MIT
// Monomials of two or three coordinates in graded order, with the tables that let a compiler unroll their evaluation.
#pragma once

#include <array>
#include <cstddef>
#include <utility>

namespace spume {

// Number of monomials of `dimensions` coordinates up to `degree`.
constexpr std::size_t monomial_count(int dimensions, int degree) {
  std::size_t count = 1;
  for (int d = 1; d <= dimensions; ++d)
    count = count * static_cast<std::size_t>(degree + d) / static_cast<std::size_t>(d);
  return count;
}

// The monomials x^a y^b z^c with a + b + c <= Degree, ordered by degree: the first monomial_count(D, d) of them are the
// monomials up to degree d, the first one is 1.
template <int Dimensions, int Degree>
class Monomials {
 public:
  static constexpr std::size_t size = monomial_count(Dimensions, Degree);
  using Exponents = std::array<int, Dimensions>;

  static constexpr std::array<Exponents, size> exponents = [] {
    std::array<Exponents, size> list{};
    std::size_t n = 0;
    for (int degree = 0; degree <= Degree; ++degree)
      for (int a = degree; a >= 0; --a) {
        if constexpr (Dimensions == 2) {
          list[n++] = {a, degree - a};
        } else {
          for (int b = degree - a; b >= 0; --b) list[n++] = {a, b, degree - a - b};
        }
      }
    return list;
  }();

  static constexpr std::size_t find(const Exponents& wanted) {
    std::size_t n = 0;
    while (exponents[n] != wanted) ++n;
    return n;
  }

  // Calls use(n, value) for the first `Count` monomials at the point `x` times `scale`, n a std::integral_constant.
  template <std::size_t Count, class Real, class Use>
  static void for_each(const std::array<Real, Dimensions>& x, Real scale, Use&& use) {
    std::array<Real, Count> value;
    value[0] = scale;
    use(std::integral_constant<std::size_t, 0>{}, value[0]);
    [&]<std::size_t... n>(std::index_sequence<n...>) {
      ((value[n + 1] = value[parent[n + 1]] * x[axis[n + 1]],
        use(std::integral_constant<std::size_t, n + 1>{}, value[n + 1])),
       ...);
    }
    (std::make_index_sequence<Count - 1>{});
  }

 private:
  // Monomial n is monomial parent[n] times coordinate axis[n].
  static constexpr std::array<std::size_t, size> axis = [] {
    std::array<std::size_t, size> list{};
    for (std::size_t n = 1; n < size; ++n)
      while (exponents[n][list[n]] == 0) ++list[n];
    return list;
  }();
  static constexpr std::array<std::size_t, size> parent = [] {
    std::array<std::size_t, size> list{};
    for (std::size_t n = 1; n < size; ++n) {
      Exponents reduced = exponents[n];
      --reduced[axis[n]];
      list[n] = find(reduced);
    }
    return list;
  }();
};

}  // namespace spume
