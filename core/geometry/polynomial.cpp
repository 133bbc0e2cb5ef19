#include "core/geometry/polynomial.h"

#include <cmath>

namespace vpslam {
namespace {

struct Polynomial {
  std::array<double, kMaxPolynomialDegree + 1> c;
  int degree;

  double operator()(double x, double* slope) const {
    double value = c[degree], derivative = 0;
    for (int i = degree - 1; i >= 0; --i) {
      derivative = derivative * x + value;
      value = value * x + c[i];
    }
    *slope = derivative;
    return value;
  }
};

/// The root of p in [a, b], where the signs of p(a) and p(b) differ.
double Bracketed(const Polynomial& p, double a, double b, double value_at_a, double tolerance) {
  double x = 0.5 * (a + b);
  for (int i = 0; i < 100; ++i) {
    double slope;
    const double value = p(x, &slope);
    if (value == 0) return x;
    if ((value < 0) == (value_at_a < 0)) {
      a = x;
    } else {
      b = x;
    }
    double next = x - value / slope;
    if (!(next > a && next < b)) next = 0.5 * (a + b);  // also where the slope is 0
    const double step = std::abs(next - x);
    x = next;
    if (step < tolerance || b - a < tolerance) break;
  }
  return x;
}

/// Appends the roots in [-1, 1], or in (-1, 1) if `open`.
void RootsInUnitInterval(const Polynomial& p, bool open, RealRoots* roots) {
  // derivatives[k] is the k-th derivative over k!, of degree p.degree - k.
  std::array<Polynomial, kMaxPolynomialDegree + 1> derivatives;
  derivatives[0] = p;
  for (int k = 1; k < p.degree; ++k) {
    const Polynomial& above = derivatives[k - 1];
    derivatives[k].degree = above.degree - 1;
    for (int i = 0; i < above.degree; ++i) derivatives[k].c[i] = above.c[i + 1] * (i + 1) / k;
  }
  std::array<double, kMaxPolynomialDegree + 1> found;
  int num_found = 0;
  for (int k = p.degree - 1; k >= 0; --k) {
    // The roots of derivative k lie between those of derivative k + 1, which only have to separate.
    const double tolerance = k == 0 ? 1e-15 : 1e-7;
    std::array<double, kMaxPolynomialDegree + 1> next;
    int num_next = 0;
    double unused;
    double a = -1, value_at_a = derivatives[k](a, &unused);
    if (value_at_a == 0 && !(open && k == 0)) next[num_next++] = a;
    for (int i = 0; i <= num_found; ++i) {
      const double b = i < num_found ? found[i] : 1.0;
      const double value_at_b = derivatives[k](b, &unused);
      if (num_next == derivatives[k].degree) break;
      if (value_at_b == 0) {
        if (b > a && !(open && k == 0 && b == 1)) next[num_next++] = b;
      } else if (value_at_a * value_at_b < 0) {
        next[num_next++] = Bracketed(derivatives[k], a, b, value_at_a, tolerance);
      }
      a = b;
      value_at_a = value_at_b;
    }
    found = next;
    num_found = num_next;
  }
  for (int i = 0; i < num_found && roots->count < kMaxPolynomialDegree; ++i) {
    roots->value[roots->count++] = found[i];
  }
}

}  // namespace

RealRoots FindRealRoots(const double* c, int degree) {
  RealRoots roots;
  double largest = 0;
  for (int i = 0; i <= degree; ++i) largest = std::max(largest, std::abs(c[i]));
  if (!(largest > 0) || !std::isfinite(largest)) return roots;
  Polynomial p, reversed;
  p.degree = reversed.degree = degree;
  for (int i = 0; i <= degree; ++i) p.c[i] = reversed.c[degree - i] = c[i] / largest;
  RootsInUnitInterval(p, false, &roots);
  RealRoots inverse;
  RootsInUnitInterval(reversed, true, &inverse);
  for (const double x : inverse) {
    if (x != 0 && roots.count < kMaxPolynomialDegree) roots.value[roots.count++] = 1 / x;
  }
  return roots;
}

}  // namespace vpslam
