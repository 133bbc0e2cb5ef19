// Real roots of polynomials of small degree, as minimal solvers need them.
#pragma once

#include <array>

namespace vpslam {

constexpr int kMaxPolynomialDegree = 10;

struct RealRoots {
  std::array<double, kMaxPolynomialDegree> value;
  int count = 0;

  const double* begin() const { return value.data(); }
  const double* end() const { return value.data() + count; }
};

/// Real roots of c[0] + c[1] x + ... + c[degree] x^degree, in no particular order; degree is 1 to
/// kMaxPolynomialDegree, and leading coefficients may be 0.
///
/// The roots of each derivative separate those of the one before, so that a bracketed Newton
/// iteration finds them one by one. Roots beyond [-1, 1] are found as the inverses of the roots of
/// the reversed polynomial, which keeps every evaluation well conditioned. A root of even
/// multiplicity, where the sign does not change, may be missed.
RealRoots FindRealRoots(const double* c, int degree);

}  // namespace vpslam
