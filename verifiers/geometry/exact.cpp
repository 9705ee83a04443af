#include "geometry/exact.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <fmt/format.h>
#include <mpfr.h>

#include <cmath>
#include <map>
#include <string>

namespace podm::verify {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Point_3 to_cgal(const Point& p) { return {p[0], p[1], p[2]}; }

// Bounds of the rounding errors of the two determinants as computed below, relative to the same sum with
// absolute values (the permanent). J. R. Shewchuk, "Adaptive precision floating-point arithmetic and fast
// robust geometric predicates", 1997, table 3 and section 4.4 prove (7 + 56 e) e and (16 + 224 e) e for e =
// 2^-53 without underflow. The spare e here, one part in 1e16 of the permanent, covers underflow: a product
// of two numbers is off by 2^-1074 at most, and is then multiplied by at most one coordinate difference in
// the first determinant and three in the second. Overflow makes the permanent infinite or the sum not a
// number, which decides nothing.
constexpr double kEpsilon = 0x1p-53;
constexpr double kOrientationBound = 8 * kEpsilon, kSphereBound = 17 * kEpsilon;
constexpr double kLeastPermanent = 1e-290;  // times the factors that follow an underflow

// Returns the proven sign, or 0 if it is open.
int proven_orientation(const Vector<double>& u, const Vector<double>& v, const Vector<double>& w) {
  const double uv = u[0] * v[1], vu = v[0] * u[1], vw = v[0] * w[1], wv = w[0] * v[1], wu = w[0] * u[1],
               uw = u[0] * w[1];
  const double det = w[2] * (uv - vu) + u[2] * (vw - wv) + v[2] * (wu - uw);
  const double u2 = std::fabs(u[2]), v2 = std::fabs(v[2]), w2 = std::fabs(w[2]);
  const double permanent = (std::fabs(uv) + std::fabs(vu)) * w2 + (std::fabs(vw) + std::fabs(wv)) * u2 +
                           (std::fabs(wu) + std::fabs(uw)) * v2;
  if (!(std::fabs(det) > kOrientationBound * permanent)) return 0;
  if (!(permanent > kLeastPermanent * (1 + u2 + v2 + w2))) return 0;
  return det > 0 ? 1 : -1;
}

// Returns the sign of the determinant of the rows (x - e, |x - e|^2) for x = a, b, c, d, whose differences
// from e are given; 0 if the sign is open.
int proven_in_sphere(const Vector<double>& a, const Vector<double>& b, const Vector<double>& c,
                     const Vector<double>& d) {
  struct Minor {
    double value, absolute;
  };
  const auto minor = [](const Vector<double>& p, const Vector<double>& q) {
    const double pq = p[0] * q[1], qp = q[0] * p[1];
    return Minor{pq - qp, std::fabs(pq) + std::fabs(qp)};
  };
  const Minor ab = minor(a, b), bc = minor(b, c), cd = minor(c, d), da = minor(d, a), ac = minor(a, c),
              bd = minor(b, d);
  const double a2 = std::fabs(a[2]), b2 = std::fabs(b[2]), c2 = std::fabs(c[2]), d2 = std::fabs(d[2]);
  const double abc = a[2] * bc.value - b[2] * ac.value + c[2] * ab.value;
  const double bcd = b[2] * cd.value - c[2] * bd.value + d[2] * bc.value;
  const double cda = c[2] * da.value + d[2] * ac.value + a[2] * cd.value;
  const double dab = d[2] * ab.value + a[2] * bd.value + b[2] * da.value;
  const double a_lift = dot(a, a), b_lift = dot(b, b), c_lift = dot(c, c), d_lift = dot(d, d);
  const double det = (d_lift * abc - c_lift * dab) + (b_lift * cda - a_lift * bcd);
  const double permanent = (cd.absolute * b2 + bd.absolute * c2 + bc.absolute * d2) * a_lift +
                           (da.absolute * c2 + ac.absolute * d2 + cd.absolute * a2) * b_lift +
                           (ab.absolute * d2 + bd.absolute * a2 + da.absolute * b2) * c_lift +
                           (bc.absolute * a2 + ac.absolute * b2 + ab.absolute * c2) * d_lift;
  if (!(std::fabs(det) > kSphereBound * permanent)) return 0;
  const double factors = 1 + a_lift + b_lift + c_lift + d_lift;  // factors^2 exceeds three differences
  if (!(permanent > kLeastPermanent * factors * factors)) return 0;
  return det > 0 ? 1 : -1;
}

// An MPFR number whose results are all rounded up.
class RoundedUp {
 public:
  RoundedUp() { mpfr_init2(number_, 256); }
  ~RoundedUp() { mpfr_clear(number_); }
  RoundedUp(const RoundedUp&) = delete;
  RoundedUp& operator=(const RoundedUp&) = delete;
  mpfr_ptr get() { return number_; }

