#include "geometry/exact.h"

#include <fmt/format.h>

#include <string>

namespace podm::verify {

Rational typed_decimal(double x) {
  const std::string text = fmt::format("{}", x);  // the shortest that reads back to x
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

}  // namespace podm::verify
