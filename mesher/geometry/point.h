// Points and vectors, mm.
#pragma once

#include <cmath>

namespace podm {

struct Point {
  double x = 0, y = 0, z = 0;
  friend bool operator==(const Point&, const Point&) = default;
};
using Vector = Point;

inline Vector operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Point operator+(const Point& a, const Vector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vector operator*(double s, const Vector& a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vector cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double squared_length(const Vector& a) { return dot(a, a); }
inline double squared_distance(const Point& a, const Point& b) { return squared_length(a - b); }
inline double distance(const Point& a, const Point& b) { return std::sqrt(squared_distance(a, b)); }
/// True if p is inside the ball of which a and b are the ends of a diameter.
inline bool is_in_diametral_ball(const Point& p, const Point& a, const Point& b) {
  return dot(a - p, b - p) < 0;
}
inline bool lexicographically_less(const Point& a, const Point& b) {
  if (a.x != b.x) return a.x < b.x;
  if (a.y != b.y) return a.y < b.y;
  return a.z < b.z;
}

}  // namespace podm