 private:
  mpfr_t number_;
};

}  // namespace

int orientation(const Point& a, const Point& b, const Point& c, const Point& d, std::uint64_t& num_exact) {
  const int proven =
      proven_orientation(difference<double>(b, a), difference<double>(c, a), difference<double>(d, a));
  if (proven != 0) return proven;
  ++num_exact;
  return static_cast<int>(CGAL::orientation(to_cgal(a), to_cgal(b), to_cgal(c), to_cgal(d)));
}

int side_of_sphere(const Point& a, const Point& b, const Point& c, const Point& d, const Point& p,
                   std::uint64_t& num_exact) {
  const int turn =
      proven_orientation(difference<double>(b, a), difference<double>(c, a), difference<double>(d, a));
  if (turn != 0) {
    const int inside = proven_in_sphere(difference<double>(a, p), difference<double>(b, p),
                                        difference<double>(c, p), difference<double>(d, p));
    if (inside != 0) return inside * -turn;
  }
  ++num_exact;
  return static_cast<int>(
      CGAL::side_of_bounded_sphere(to_cgal(a), to_cgal(b), to_cgal(c), to_cgal(d), to_cgal(p)));
}

Rational decimal_as_typed(double x) {
  const std::string text = fmt::format("{}", x);  // the shortest text that reads back as x
  const std::size_t e = text.find('e');
  std::string digits = text.substr(0, e);
  long exponent = e == std::string::npos ? 0 : std::stol(text.substr(e + 1));
  if (const std::size_t point = digits.find('.'); point != std::string::npos) {
    exponent -= static_cast<long>(digits.size() - point - 1);
    digits.erase(point, 1);
  }
  std::string power(static_cast<std::size_t>(std::abs(exponent)) + 1, '0');
  power[0] = '1';
  const Rational value(digits), scale(power);
  return exponent >= 0 ? value * scale : value / scale;
}

Rational squared_sine(const Rational& degrees) {
  const std::map<Rational, Rational> rational{
      {0, Rational(0)}, {30, Rational(1, 4)}, {45, Rational(1, 2)}, {60, Rational(3, 4)}, {90, Rational(1)}};
  if (const auto found = rational.find(degrees); found != rational.end()) return found->second;
  RoundedUp pi, x;
  mpfr_const_pi(pi.get(), MPFR_RNDU);
  mpfr_set_q(x.get(), degrees.mpq(), MPFR_RNDU);
  mpfr_mul(x.get(), x.get(), pi.get(), MPFR_RNDU);
  mpfr_div_ui(x.get(), x.get(), 180, MPFR_RNDU);
  mpfr_sin(x.get(), x.get(), MPFR_RNDU);
  mpfr_sqr(x.get(), x.get(), MPFR_RNDU);
  mpq_t value;
  mpq_init(value);
  mpfr_get_q(value, x.get());
  const Rational result(value);
  mpq_clear(value);
  return result;
}

}  // namespace podm::verify
